// SPDX-License-Identifier: MIT OR Apache-2.0
/** Multibodies of Bullet with their colliders, which Bullet leaves to its users, and a gripper that lifts a soft cube.
 */
#ifndef RAYCONTACT_DEMOS_MULTIBODY_HPP
#define RAYCONTACT_DEMOS_MULTIBODY_HPP

#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>
#include <btBulletDynamicsCommon.h>

#include <memory>
#include <vector>

namespace demo {

/** A base, and links that each hang on it by one joint; without damping. */
class Multibody {
 public:
  Multibody(btMultiBodyDynamicsWorld& world, int links, double mass, const btVector3& at, bool is_fixed)
      : world_(world),
        body_(links, btScalar(mass), btVector3(1, 1, 1) * btScalar(mass), is_fixed, false),
        base_(&body_, -1) {
    body_.setBasePos(at);
    body_.setLinearDamping(0);
    body_.setAngularDamping(0);
  }

  ~Multibody() {
    for (const auto& link : links_) world_.removeCollisionObject(link.get());
    if (base_.getCollisionShape() != nullptr) world_.removeCollisionObject(&base_);
    world_.removeMultiBody(&body_);
  }

  Multibody(const Multibody&) = delete;
  Multibody& operator=(const Multibody&) = delete;

  void set_base_shape(btCollisionShape& shape) {
    base_.setCollisionShape(&shape);
    body_.setBaseCollider(&base_);
  }

  /** Its centre of mass is at `offset` from that of the base. */
  void add_slider(btCollisionShape& shape, double mass, const btVector3& axis, const btVector3& offset) {
    body_.setupPrismatic(add(shape), btScalar(mass), inertia(shape, mass), -1, btQuaternion::getIdentity(), axis,
                         btVector3(0, 0, 0), offset, true);
  }

  /** The same, about a pivot at `pivot` from the base. */
  void add_hinge(btCollisionShape& shape, double mass, const btVector3& axis, const btVector3& pivot,
                 const btVector3& offset) {
    body_.setupRevolute(add(shape), btScalar(mass), inertia(shape, mass), -1, btQuaternion::getIdentity(), axis, pivot,
                        offset - pivot, true);
  }

  /** After the last link. Bullet's own contacts leave all of it alone unless told otherwise. */
  void start(const btVector3& velocity, int group = 0, int mask = 0) {
    body_.finalizeMultiDof();
    body_.setBaseVel(velocity);
    world_.addMultiBody(&body_);
    place();
    if (base_.getCollisionShape() != nullptr) world_.addCollisionObject(&base_, group, mask);
    for (const auto& link : links_) world_.addCollisionObject(link.get(), group, mask);
  }

  /** Takes the colliders to where the joints are. */
  void place() {
    btAlignedObjectArray<btQuaternion> rotations;
    btAlignedObjectArray<btVector3> origins;
    body_.forwardKinematics(rotations, origins);
    body_.updateCollisionObjectWorldTransforms(rotations, origins);
  }

  /** Where all joints are sliders. */
  btVector3 momentum() const {
    const btMatrix3x3 turn = body_.getBaseWorldTransform().getBasis();
    btVector3 sum = body_.getBaseMass() * body_.getBaseVel();
    for (int i = 0; i < body_.getNumLinks(); ++i) {
      const btVector3 arm = links_[std::size_t(i)]->getWorldTransform().getOrigin() - body_.getBasePos();
      const btVector3 sliding = body_.getJointVel(i) * (turn * body_.getLink(i).getAxisBottom(0));
      sum += body_.getLinkMass(i) * (body_.getBaseVel() + body_.getBaseOmega().cross(arm) + sliding);
    }
    return sum;
  }

  btMultiBody& body() { return body_; }
  const btMultiBody& body() const { return body_; }
  btMultiBodyLinkCollider& base() { return base_; }
  btMultiBodyLinkCollider& link(std::size_t i) { return *links_[i]; }

 private:
  int add(btCollisionShape& shape) {
    const int number = static_cast<int>(links_.size());
    links_.push_back(std::make_unique<btMultiBodyLinkCollider>(&body_, number));
    links_.back()->setCollisionShape(&shape);
    body_.getLink(number).m_collider = links_.back().get();
    return number;
  }

  static btVector3 inertia(const btCollisionShape& shape, double mass) {
    btVector3 about;
    shape.calculateLocalInertia(btScalar(mass), about);
    return about;
  }

  btMultiBodyDynamicsWorld& world_;
  btMultiBody body_;
  btMultiBodyLinkCollider base_;
  std::vector<std::unique_ptr<btMultiBodyLinkCollider>> links_;
};

}  // namespace demo

#endif  // RAYCONTACT_DEMOS_MULTIBODY_HPP
