// SPDX-License-Identifier: MIT OR Apache-2.0
/** Fine skins in coarse cages and rigid bodies on the contact system: implicit Euler, conjugate gradients. */
#ifndef RAYCONTACT_DEMOS_ENGINE_ENGINE_HPP
#define RAYCONTACT_DEMOS_ENGINE_ENGINE_HPP

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "../shapes.hpp"
#include "../../../examples/own_engine/conjugate_gradients.hpp"
#include "elasticity.hpp"
#include "raycontact/cage.hpp"

namespace caged {

/** The fastest node of the last step. */
struct Fastest {
  double speed = 0;     // m/s
  double mass = 0;      // kg
  double elements = 0;  // their stiffness along its motion, N/m
  double contacts = 0;  // that of the contacts
};

/** What a step took, in seconds. */
struct Spent {
  double detection = 0;  // with the rows
  double products = 0;   // of the contacts
  double elements = 0;   // their products, and the rest of the solver
};

class Engine {
 public:
  Vector gravity{{0, -9.81, 0}};
  int solves = 6;              // in a step at most
  double damping_time = 0.01;  // s: of the elements, over their stiffness
  double drag = 0;             // 1/s: of all motion

  /** `threads`: of the engine, lent to the library. */
  explicit Engine(int threads = 1) : team_{threads}, scene_(lent(team_)) {}

  void add_floor(const rayc_material& material) { add_wall({{0, 1, 0}}, 0, material); }

  /** Solid where normal * x < offset. */
  void add_wall(const Vector& normal, double offset, const rayc_material& material) {
    contacts_.add_half_space(normal, offset, material);
  }

  void set_sampling(rayc_sampling sampling, double value) { scene_.set_sampling(sampling, value); }

  /**
   * `held(position)`: whether a node stays where it is. `on_floor`: of this body and the floor, in place of the two
   * materials in series; or nullptr.
   */
  template <class Held>
  void add(const raycontact::Cage& cage, double mass, double youngs_modulus, const rayc_material& material,
           const rayc_material* on_floor, const Held& held) {
    const std::size_t first = masses_.size();
    double fill = 0;
    for (const double part : cage.fill) fill += part;
    for (std::size_t n = 0; n < cage.nodes.size(); ++n) {
      x_.insert(x_.end(), cage.nodes[n].begin(), cage.nodes[n].end());
      masses_.push_back(held(cage.nodes[n]) ? std::numeric_limits<double>::infinity() : mass * cage.fill[n] / fill);
    }
    v_.resize(x_.size(), 0);
    for (const auto& t : cage.tetrahedra) {
      std::array<std::size_t, 4> nodes{};
      for (std::size_t k = 0; k < 4; ++k) nodes[k] = first + static_cast<std::size_t>(t[k]);
      elasticity_.add(x_, nodes, youngs_modulus, 0.3);
    }
    elasticity_.end_body();
    bodies_.push_back({cage, first, 0});
    const uint32_t number = scene_.add({raycontact::vectors(skin(bodies_.size() - 1)), cage.skin.triangles});
    bodies_.back().number = number;
    contacts_.set_node_masses(masses_);
    contacts_.add_deformable(scene_, number, static_cast<uint32_t>(first), static_cast<uint32_t>(cage.nodes.size()),
                             raycontact::SkinCarriers(cage.skin), material);
    if (on_floor != nullptr) contacts_.set_half_space_material(number, 0, on_floor);
  }

  /** Of all nodes of the body added last that are not held. */
  void set_velocity(const Vector& velocity) {
    for (std::size_t k = 3 * bodies_.back().first; k < v_.size(); ++k) v_[k] = is_held(k) ? 0 : velocity[k % 3];
  }

  /** Lets the body added last touch itself. */
  void touch_itself() { scene_.set_self_collision(bodies_.back().number, true); }

