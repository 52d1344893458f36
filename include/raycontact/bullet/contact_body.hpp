// SPDX-License-Identifier: MIT OR Apache-2.0
/** One of Bullet's bodies, as the contact system has to know it. */
#ifndef RAYCONTACT_BULLET_CONTACT_BODY_HPP
#define RAYCONTACT_BULLET_CONTACT_BODY_HPP

#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <LinearMath/btTransformUtil.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "raycontact.hpp"
#include "raycontact/bullet/multibody_link.hpp"
#include "raycontact/bullet/options.hpp"
#include "raycontact/bullet/rigid_surface.hpp"
#include "raycontact/bullet/skin.hpp"

namespace raycontact::bullet::detail {

/** A soft body with its skin, or a rigid one with its surface: of its own, or a link of a multibody. */
struct ContactBody {
  btSoftBody* soft;
  btCollisionObject* rigid;
  Skin skin;             // of a soft body
  RigidSurface surface;  // of a rigid one
  BodyOptions options;
  bool is_in_scene = false;
  uint32_t number = 0;                // there
  std::array<btScalar, 5> inertia{};  // of a rigid body, as the system has it
  rayc_motion motion{};
  MultibodyLink link{};
  Matrix6 articulated{};  // the inertia of a link, as the system has it
  Twist impulse{};        // on a link, in the last step
  bool is_ahead = false;  // a link has had it in this step too

  btVector3 velocity_then{0, 0, 0};  // of a soft body: the mean of its nodes at the start of the last step
  double falling = 1;                // how much of gravity the prediction takes
  bool has_begun = false;            // one step at least

  const btCollisionObject* object() const {
    return soft != nullptr ? static_cast<const btCollisionObject*>(soft) : rigid;
  }

  /**
   * The part that a step's prediction takes of `gained`, what gravity adds to the velocity of a soft body in it: all
   * while the body falls, none while something carries it, since that will go on doing so. It falls where it gained
   * more than half of that in the last step. The part fades by half a step, so that what lands is still pressed on.
   */
  btScalar falling_part(const btVector3& gained) {
    double mass = 0;
    btVector3 momentum(0, 0, 0);
    for (int n = 0; n < soft->m_nodes.size(); ++n) {
      const btSoftBody::Node& node = soft->m_nodes[n];
      if (!(node.m_im > 0)) continue;
      mass += 1 / double(node.m_im);
      momentum += node.m_v / node.m_im;
    }
    const btVector3 velocity = momentum / btScalar(mass > 0 ? mass : 1);
    const btVector3 change = velocity - std::exchange(velocity_then, velocity);
    const double square = double(gained.length2());
    if (!std::exchange(has_begun, true) || !(square > 0)) return 1;
    falling = std::max(std::min(1.0, 2 * double(change.dot(gained)) / square - 1), falling / 2);
    return btScalar(falling);
  }

  btRigidBody& rigid_body() const { return *btRigidBody::upcast(rigid); }

  bool gives_way() const {
    if (rigid == nullptr) return false;
    return link ? link.gives_way() : !rigid->isStaticOrKinematicObject() && rigid_body().getInvMass() > 0;
  }

  // Two rigid bodies are the host's own business.
  bool may_touch(const ContactBody& other) const {
    return (soft != nullptr || other.soft != nullptr) && (options.group & other.options.mask) != 0 &&
           (other.options.group & options.mask) != 0;
  }

  Mesh mesh() const {
    std::vector<btScalar> positions;
    if (soft != nullptr) skin_positions(*soft, skin, positions);
    rayc_mesh_options mesh_options = default_mesh_options();
    const auto make = [&] {
      return soft != nullptr ? Mesh(vectors(positions), skin.triangles, mesh_options)
                             : Mesh(vectors(surface.points), surface.triangles, mesh_options);
    };
    try {
      return make();
    } catch (const Error& error) {
      if (error.status() != RAYC_STATUS_MESH_OPEN) throw;
      // A triangle mesh may be a piece of terrain; a rigid body that moves must be closed to have an inside.
      if (soft != nullptr ? !options.open : !rigid->isStaticOrKinematicObject())
        throw Error(error.status(), error.what() + std::string(". Contact takes closed solids, open surfaces of static "
                                                               "and kinematic rigid bodies, and cloth that faces what "
                                                               "it meets, with BodyOptions::open; or leave cloth to "
                                                               "Bullet's own contact"));
      mesh_options.open = 1;
      return make();
    }
  }

