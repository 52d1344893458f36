// SPDX-License-Identifier: MIT OR Apache-2.0
/** A link of a multibody, or its base, as the contact system has to know it: a rigid body that joints hold. */
#ifndef RAYCONTACT_BULLET_MULTIBODY_LINK_HPP
#define RAYCONTACT_BULLET_MULTIBODY_LINK_HPP

#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraint.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>
#include <LinearMath/btAlignedObjectArray.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>

#include "raycontact/bullet/precision.hpp"

namespace raycontact::bullet::detail {

/** Linear and angular part, along the world's axes, the latter about the link's centre of mass. */
struct Twist {
  btVector3 linear{0, 0, 0}, angular{0, 0, 0};
};

/** On linear and angular velocity along a body's own axes. */
using Matrix6 = std::array<std::array<double, 6>, 6>;

/** The inverse of a symmetric positive definite matrix. */
inline Matrix6 inverse(Matrix6 matrix) {
  Matrix6 result{};
  for (std::size_t k = 0; k < 6; ++k) result[k][k] = 1;
  for (std::size_t k = 0; k < 6; ++k)
    for (std::size_t row = 0; row < 6; ++row) {
      const double factor = row == k ? 1 - 1 / matrix[k][k] : matrix[row][k] / matrix[k][k];
      for (std::size_t column = 0; column < 6; ++column) {
        matrix[row][column] -= factor * matrix[k][column];
        result[row][column] -= factor * result[k][column];
      }
    }
  return result;
}

inline Twist product(const Matrix6& matrix, const Twist& twist) {
  btVector3 result[2]{};
  for (int row = 0; row < 6; ++row) {
    double sum = 0;
    for (int k = 0; k < 6; ++k)
      sum += matrix[std::size_t(row)][std::size_t(k)] * double((k < 3 ? twist.linear : twist.angular)[k % 3]);
    result[row / 3][row % 3] = btScalar(sum);
  }
  return {result[0], result[1]};
}

/**
 * What a link weighs, how fast it is, and how it takes an impulse: as the other links, its joints and these joints'
 * motors and limits let it. Bullet's own solve says what a motor bears, so each step begins with the impulse of the
 * step before, and contact then changes it to its own. To that change a motor that is not at its limit does not yield.
 */
class MultibodyLink {
 public:
  /** None, or that of this collider in a world. */
  explicit MultibodyLink(btMultiBodyLinkCollider* collider = nullptr, btMultiBodyDynamicsWorld* world = nullptr)
      : collider_(collider), world_(world) {}

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

  /** Finds how the multibody answers impulses on this link, once Bullet has solved its joints in this step. */
  void find_response() {
    find_held();
    const btMatrix3x3& turn = collider_->getWorldTransform().getBasis();
    for (int k = 0; k < 6; ++k) {
      Twist unit;
      (k < 3 ? unit.linear : unit.angular) = turn.getColumn(k % 3);
      answer(unit, answers_[std::size_t(k)]);
      hold(answers_[std::size_t(k)].change);
    }
  }

  /** Whether an impulse on this moves the other too, by the response that was found. */
  bool moves(const MultibodyLink& other) const {
    if (&body() != &other.body()) return false;
    const auto changes = [this](int first, int count) {
      for (const Answer& answer : answers_)
        for (int k = first; k < first + count; ++k)
          if (answer.change[k] != 0) return true;
      return false;
    };
    bool does = changes(0, 6);
    for (int link = other.collider_->m_link; link >= 0 && !does; link = body().getParent(link))
      does = changes(6 + body().getLink(link).m_dofOffset, body().getLink(link).m_dofCount);
    return does;
  }

  /**
   * What the system is to take the link for: a body of its own, with the inertia that the response shows. What no
   * impulse moves is a million times as heavy as the link. Of `count` links that move one another, itself included,
   * each could be pushed like all others. A body that is taken for lighter than it is stays stable, one that is taken
   * for heavier does not. All are lighter than the multibody if each has its part of what it shows, or what it weighs
   * alone, or anything between.
   */
  Matrix6 articulated_inertia(std::size_t count) const {
    const std::array<double, 6> own = own_inertia();
    Matrix6 response{};
    for (std::size_t row = 0; row < 6; ++row) {
      for (std::size_t column = 0; column < 6; ++column)
        for (int k = 0; k < answers_[row].force.size(); ++k)
          for (const std::size_t side : {row, column})
            response[row][column] += 0.5 * double(answers_[side].force[k]) *
                                     double(answers_[side == row ? column : row].change[k]);
      response[row][row] += 1e-6 / own[row];
    }
    Matrix6 inertia = inverse(response);
    const double part = 1 / double(count);
    for (std::size_t row = 0; row < 6; ++row)
      for (std::size_t column = 0; column < 6; ++column)
        inertia[row][column] = part * part * inertia[row][column] + (row == column ? (1 - part) * own[row] : 0);
    return inertia;
  }

  std::array<double, 6> own_inertia() const {
    const btVector3 about = inertia();
    const double linear = double(mass());
    return {{linear, linear, linear, double(about.x()), double(about.y()), double(about.z())}};
  }