  void add_box(const demo::Surface& surface, const Vector& edges, double mass, const Vector& position,
               const rayc_material& material) {
    const uint32_t number = scene_.add({raycontact::vectors(surface.positions), surface.triangles});
    std::array<double, 9> inertia{};
    for (std::size_t k = 0; k < 3; ++k) {
      const double u = edges[(k + 1) % 3], v = edges[(k + 2) % 3];
      inertia[4 * k] = mass / 12 * (u * u + v * v);
    }
    contacts_.add_rigid(scene_, number, mass, inertia, material);
    rigids_.push_back({number, position, rotation({}), {}});
  }

  /** Implicit Euler: M (v' - v) = dt (elements + contact + gravity at the end of the step). */
  void step(double dt) {
    Numbers free = v_, v = v_, own(x_.size());
    for (std::size_t k = 0; k < free.size(); ++k)
      if (!is_held(k)) free[k] = (free[k] + dt * gravity[k % 3]) / (1 + dt * drag);
    for (const Rigid& rigid : rigids_) contacts_.set_motion(rigid.number, motion(rigid, dt));
    spent_ = {};
    const auto detecting = [&](const auto& call) { return timed(spent_.detection, call); };
    detecting([&] { contacts_.begin(scene_, dt, x_, v_, free); });
    elasticity_.linearise(x_, own, team_);
    for (int solve = 1;; ++solve) {
      Numbers right(x_.size());
      contacts_.add_forces(v, right);
      elasticity_.add_product(-dt - damping_time, v, right, team_);
      for (std::size_t k = 0; k < right.size(); ++k)
        right[k] = is_held(k) ? 0 : dt * (right[k] + own[k]) - masses_[k / 3] * (v[k] - free[k]);
      timed(spent_.elements, [&] { solve_for_change(dt, right, v); });
      const bool is_wrong = detecting([&] { return contacts_.linearise(v) > 0.01; });
      if (solve == solves) break;
      if (!detecting([&] { return contacts_.detect_again(scene_, v) > 0; }) && !is_wrong) break;
    }
    spent_.elements -= spent_.products;
    find_fastest(dt, v);
    contacts_.finish(v);
    v_ = v;
    for (std::size_t k = 0; k < x_.size(); ++k) x_[k] += dt * v_[k];
    for (Rigid& rigid : rigids_) {
      rigid.velocity = contacts_.rigid_velocity(rigid.number);
      Vector angle{};
      for (std::size_t k = 0; k < 3; ++k) {
        rigid.position[k] += dt * rigid.velocity[k];
        angle[k] = dt * rigid.velocity[k + 3];
      }
      rigid.turned = product(rotation(angle), rigid.turned);
    }
  }

  /** By the last step. */
  const Spent& spent() const { return spent_; }
  const Fastest& fastest() const { return fastest_; }

  /** Of the last detection. */
  std::size_t contact_count() const {
    raycontact::Contacts contacts;
    contacts_.copy_contacts_to(contacts);
    return contacts.size();
  }

  /** x, y, z of each node of a body, and its velocity; masses are infinite where it is held. */
  Numbers positions(std::size_t body) const { return of_body(body, x_, 3); }
  Numbers velocities(std::size_t body) const { return of_body(body, v_, 3); }
  Numbers masses(std::size_t body) const { return of_body(body, masses_, 1); }

  /** How deep the lowest point of all skins is in the floor, m. */
  double depth() const {
    double most = 0;
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      const Numbers positions = skin(b);
      for (std::size_t k = 1; k < positions.size(); k += 3) most = std::max(most, -positions[k]);
    }
    return most;
  }

 private:
  struct Caged {
    raycontact::Cage cage;
    std::size_t first;  // node
    uint32_t number;    // in the scene
  };

  struct Rigid {
    uint32_t number;
    Vector position;
    Matrix turned;
    std::array<double, 6> velocity;
  };

  /** Adds the seconds that a call takes. */
  template <class Call>
  static auto timed(double& seconds, const Call& call) -> decltype(call()) {
    struct Clock {
      double& seconds;
      std::chrono::steady_clock::time_point begin = std::chrono::steady_clock::now();
      ~Clock() { seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(); }
    } clock{seconds};
    return call();
  }

