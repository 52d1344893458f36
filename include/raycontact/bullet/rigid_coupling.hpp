// SPDX-License-Identifier: MIT OR Apache-2.0
/** Rigid bodies inside the implicit solve, whose only unknowns are nodes: their six are eliminated exactly. */
#ifndef RAYCONTACT_BULLET_RIGID_COUPLING_HPP
#define RAYCONTACT_BULLET_RIGID_COUPLING_HPP

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "raycontact/bullet/precision.hpp"

namespace raycontact::bullet::detail {

using Twist = std::array<double, 6>;  // of a velocity: linear, angular; of a force: force, torque

inline btVector3 three_of(const Twist& twist, std::size_t first) {
  return {static_cast<btScalar>(twist[first]), static_cast<btScalar>(twist[first + 1]),
          static_cast<btScalar>(twist[first + 2])};
}

/** A symmetric positive definite 6 x 6 system, factored in place (Cholesky). */
class TwistSystem {
 public:
  double& at(std::size_t row, std::size_t column) { return a_[6 * row + column]; }

  void factor() {
    for (std::size_t j = 0; j < 6; ++j)
      for (std::size_t i = j; i < 6; ++i) {
        double sum = at(i, j);
        for (std::size_t k = 0; k < j; ++k) sum -= at(i, k) * at(j, k);
        at(i, j) = i == j ? std::sqrt(sum) : sum / at(j, j);
      }
  }

  void solve(Twist& x) const {
    const auto l = [&](std::size_t i, std::size_t j) { return a_[6 * i + j]; };
    for (std::size_t i = 0; i < 6; ++i) {
      for (std::size_t k = 0; k < i; ++k) x[i] -= l(i, k) * x[k];
      x[i] /= l(i, i);
    }
    for (std::size_t i = 6; i-- > 0;) {
      for (std::size_t k = i + 1; k < 6; ++k) x[i] -= l(k, i) * x[k];
      x[i] /= l(i, i);
    }
  }

 private:
  std::array<double, 36> a_{};
};

/** A rigid body that takes part: movable, or with a velocity that is given. */
struct CoupledRigid {
  btRigidBody* body;
  bool movable;
  TwistSystem system;  // M + dt * sum of J^T D J, factored
  Twist load;          // work array
  Twist change;        // of the velocity, as of the last solve
  Twist first_change;  // the same, at the start of the nodes' solve
  Twist before;        // the velocity at the start of the step
  Twist ahead;         // the velocity with which it was taken ahead for detection
};

/** The point of a rigid body at which a row acts: velocity = sign * (linear + angular x arm). */
struct RigidPoint {
  int rigid = -1;  // none
  btScalar sign = 0;
  btVector3 arm{0, 0, 0};

  btVector3 velocity(const Twist& twist) const { return sign * (three_of(twist, 0) + three_of(twist, 3).cross(arm)); }

  void add_load(const btVector3& force, Twist& load) const {
    const btVector3 torque = arm.cross(force);
    for (int axis = 0; axis < 3; ++axis) {
      load[static_cast<std::size_t>(axis)] += double(sign) * double(force[axis]);
      load[static_cast<std::size_t>(axis) + 3] += double(sign) * double(torque[axis]);
    }
  }
};

class RigidCoupling {
 public:
  void clear() { rigids_.clear(); }

  /** Returns the number by which rows refer to the body. */
  int add(btRigidBody& body, const Twist& ahead) {
    for (std::size_t i = 0; i < rigids_.size(); ++i)
      if (rigids_[i].body == &body) return static_cast<int>(i);
    rigids_.push_back({&body, !body.isStaticOrKinematicObject() && body.getInvMass() > 0, {}, {}, {}, {}, {}, {}});
    rigids_.back().before = velocity(body);
    rigids_.back().ahead = ahead;
    return static_cast<int>(rigids_.size()) - 1;
  }

  CoupledRigid& operator[](int i) { return rigids_[static_cast<std::size_t>(i)]; }
  const CoupledRigid& operator[](int i) const { return rigids_[static_cast<std::size_t>(i)]; }
  bool is_movable(int i) const { return i >= 0 && rigids_[static_cast<std::size_t>(i)].movable; }
  std::vector<CoupledRigid>& all() { return rigids_; }

  static Twist velocity(const btRigidBody& body) {
    const btVector3 &v = body.getLinearVelocity(), &w = body.getAngularVelocity();
    return {{double(v.x()), double(v.y()), double(v.z()), double(w.x()), double(w.y()), double(w.z())}};
  }

  void start_systems() {
    for (CoupledRigid& rigid : rigids_) {
      rigid.load = rigid.change = rigid.first_change = {};
      rigid.system = {};
      if (!rigid.movable) continue;
      const btMatrix3x3 inertia = rigid.body->getInvInertiaTensorWorld().inverse();
      for (std::size_t i = 0; i < 3; ++i) {
        rigid.system.at(i, i) = 1.0 / double(rigid.body->getInvMass());
        for (std::size_t j = 0; j < 3; ++j)
          rigid.system.at(i + 3, j + 3) = double(inertia[static_cast<int>(i)][static_cast<int>(j)]);
      }
    }
  }

  void clear_loads() {
    for (CoupledRigid& rigid : rigids_) rigid.load = {};
  }

  /** change = factor * system^-1 load, for all movable bodies. */
  void solve(double factor) {
    for (CoupledRigid& rigid : rigids_) {
      rigid.change = {};
      if (!rigid.movable) continue;
      rigid.change = rigid.load;
      rigid.system.solve(rigid.change);
      for (double& c : rigid.change) c *= factor;
    }
  }

 private:
  std::vector<CoupledRigid> rigids_;
};

}  // namespace raycontact::bullet::detail

#endif  // RAYCONTACT_BULLET_RIGID_COUPLING_HPP
