// SPDX-License-Identifier: MIT OR Apache-2.0
/** A link of a multibody, or its base, as the contact system has to know it: a rigid body that joints hold. */
#ifndef RAYCONTACT_BULLET_MULTIBODY_LINK_HPP
#define RAYCONTACT_BULLET_MULTIBODY_LINK_HPP

#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>
#include <LinearMath/btAlignedObjectArray.h>

#include <stdexcept>
#include <string>

#include "raycontact/bullet/precision.hpp"

namespace raycontact::bullet::detail {

/** Linear and angular part, along the world's axes, the latter about the link's centre of mass. */
struct Twist {
  btVector3 linear{0, 0, 0}, angular{0, 0, 0};
};

/**
 * What a link weighs, how fast it is, and how it takes an impulse. The system has it as a free body of the link's own
 * mass and inertia. Joints and other links only make it heavier, and contact that takes a body for lighter than it is
 * stays stable. What the joints' motors and limits do against the contact's impulse is up to Bullet's own solve. To
 * that end each step begins with the impulse of the step before, and contact then changes it to its own.
 */
class MultibodyLink {
 public:
  /** None, or that of this collider. */
  explicit MultibodyLink(btMultiBodyLinkCollider* collider = nullptr) : collider_(collider) {}

  explicit operator bool() const { return collider_ != nullptr; }
  bool is_base() const { return collider_->m_link < 0; }
  btScalar mass() const { return is_base() ? body().getBaseMass() : body().getLinkMass(collider_->m_link); }
  btVector3 inertia() const { return is_base() ? body().getBaseInertia() : body().getLinkInertia(collider_->m_link); }

  bool gives_way() const {
    return !collider_->isStaticOrKinematicObject() && !(is_base() && body().isBaseStaticOrKinematic());
  }

  void check() const {
    const btVector3 about = inertia();
    if (gives_way() && !(mass() > 0 && about.x() > 0 && about.y() > 0 && about.z() > 0))
      throw std::invalid_argument("link " + std::to_string(collider_->m_link) +
                                  ": its mass or a component of its inertia is 0; give it both, or add the link that "
                                  "carries it with both surfaces");
  }

  Twist velocity() {
    velocities_.resize(2 * (body().getNumLinks() + 1));
    btVector3 *angular = &velocities_[0], *linear = angular + body().getNumLinks() + 1;
    body().compTreeLinkVelocities(angular, linear);
    const btMatrix3x3& turn = collider_->getWorldTransform().getBasis();
    const int index = collider_->m_link + 1;
    return {turn * linear[index], turn * angular[index]};
  }

  /** Changes the velocities of the whole multibody by an impulse on this link, and its pose by what that makes in `dt`.
   */
  void push(const Twist& impulse, btScalar dt) {
    if (impulse.linear.isZero() && impulse.angular.isZero()) return;
    forces_.resize(6 + body().getNumDofs());
    changes_.resize(forces_.size());
    body().fillConstraintJacobianMultiDof(collider_->m_link, collider_->getWorldTransform().getOrigin(),
                                          impulse.angular, impulse.linear, &forces_[0], numbers_, vectors_, matrices_);
    body().calcAccelerationDeltasMultiDof(&forces_[0], &changes_[0], numbers_, vectors_);
    body().applyDeltaVeeMultiDof(&changes_[0], 1);
    if (!(dt > 0)) return;
    body().stepPositionsMultiDof(dt, nullptr, &changes_[0]);
    body().updateCollisionObjectWorldTransforms(rotations_, vectors_);
  }

  void wake() { body().wakeUp(); }

 private:
  btMultiBody& body() const { return *collider_->m_multiBody; }

  btMultiBodyLinkCollider* collider_;
  btAlignedObjectArray<btScalar> forces_, changes_, numbers_;
  btAlignedObjectArray<btVector3> velocities_, vectors_;
  btAlignedObjectArray<btMatrix3x3> matrices_;
  btAlignedObjectArray<btQuaternion> rotations_;
};

}  // namespace raycontact::bullet::detail

#endif  // RAYCONTACT_BULLET_MULTIBODY_LINK_HPP
