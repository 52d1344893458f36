// SPDX-License-Identifier: MIT OR Apache-2.0
/** Unilateral springs over weighted nodes: what contacts become once they are folded onto the nodes of the bodies. */
#ifndef RAYCONTACT_BULLET_CONTACT_ROWS_HPP
#define RAYCONTACT_BULLET_CONTACT_ROWS_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "raycontact/bullet/contact_row.hpp"
#include "raycontact/bullet/pair_loads.hpp"
#include "raycontact/bullet/precision.hpp"
#include "raycontact/bullet/rigid_coupling.hpp"

namespace raycontact::bullet::detail {

/** One row for each contact, and the products over all of them. Rows live in flat arrays that grow: a fixed number of
 * nodes for a contact would drop weights and freeze bodies. */
class ContactRows {
 public:
  using Row = ContactRow;
  using Vectors = btAlignedObjectArray<btVector3>;
  using Nodes = btAlignedObjectArray<btSoftBody::Node*>;

  void clear() {
    rows_.clear();
    products_.clear();
    passes_ = 0;
    nodes_.clear();
    weights_.clear();
    rigids_.clear();
  }

  /** Before clear(): what the last solve left of each pair's push, for the next step's friction. */
  void remember_loads(const Nodes& nodes) {
    solution(nodes, [&](const btVector3& direction, int first, int second, const btVector3& pull) {
      loads_.add_solved(first, second, std::max(btScalar(0), pull.dot(direction)));
    });
    loads_.finish_step();
  }

  /** When bodies have changed their numbers. */
  void forget() {
    clear();
    loads_.forget();
  }

  std::size_t size() const { return rows_.size(); }
  RigidCoupling& rigids() { return rigids_; }

  /**
   * The entries added since the last call become a row between two bodies (the second: -1 for a half-space).
   * `hold`: for friction, or nullptr.
   */
  void finish_row(const btVector3& direction, btScalar depth, btScalar stiffness, int first, int second,
                  const Hold* hold = nullptr) {
    Row row{};
    row.direction = direction;
    row.depth = depth;
    row.stiffness = stiffness;
    row.first = first;
    row.second = second;
    row.point = point_;
    row.pass = passes_;
    row.holds = hold != nullptr;
    if (hold != nullptr) row.hold = *hold;
    row.end = nodes_.size();
    rows_.push_back(row);
    point_ = {};
  }

  /** Rows from now on are of another detection in the same step. */
  void start_pass() { ++passes_; }

  /** How many rows there are between two bodies, whichever comes first. */
  std::size_t count(int first, int second) const {
    return static_cast<std::size_t>(
        std::count_if(rows_.begin(), rows_.end(), [&](const Row& row) { return row.is_between(first, second); }));
  }

  /**
   * Would other rows push at the nodes' velocities m_v than those that did in this step's solve? Prediction takes rows
   * for pushing that end up without contact, and would then pull. A twentieth of all force may be wrong.
   */
  bool has_changed(const Nodes& nodes) const {
    btScalar right = 0, wrong = 0;
    for_each_row([&](const Row& row, std::size_t begin) {
      if (!is_judged(row)) return;
      const btScalar push = expected_push(row, begin, nodes);
      ((push > 0) == row.pushes ? right : wrong) += row.pushes || push > 0 ? btFabs(push) : 0;
    });
    return 20 * wrong > right;
  }

  /** Rows between the two bodies push no longer. */
  void drop(int first, int second) {
    for (Row& row : rows_)
      if (row.is_between(first, second)) row.stiffness = 0;
  }

  /** Calls `use(hold number, is dragged, offset)` for each row that pushes: from its point to where it now holds on. */
  template <class Use>
  void holds(Use use) const {
    for (const Row& row : rows_)
      if (row.pushes && row.holds) use(row.hold.number, row.is_dragged, row.kept_offset);
  }

  /** Adds a node to the row under way; a node that is already in it gets the sum. */
  void add(int node, btScalar weight) {
    const std::size_t begin = rows_.empty() ? 0 : rows_.back().end;
    const auto found = std::find(nodes_.begin() + static_cast<std::ptrdiff_t>(begin), nodes_.end(), node);
    if (found != nodes_.end())
      weights_[static_cast<std::size_t>(found - nodes_.begin())] += weight;
    else
      add_distinct(node, weight);
  }

  /** The same for a node that is known not to be in the row. */
  void add_distinct(int node, btScalar weight) {
    nodes_.push_back(node);
    weights_.push_back(weight);
  }

  void set_rigid_point(const RigidPoint& point) { point_ = point; }