  /** A rigid body's inverse mass and inertia, and whether it gives way. */
  std::array<btScalar, 5> inertia_now() const {
    if (link) {
      const btVector3 about = link.inertia();
      return {{1 / link.mass(), 1 / about.x(), 1 / about.y(), 1 / about.z(), btScalar(gives_way() ? 1 : 0)}};
    }
    const btVector3& inverse = rigid_body().getInvInertiaDiagLocal();
    return {{rigid_body().getInvMass(), inverse.x(), inverse.y(), inverse.z(), btScalar(gives_way() ? 1 : 0)}};
  }

  /** About the body's own axes, for a body that gives way. */
  std::array<double, 9> inertia_matrix() const {
    double square = 0;
    for (const btVector3& point : surface.points) square = std::max(square, double(point.length2()));
    std::array<double, 9> matrix{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double inverse = double(inertia[axis + 1]);
      // Bullet's zero stands for an axis about which nothing turns the body.
      matrix[4 * axis] = inverse > 0 ? 1 / inverse : 1e9 * square / double(inertia[0]);
    }
    return matrix;
  }

  void copy_velocity(double* to) {
    const Twist velocity =
        link ? link.velocity() : Twist{rigid_body().getLinearVelocity(), rigid_body().getAngularVelocity()};
    for (int axis = 0; axis < 3; ++axis) {
      to[axis] = double(velocity.linear[axis]);
      to[axis + 3] = double(velocity.angular[axis]);
    }
  }

  void wake() {
    if (link) link.wake();
    rigid->activate();
  }

  /** At the start of a step; a link is then pushed as in the last one. */
  void note_start() {
    if (is_ahead) return;
    copy_velocity(motion.velocity);
    if (!link || !is_in_scene || !gives_way()) return;
    link.push(impulse);
    is_ahead = true;
  }

  void leave_scene() {
    is_in_scene = false;
    if (is_ahead) link.push({-impulse.linear, -impulse.angular});
    is_ahead = false;
    impulse = {};
  }

  /** Where a rigid body is, or was so many seconds ago, and where its velocity would take it. */
  void renew_motion(btScalar ago) {
    copy_velocity(motion.free_velocity);
    btTransform place = rigid->getWorldTransform();
    if (ago > 0)
      btTransformUtil::integrateTransform(rigid->getWorldTransform(), rigid_body().getLinearVelocity(),
                                          rigid_body().getAngularVelocity(), -ago, place);
    if (is_ahead) {
      const btMatrix3x3& turn = place.getBasis();
      const Twist own = product(inverse(articulated), {impulse.linear * turn, impulse.angular * turn});
      const btVector3 change[2] = {turn * own.linear, turn * own.angular};
      for (int k = 0; k < 6; ++k) motion.free_velocity[k] -= double(change[k / 3][k % 3]);
    }
    for (int row = 0; row < 3; ++row) {
      motion.position[row] = double(place.getOrigin()[row]);
      for (int column = 0; column < 3; ++column) motion.rotation[row][column] = double(place.getBasis()[row][column]);
    }
  }

  /** The velocity that the solve found instead, and the way that it makes. */
  void follow(const std::array<double, 6>& velocity, btScalar dt) {
    btVector3 change[2];
    for (int k = 0; k < 6; ++k) change[k / 3][k % 3] = btScalar(velocity[std::size_t(k)] - motion.free_velocity[k]);
    if (link) {
      follow_impulse({change[0] * basis(), change[1] * basis()}, dt);
      return;
    }
    if (change[0].isZero() && change[1].isZero()) return;
    btRigidBody& body = rigid_body();
    body.setLinearVelocity(body.getLinearVelocity() + change[0]);
    body.setAngularVelocity(body.getAngularVelocity() + change[1]);
    btTransform moved;
    btTransformUtil::integrateTransform(body.getWorldTransform(), change[0], change[1], dt, moved);
    body.proceedToTransform(moved);
  }

  /** The same of a link, along its own axes: the velocities have a part of its impulse already. */
  void follow_impulse(const Twist& change, btScalar dt) {
    const Twist own = product(articulated, change);
    const Twist before = std::exchange(impulse, {basis() * own.linear, basis() * own.angular});
    link.push_solved({impulse.linear - before.linear, impulse.angular - before.angular}, dt);
    is_ahead = false;
  }

  /** As the step began. */
  btMatrix3x3 basis() const {
    btMatrix3x3 turn;
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column) turn[row][column] = btScalar(motion.rotation[row][column]);
    return turn;
  }
};

}  // namespace raycontact::bullet::detail

#endif  // RAYCONTACT_BULLET_CONTACT_BODY_HPP
