// SPDX-License-Identifier: MIT OR Apache-2.0
/** Contact for Bullet's classic soft bodies (btSoftRigidDynamicsWorld), by correcting positions and velocities. */
#ifndef RAYCONTACT_BULLET_CLASSIC_CONTACT_HPP
#define RAYCONTACT_BULLET_CLASSIC_CONTACT_HPP

#include <cstddef>
#include <stdexcept>
#include <utility>
#include <vector>

#include "raycontact/bullet/contact_bodies.hpp"
#include "raycontact/bullet/options.hpp"
#include "raycontact/free_points.hpp"

namespace raycontact::bullet {

/**
 * Call apply(dt) after every step of the world, or in a tick callback of your own: Bullet has one slot for those and
 * this class leaves it alone.
 */
class ClassicContact {
 public:
  /** Refuses options out of range. */
  explicit ClassicContact(const ContactOptions& options = {}) : bodies_(options) {}

  /** The body's own faces are its collision surface. */
  void add_body(btSoftBody& body, const BodyOptions& options = {}) { add_body(body, skin_from_faces(body), options); }

  /** A finer surface carried by the body's nodes. */
  void add_body(btSoftBody& body, Skin skin, const BodyOptions& options = {}) {
    bodies_.add({&body, nullptr, std::move(skin), {}, options});
  }

  /** Soft bodies collide with the surface of the body's shape; see surface_of_shape. Rigid bodies pass each other. */
  void add_rigid_body(btRigidBody& body, const BodyOptions& options = {}) {
    add_rigid_body(body, surface_of_shape(*body.getCollisionShape()), options);
  }
  /** The same with a surface of its own. */
  void add_rigid_body(btRigidBody& body, RigidSurface surface, const BodyOptions& options = {}) {
    bodies_.add({nullptr, &body, {}, std::move(surface), options});
  }

  /** Before the body leaves the world or is destroyed. */
  void remove_body(const btCollisionObject& body) { bodies_.remove(&body); }

  /** Refuses a normal that is no unit vector, and a negative stiffness. */
  void add_half_space(const HalfSpace& half_space) { bodies_.add_half_space(half_space); }

  /** Contacts of the last apply(). */
  std::size_t contact_count() const { return contacts().size(); }
  /** They themselves; `colliding` and `collided` count bodies in the order of `add_...`. */
  const std::vector<rayc_contact>& contacts() const { return bodies_.contacts(); }
  /** Positions of the skins, search structures, rays, and what the solve needs of the contacts. */
  double last_detection_ms() const { return bodies_.begin_ms(); }

  /**
   * Takes the world's step for what bodies do without contact, and nodes for free points: finds the velocities with
   * which they would have ended it in contact, and sets them and the positions that follow from them.
   */
  void apply(double time_step) {
    if (!(time_step > 0)) throw std::invalid_argument("apply: the time step must be above 0");
    const btScalar dt = btScalar(time_step);
    bodies_.note_start();
    bodies_.begin(dt, btVector3(0, 0, 0), true, [](const detail::ContactBody&) { return true; });
    std::vector<double> velocities = bodies_.gather_velocities();
    points_.solve(bodies_.system(), time_step, bodies_.masses(), velocities);
    for (std::size_t n = 0; n < bodies_.nodes().size(); ++n) {
      btSoftBody::Node& node = *bodies_.nodes()[n];
      if (!(node.m_im > 0)) continue;
      const double* v = &velocities[3 * n];
      const btVector3 change = btVector3(btScalar(v[0]), btScalar(v[1]), btScalar(v[2])) - node.m_v;
      node.m_v += change;
      node.m_x += dt * change;
    }
    bodies_.finish(dt);
  }

 private:
  mutable detail::ContactBodies bodies_;  // copies contacts when they are asked for
  FreePoints points_;
};

}  // namespace raycontact::bullet

#endif  // RAYCONTACT_BULLET_CLASSIC_CONTACT_HPP
