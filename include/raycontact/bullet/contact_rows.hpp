// SPDX-License-Identifier: MIT OR Apache-2.0
/** Unilateral springs over weighted nodes: what contacts become once they are folded onto the nodes of the bodies. */
#ifndef RAYCONTACT_BULLET_CONTACT_ROWS_HPP
#define RAYCONTACT_BULLET_CONTACT_ROWS_HPP

#include <algorithm>
#include <cstddef>
#include <vector>

#include "raycontact/bullet/precision.hpp"

namespace raycontact::bullet::detail {

/**
 * One row for each contact: depth(q) = depth + sum of weight * (q - x) . direction, and the force on a node is
 * -weight * direction * stiffness * (depth(q) + damping_time * its rate). Rows live in flat arrays that grow: a fixed
 * number of nodes per contact would drop weights and freeze bodies.
 */
class ContactRows {
 public:
  using Vectors = btAlignedObjectArray<btVector3>;
  using Nodes = btAlignedObjectArray<btSoftBody::Node*>;

  void clear() {
    rows_.clear();
    nodes_.clear();
    weights_.clear();
  }

  std::size_t size() const { return rows_.size(); }

  /** The entries added since the last call become a row. */
  void finish_row(const btVector3& direction, btScalar depth, btScalar stiffness) {
    rows_.push_back({direction, depth, stiffness, 0, nodes_.size()});
  }

  /** Adds a node to the row under way; a node that is already in it gets the sum. */
  void add(int node, btScalar weight) {
    const std::size_t begin = rows_.empty() ? 0 : rows_.back().end;
    const auto found = std::find(nodes_.begin() + static_cast<std::ptrdiff_t>(begin), nodes_.end(), node);
    if (found != nodes_.end()) {
      weights_[static_cast<std::size_t>(found - nodes_.begin())] += weight;
    } else {
      nodes_.push_back(node);
      weights_.push_back(weight);
    }
  }

  /**
   * Depths at the positions m_q, and with them which rows push: contact never pulls. At most `depth_cap` of the depth
   * found is asked for, or as much as the bodies close in this step, so that deep starts do not crush elements.
   */
  void update(const Nodes& nodes, btScalar damping_time, btScalar depth_cap) {
    for_each_row([&](Row& row, std::size_t begin) {
      btVector3 change(0, 0, 0), rate(0, 0, 0);
      for (std::size_t e = begin; e < row.end; ++e) {
        const btSoftBody::Node& node = *nodes[nodes_[e]];
        change += weights_[e] * (node.m_q - node.m_x);
        rate += weights_[e] * node.m_v;
      }
      const btScalar deepening = change.dot(row.direction);
      const btScalar asked = std::min(row.depth, std::max(depth_cap, deepening));
      row.push = std::max(btScalar(0), row.stiffness * (asked + deepening + damping_time * rate.dot(row.direction)));
    });
  }

  /** forces += scale * F, as of the last update. */
  void add_forces(btScalar scale, Vectors& forces) {
    for_each_row([&](Row& row, std::size_t begin) {
      if (row.push > 0) scatter(row, begin, -scale * row.push, forces);
    });
  }

  /** result += scale * dF/dq . change over the rows that push. */
  void add_differential(btScalar scale, const Vectors& change, Vectors& result) {
    for_each_row([&](Row& row, std::size_t begin) {
      if (!(row.push > 0)) return;
      scatter(row, begin, -scale * row.stiffness * gather(row, begin, change), result);
    });
  }

  /** The damping part alone of the push, at the velocities m_v. */
  void add_damping_forces(btScalar scale, const Nodes& nodes, btScalar damping_time, Vectors& forces) {
    for_each_row([&](Row& row, std::size_t begin) {
      if (!(row.push > 0)) return;
      btScalar rate = 0;
      for (std::size_t e = begin; e < row.end; ++e) rate += weights_[e] * nodes[nodes_[e]]->m_v.dot(row.direction);
      scatter(row, begin, -scale * row.stiffness * damping_time * rate, forces);
    });
  }

  /** The energy stored by the rows that push, without damping. */
  double energy(const Nodes& nodes) {
    double sum = 0;
    for_each_row([&](Row& row, std::size_t begin) {
      if (!(row.push > 0)) return;
      btScalar depth = row.depth;
      for (std::size_t e = begin; e < row.end; ++e)
        depth += weights_[e] * (nodes[nodes_[e]]->m_q - nodes[nodes_[e]]->m_x).dot(row.direction);
      sum += 0.5 * double(row.stiffness) * double(depth) * double(depth);
    });
    return sum;
  }

 private:
  struct Row {
    btVector3 direction;
    btScalar depth;
    btScalar stiffness;
    btScalar push;
    std::size_t end;  // its entries run from the end of the row before
  };

  template <class Function>
  void for_each_row(Function function) {
    std::size_t begin = 0;
    for (Row& row : rows_) {
      function(row, begin);
      begin = row.end;
    }
  }

  btScalar gather(const Row& row, std::size_t begin, const Vectors& vectors) const {
    btVector3 sum(0, 0, 0);
    for (std::size_t e = begin; e < row.end; ++e) sum += weights_[e] * vectors[nodes_[e]];
    return sum.dot(row.direction);
  }

  void scatter(const Row& row, std::size_t begin, btScalar magnitude, Vectors& vectors) const {
    const btVector3 along = magnitude * row.direction;
    for (std::size_t e = begin; e < row.end; ++e) vectors[nodes_[e]] += weights_[e] * along;
  }

  std::vector<Row> rows_;
  std::vector<int> nodes_;
  std::vector<btScalar> weights_;
};

}  // namespace raycontact::bullet::detail

#endif  // RAYCONTACT_BULLET_CONTACT_ROWS_HPP