  Twist velocity() {
    velocities_.resize(2 * (body().getNumLinks() + 1));
    btVector3 *angular = &velocities_[0], *linear = angular + body().getNumLinks() + 1;
    body().compTreeLinkVelocities(angular, linear);
    const btMatrix3x3& turn = collider_->getWorldTransform().getBasis();
    const int index = collider_->m_link + 1;
    return {turn * linear[index], turn * angular[index]};
  }

  /** Changes the velocities of the whole multibody by an impulse on this link, before its joints are solved. */
  void push(const Twist& impulse) {
    if (!answer(impulse, pushed_)) return;
    body().applyDeltaVeeMultiDof(&pushed_.change[0], 1);
  }

  /** The same once they have been, and the pose by what that makes in `dt`. */
  void push_solved(const Twist& impulse, btScalar dt) {
    if (!answer(impulse, pushed_)) return;
    hold(pushed_.change);
    body().applyDeltaVeeMultiDof(&pushed_.change[0], 1);
    body().stepPositionsMultiDof(dt, nullptr, &pushed_.change[0]);
    body().updateCollisionObjectWorldTransforms(rotations_, vectors_);
  }

  void wake() { body().wakeUp(); }

 private:
  using Numbers = btAlignedObjectArray<btScalar>;

  /** An impulse on the base and the joints, and how it changes their velocities. */
  struct Answer {
    Numbers force, change;
  };

  btMultiBody& body() const { return *collider_->m_multiBody; }

  bool answer(const Twist& impulse, Answer& to) {
    if (impulse.linear.isZero() && impulse.angular.isZero()) return false;
    to.force.resize(6 + body().getNumDofs());
    body().fillConstraintJacobianMultiDof(collider_->m_link, collider_->getWorldTransform().getOrigin(),
                                          impulse.angular, impulse.linear, &to.force[0], numbers_, vectors_, matrices_);
    find_change(to);
    return true;
  }

  void find_change(Answer& to) {
    to.change.resize(to.force.size());
    body().calcAccelerationDeltasMultiDof(&to.force[0], &to.change[0], numbers_, vectors_);
  }

  /** The motors that are not at their limits, and the joints that are at theirs, each apart from those before. */
  void find_held() {
    held_.resize(0);
    for (int i = 0; i < world_->getNumMultiBodyConstraints(); ++i) {
      btMultiBodyConstraint& joint = *world_->getMultiBodyConstraint(i);
      if (joint.getMultiBodyA() != &body() || !holds(joint)) continue;
      Answer own;
      own.force.resize(6 + body().getNumDofs());
      for (int k = 0; k < own.force.size(); ++k) own.force[k] = joint.jacobianA(0)[k];
      find_change(own);
      const btScalar alone = product(own.force, own.change);
      for (int h = 0; h < held_.size(); ++h) {
        const btScalar part = product(own.force, held_[h].change);
        for (int k = 0; k < own.force.size(); ++k) {
          own.force[k] -= part * held_[h].force[k];
          own.change[k] -= part * held_[h].change[k];
        }
      }
      const btScalar left = product(own.force, own.change);
      if (!(left > btScalar(1e-4) * alone)) continue;  // the others hold it
      for (int k = 0; k < own.force.size(); ++k) {
        own.force[k] /= btSqrt(left);
        own.change[k] /= btSqrt(left);
      }
      held_.push_back(own);
    }
  }

  static bool holds(btMultiBodyConstraint& joint) {
    switch (joint.getConstraintType()) {
      case MULTIBODY_CONSTRAINT_1DOF_JOINT_MOTOR:
        return btFabs(joint.getAppliedImpulse(0)) < joint.getMaxAppliedImpulse();
      case MULTIBODY_CONSTRAINT_LIMIT:
        return joint.getAppliedImpulse(0) > 0 || joint.getAppliedImpulse(1) > 0;
      default:
        return false;
    }
  }

  /** Takes from a change of velocities what motors and limits do not yield. */
  void hold(Numbers& change) const {
    for (int h = 0; h < held_.size(); ++h) {
      const btScalar part = product(held_[h].force, change);
      for (int k = 0; k < change.size(); ++k) change[k] -= part * held_[h].change[k];
    }
  }

  static btScalar product(const Numbers& a, const Numbers& b) {
    btScalar sum = 0;
    for (int k = 0; k < a.size(); ++k) sum += a[k] * b[k];
    return sum;
  }

  btMultiBodyLinkCollider* collider_;
  btMultiBodyDynamicsWorld* world_;
  std::array<Answer, 6> answers_;
  Answer pushed_;
  btAlignedObjectArray<Answer> held_;
  Numbers numbers_;
  btAlignedObjectArray<btVector3> velocities_, vectors_;
  btAlignedObjectArray<btMatrix3x3> matrices_;
  btAlignedObjectArray<btQuaternion> rotations_;
};

}  // namespace raycontact::bullet::detail

#endif  // RAYCONTACT_BULLET_MULTIBODY_LINK_HPP