  /**
   * Which rows push, and how: by where the bodies would be at the end of the step if nothing stopped them, since
   * contact never pulls. At most the cap of the depth found is asked for, or as much as the bodies close in this step,
   * so that deep starts do not crush elements. The forces are linear from there to the velocities m_v, around which the
   * engine solves. `before`: the nodes' velocities at the start of the step, `free`: at its end if nothing stopped
   * them; `inverse_masses`: of the bodies, 1/kg.
   */
  void update(const Nodes& nodes, const std::vector<btVector3>& before, const std::vector<std::vector<btVector3>>& free,
              const std::vector<double>& inverse_masses, btScalar time_step, const RowLaw& law) {
    time_step_ = time_step;
    rigids_.start_systems();
    for_each_row([&](Row& row, std::size_t begin) {
      btVector3 rate(0, 0, 0), now(0, 0, 0);
      for (std::size_t e = begin; e < row.end; ++e) {
        rate += weights_[e] * free[row.pass][static_cast<std::size_t>(nodes_[e])];
        now += weights_[e] * before[static_cast<std::size_t>(nodes_[e])];
      }
      row.motion = row.free = rate;
      btVector3 unseen = law.look_ahead ? btVector3(0, 0, 0) : rate;  // motion that detection did not know of
      if (row.point.rigid >= 0) {
        const CoupledRigid& rigid = rigids_[row.point.rigid];
        const btVector3 v = row.point.velocity(RigidCoupling::velocity(*rigid.body));
        rate += v;
        now += row.point.velocity(rigid.before);
        unseen += v - row.point.velocity(rigid.ahead);
      }
      row.pull = row.across(rate);  // the sliding, until friction is known
      row.sliding = row.across(now);
      row.set_push(time_step * unseen.dot(row.direction), rate.dot(row.direction), time_step, law,
                   loads_.is_loaded(row.first, row.second));
      if (row.pass < passes_ && is_judged(row)) row.pushes = expected_push(row, begin, nodes) > 0;
    });
    loads_.start_prediction();
    if (law.friction > 0)
      for_each_row([&](Row& row, std::size_t) {
        if (row.pushes) loads_.add_predicted(row.first, row.second, row.push, row.normal);
      });
    for_each_row([&](Row& row, std::size_t begin) {
      if (!row.pushes) return;
      row.set_pull(
          time_step, law,
          [&](btScalar push) {
            return loads_.normal_force(row.first, row.second, push, row.normal, inverse_masses, time_step);
          },
          [&] { return loads_.speed_lost(row.first, row.second, inverse_masses, time_step); });
      const btVector3 guessed = motion_change(row, begin, nodes);
      row.motion += guessed;
      row.pull += row.stiffened(guessed);
      if (rigids_.is_movable(row.point.rigid)) load_system(row);
    });
    for (CoupledRigid& rigid : rigids_.all())
      if (rigid.movable) rigid.system.factor();
    rigids_.solve(-double(time_step_));
    for (CoupledRigid& rigid : rigids_.all()) rigid.first_change = rigid.change;
    for_each_row([&](Row& row, std::size_t) {
      if (row.pushes && rigids_.is_movable(row.point.rigid))
        row.pull += row.stiffened(row.point.velocity(rigids_[row.point.rigid].first_change));
    });
    collect_products();
  }

  /** Calls `use(direction, depth, rigid point, entries)` for each row; an entry is a node's number and its weight. */
  template <class Use>
  void visit(Use use) const {
    for_each_row([&](const Row& row, std::size_t begin) {
      use(row.direction, row.depth, row.point, Entries{*this, begin, row.end});
    });
  }

  /** The nodes of one row: entries begin ... end - 1. */
  struct Entries {
    const ContactRows& rows;
    std::size_t begin, end;
    int node(std::size_t e) const { return rows.nodes_[e]; }
    btScalar weight(std::size_t e) const { return rows.weights_[e]; }
  };

  /** forces += scale * F, as of the last update. */
  void add_forces(btScalar scale, Vectors& forces) const {
    for_each_row([&](const Row& row, std::size_t begin) {
      if (row.pushes) scatter(row, begin, -scale * row.pull, forces);
    });
  }

  /** result += time step * J^T D' J change, D' with the rigid bodies eliminated: what the implicit solve multiplies. */
  void add_differential(const Vectors& change, Vectors& result) {
    // Four numbers with Bullet's padding at a time, so that compilers make one instruction of them.
    for (const Product& p : products_) {
      btScalar u[4] = {0, 0, 0, 0};
      for (std::size_t e = p.begin; e < p.end; ++e) {
        const btScalar *x = change[nodes_[e]].m_floats, weight = weights_[e];
        for (int k = 0; k < 4; ++k) u[k] += weight * x[k];
      }
      const btScalar* d = p.direction.m_floats;
      const btScalar along = p.excess * (d[0] * u[0] + d[1] * u[1] + d[2] * u[2]);
      for (int k = 0; k < 4; ++k) u[k] = p.tangential * u[k] + along * d[k];
      for (std::size_t e = p.begin; e < p.end; ++e) {
        const btScalar weight = weights_[e];
        btScalar* x = result[nodes_[e]].m_floats;
        for (int k = 0; k < 4; ++k) x[k] += weight * u[k];
      }
    }
    if (is_coupled_) subtract_given_way(change, result);
  }