  Numbers of_body(std::size_t body, const Numbers& all, std::size_t each) const {
    const auto begin = all.begin() + static_cast<std::ptrdiff_t>(each * bodies_[body].first);
    return {begin, begin + static_cast<std::ptrdiff_t>(each * bodies_[body].cage.nodes.size())};
  }

  bool is_held(std::size_t unknown) const { return !std::isfinite(masses_[unknown / 3]); }

  Numbers skin(std::size_t body) const {
    Numbers positions;
    for (const raycontact::SkinPoint& point : bodies_[body].cage.skin.points)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        double sum = 0;
        for (std::size_t k = 0; k < 4; ++k)
          sum += point.weights[k] * x_[3 * (bodies_[body].first + static_cast<std::size_t>(point.nodes[k])) + axis];
        positions.push_back(sum);
      }
    return positions;
  }

  rayc_motion motion(const Rigid& rigid, double dt) const {
    rayc_motion m{};
    for (std::size_t k = 0; k < 6; ++k) {
      m.velocity[k] = rigid.velocity[k];
      m.free_velocity[k] = rigid.velocity[k] + (k < 3 ? dt * gravity[k] : 0);
    }
    for (std::size_t k = 0; k < 3; ++k) {
      m.position[k] = rigid.position[k];
      for (std::size_t j = 0; j < 3; ++j) m.rotation[k][j] = rigid.turned[k][j];
    }
    return m;
  }

  void find_fastest(double dt, const Numbers& v) {
    fastest_ = {};
    std::size_t node = 0;
    for (std::size_t n = 0; n < masses_.size(); ++n) {
      const double speed = std::hypot(v[3 * n], v[3 * n + 1], v[3 * n + 2]);
      if (speed > fastest_.speed) fastest_.speed = speed, node = n;
    }
    if (!(fastest_.speed > 0)) return;
    fastest_.mass = masses_[node];
    Numbers way(v.size()), elements(v.size()), contacts(v.size());
    for (std::size_t k = 3 * node; k < 3 * node + 3; ++k) way[k] = v[k] / fastest_.speed;
    elasticity_.add_product(1, way, elements, team_);
    contacts_.add_product(1 / dt, way, contacts);
    for (std::size_t k = 3 * node; k < 3 * node + 3; ++k) {
      fastest_.elements += way[k] * elements[k];
      fastest_.contacts += way[k] * contacts[k];
    }
  }

  // (M + dt (dt + damping time) K + dt C) change = right, scaled by the diagonal but for contact.
  void solve_for_change(double dt, Numbers& right, Numbers& v) {
    const double elastic = dt * (dt + damping_time);
    Numbers inverse(v.size());
    for (std::size_t k = 0; k < v.size(); ++k)
      if (!is_held(k)) inverse[k] = 1 / (masses_[k / 3] + elastic * elasticity_.diagonal(k));
    const auto add_product = [&](const Numbers& direction, Numbers& product) {
      elasticity_.add_product(elastic, direction, product, team_);
      timed(spent_.products, [&] { contacts_.add_product(dt, direction, product); });
      team_.for_ranges(product.size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k)
          product[k] = is_held(k) ? 0 : product[k] + masses_[k / 3] * direction[k];
      });
    };
    demo::solve_by_conjugate_gradients(add_product, inverse, 1e-14, 5000, right, v, team_);
  }

  static rayc_scene_options lent(Team& team) {
    rayc_scene_options options = raycontact::default_scene_options();
    if (team.threads > 1) raycontact::lend_threads(options, team);
    return options;
  }

  Team team_;
  raycontact::Scene scene_;
  raycontact::ContactSystem contacts_;
  Elasticity elasticity_;
  Numbers x_, v_, masses_;
  std::vector<Caged> bodies_;
  std::vector<Rigid> rigids_;
  Fastest fastest_;
  Spent spent_;
};

}  // namespace caged

#endif  // RAYCONTACT_DEMOS_ENGINE_ENGINE_HPP
