// SPDX-License-Identifier: MIT OR Apache-2.0
/** Where the nodes of flexes are, and how they move with the model's degrees of freedom. */
#ifndef RAYCONTACT_MUJOCO_NODE_MOTION_HPP
#define RAYCONTACT_MUJOCO_NODE_MOTION_HPP

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "raycontact/mujoco/version.hpp"

namespace raycontact::mujoco {

/** All nodes of all flexes that touch, one after the other, and the Jacobian of their places. */
class NodeMotion {
 public:
  /** Adds a node that sits in `body` at `place`, in the body's frame; `place` is the model's. */
  void add(const mjModel* m, int body, const mjtNum* place) {
    bodies_.push_back(body);
    places_.push_back(place);
    // All joints on the way to the world move it.
    bool slides = true;
    for (int b = body; b > 0; b = m->body_parentid[b])
      for (int k = m->body_dofadr[b]; k < m->body_dofadr[b] + m->body_dofnum[b]; ++k) {
        dofs_.push_back(k);
        slides = slides && m->jnt_type[m->dof_jntid[k]] == mjJNT_SLIDE;
      }
    ends_.push_back(dofs_.size());
    if (!slides) turning_.push_back(bodies_.size() - 1);
    axes_.resize(3 * dofs_.size());
    const bool is_held = dofs_.size() == (ends_.size() > 1 ? ends_[ends_.size() - 2] : 0);
    // A node that is pinned to a body has a share of it; how large a share does not change forces.
    masses_.push_back(is_held ? std::numeric_limits<double>::infinity() : std::max(m->body_mass[body], mjMINVAL));
    is_fresh_ = false;
  }

  /** How many nodes there are. */
  std::size_t size() const { return bodies_.size(); }
  /** kg; infinity for a node that nothing moves. */
  const std::vector<double>& masses() const { return masses_; }
  /** x, y, z of each at the state of the last renew(). */
  const std::vector<double>& positions() const { return positions_; }

  /** Positions and axes at the present state. */
  void renew(const mjModel* m, const mjData* d) {
    positions_.resize(3 * size());
    for (std::size_t n = 0; n < size(); ++n) {
      const int body = bodies_[n];
      mju_mulMatVec3(&positions_[3 * n], d->xmat + 9 * body, places_[n]);
      mju_addTo3(&positions_[3 * n], d->xpos + 3 * body);
    }
    // What only slides keeps its directions.
    if (!is_fresh_)
      for (std::size_t n = 0; n < size(); ++n) renew_axes(m, d, n);
    else
      for (const std::size_t n : turning_) renew_axes(m, d, n);
    is_fresh_ = true;
  }

  /** to = J from: velocities of nodes from those of the degrees of freedom. */
  void to_nodes(const std::vector<double>& from, std::vector<double>& to) const {
    std::size_t e = 0;
    for (std::size_t n = 0; n < size(); ++n) {
      std::array<double, 3> sum{};
      for (; e < ends_[n]; ++e)
        for (std::size_t k = 0; k < 3; ++k) sum[k] += axes_[3 * e + k] * from[static_cast<std::size_t>(dofs_[e])];
      for (std::size_t k = 0; k < 3; ++k) to[3 * n + k] = sum[k];
    }
  }

  /** to += J^T from: forces on degrees of freedom from those on nodes. */
  void add_to_dofs(const std::vector<double>& from, std::vector<double>& to) const {
    std::size_t e = 0;
    for (std::size_t n = 0; n < size(); ++n)
      for (; e < ends_[n]; ++e) {
        const double* axis = &axes_[3 * e];
        to[static_cast<std::size_t>(dofs_[e])] +=
            axis[0] * from[3 * n] + axis[1] * from[3 * n + 1] + axis[2] * from[3 * n + 2];
      }
  }

  /** Calls use(degree of freedom, its axis) for each that moves the node. */
  template <class Use>
  void for_each_dof(std::size_t node, Use&& use) const {
    for (std::size_t e = node == 0 ? 0 : ends_[node - 1]; e < ends_[node]; ++e) use(dofs_[e], &axes_[3 * e]);
  }

 private:
  void renew_axes(const mjModel* m, const mjData* d, std::size_t n) {
    // MuJoCo keeps each joint's motion about the centre of mass of its kinematic tree.
    const mjtNum* centre = d->subtree_com + 3 * m->body_rootid[bodies_[n]];
    mjtNum arm[3];
    mju_sub3(arm, &positions_[3 * n], centre);
    for (std::size_t e = n == 0 ? 0 : ends_[n - 1]; e < ends_[n]; ++e) {
      const mjtNum* motion = d->cdof + 6 * dofs_[e];
      mju_cross(&axes_[3 * e], motion, arm);
      mju_addTo3(&axes_[3 * e], motion + 3);
    }
  }

  std::vector<int> bodies_;
  std::vector<const mjtNum*> places_;
  std::vector<std::size_t> ends_;  // of each node's degrees of freedom
  std::vector<int> dofs_;
  std::vector<double> axes_;          // three numbers for each degree of freedom of each node
  std::vector<std::size_t> turning_;  // nodes whose axes change
  std::vector<double> masses_, positions_;
  bool is_fresh_ = false;
};

}  // namespace raycontact::mujoco

#endif  // RAYCONTACT_MUJOCO_NODE_MOTION_HPP