  /**
   * After the solve, with the nodes' final velocities in m_v: calls `use(direction, first, second, pull)` for each row
   * that pushes (pull: the force on the first body, in N), and leaves each rigid body's change of velocity in rigids().
   */
  template <class Use>
  void solution(const Nodes& nodes, Use use) {
    rigids_.clear_loads();
    for_each_row([&](Row& row, std::size_t begin) {
      if (!row.pushes || !rigids_.is_movable(row.point.rigid)) return;
      // The pull holds the rigid bodies' change as of the update: their load starts from what it was without it.
      const btVector3 before = row.pull - row.stiffened(row.point.velocity(rigids_[row.point.rigid].first_change));
      row.point.add_load(before + row.stiffened(motion_change(row, begin, nodes)), rigids_[row.point.rigid].load);
    });
    rigids_.solve(-double(time_step_));
    for_each_row([&](Row& row, std::size_t begin) {
      if (!row.pushes) return;
      btVector3 pull = row.pull + row.stiffened(motion_change(row, begin, nodes));
      if (rigids_.is_movable(row.point.rigid)) {
        const CoupledRigid& rigid = rigids_[row.point.rigid];
        pull += row.stiffened(row.point.velocity(rigid.change) - row.point.velocity(rigid.first_change));
      }
      use(row.direction, row.first, row.second, pull);
    });
  }

 private:
  // What a movable rigid body does is known only once the solve is over.
  bool is_judged(const Row& row) const { return !rigids_.is_movable(row.point.rigid); }

  btScalar expected_push(const Row& row, std::size_t begin, const Nodes& nodes) const {
    return row.push + row.normal * row.direction.dot(motion_of(row, begin, nodes) - row.free);
  }

  /** The part of a row that a product needs, so that the solve's iterations read little memory. */
  struct Product {
    btVector3 direction;
    btScalar tangential, excess;  // D * time step: across the direction, and what is more along it
    std::size_t begin, end;
  };

  void collect_products() {
    products_.clear();
    is_coupled_ = false;
    for_each_row([&](const Row& row, std::size_t begin) {
      if (!row.pushes) return;
      products_.push_back(
          {row.direction, time_step_ * row.tangential, time_step_ * (row.normal - row.tangential), begin, row.end});
      is_coupled_ = is_coupled_ || rigids_.is_movable(row.point.rigid);
    });
  }

  // Movable rigid bodies give way to the change.
  void subtract_given_way(const Vectors& change, Vectors& result) {
    rigids_.clear_loads();
    for_each_row([&](Row& row, std::size_t begin) {
      if (row.pushes && rigids_.is_movable(row.point.rigid))
        row.point.add_load(row.stiffened(gather(row, begin, change)), rigids_[row.point.rigid].load);
    });
    rigids_.solve(-double(time_step_));
    for_each_row([&](const Row& row, std::size_t begin) {
      if (!row.pushes || !rigids_.is_movable(row.point.rigid)) return;
      const btVector3 given_way = row.stiffened(row.point.velocity(rigids_[row.point.rigid].change));
      scatter(row, begin, time_step_ * given_way, result);
    });
  }

  void load_system(Row& row) {
    CoupledRigid& rigid = rigids_[row.point.rigid];
    row.point.add_load(row.pull, rigid.load);
    for (std::size_t column = 0; column < 6; ++column) {
      Twist unit{}, image{};
      unit[column] = 1;
      row.point.add_load(row.stiffened(row.point.velocity(unit)), image);
      for (std::size_t i = 0; i < 6; ++i) rigid.system.at(i, column) += double(time_step_) * image[i];
    }
  }

  btVector3 motion_of(const Row& row, std::size_t begin, const Nodes& nodes) const {
    btVector3 now(0, 0, 0);
    for (std::size_t e = begin; e < row.end; ++e) now += weights_[e] * nodes[nodes_[e]]->m_v;
    return now;
  }

  btVector3 motion_change(const Row& row, std::size_t begin, const Nodes& nodes) const {
    return motion_of(row, begin, nodes) - row.motion;
  }

  template <class Function>
  void for_each_row(Function function) {
    std::size_t begin = 0;
    for (Row& row : rows_) {
      function(row, begin);
      begin = row.end;
    }
  }

  template <class Function>
  void for_each_row(Function function) const {
    std::size_t begin = 0;
    for (const Row& row : rows_) {
      function(row, begin);
      begin = row.end;
    }
  }

  btVector3 gather(const Row& row, std::size_t begin, const Vectors& vectors) const {
    btVector3 sum(0, 0, 0);
    for (std::size_t e = begin; e < row.end; ++e) sum += weights_[e] * vectors[nodes_[e]];
    return sum;
  }

  void scatter(const Row& row, std::size_t begin, const btVector3& vector, Vectors& vectors) const {
    for (std::size_t e = begin; e < row.end; ++e) vectors[nodes_[e]] += weights_[e] * vector;
  }

  std::vector<Row> rows_;
  std::vector<Product> products_;  // of the rows that push
  bool is_coupled_ = false;
  std::vector<int> nodes_;
  std::vector<btScalar> weights_;
  std::size_t passes_ = 0;
  RigidPoint point_;
  RigidCoupling rigids_;
  PairLoads loads_;
  btScalar time_step_ = 0;
};

}  // namespace raycontact::bullet::detail

#endif  // RAYCONTACT_BULLET_CONTACT_ROWS_HPP
