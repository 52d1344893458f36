// SPDX-License-Identifier: MIT OR Apache-2.0
/** Contact for Bullet's classic soft bodies (btSoftRigidDynamicsWorld), by correcting positions and velocities. */
#ifndef RAYCONTACT_BULLET_CLASSIC_CONTACT_HPP
#define RAYCONTACT_BULLET_CLASSIC_CONTACT_HPP

#include <cstddef>
#include <stdexcept>
#include <vector>

#include "raycontact/bullet/contact_bodies.hpp"
#include "raycontact/bullet/options.hpp"
#include "raycontact/free_points.hpp"

namespace raycontact::bullet {

/**
 * Call apply(dt) after every step of the world, or in a tick callback of your own: Bullet has one slot for those and
 * this class leaves it alone.
 */
class ClassicContact : public ContactBodies {
 public:
  /** Refuses options out of range. */
  explicit ClassicContact(const ContactOptions& options = {}) : ContactBodies(options) {}

  /** Before the body leaves the world or is destroyed. */
  void remove_body(const btCollisionObject& body) { remove(&body); }

  /**
   * Takes the world's step for what bodies do without contact, and nodes for free points: finds the velocities with
   * which they would have ended it in contact, and sets them and the positions that follow from them.
   */
  void apply(double time_step) {
    if (!(time_step > 0)) throw std::invalid_argument("apply: the time step must be above 0");
    const btScalar dt = btScalar(time_step);
    note_start();
    begin(dt, btVector3(0, 0, 0), true, [](const ContactBody&) { return true; });
    solved_ = gather_velocities();
    points_.solve(system_, time_step, masses_, solved_);
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
      btSoftBody::Node& node = *nodes_[n];
      if (!(node.m_im > 0)) continue;
      const double* v = &solved_[3 * n];
      const btVector3 change = btVector3(btScalar(v[0]), btScalar(v[1]), btScalar(v[2])) - node.m_v;
      node.m_v += change;
      node.m_x += dt * change;
    }
    finish(dt);
  }

 private:
  FreePoints points_;
  std::vector<double> solved_;
};

}  // namespace raycontact::bullet

#endif  // RAYCONTACT_BULLET_CLASSIC_CONTACT_HPP
