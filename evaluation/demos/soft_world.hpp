// SPDX-License-Identifier: MIT OR Apache-2.0
/** Bullet's deformable world, with contact. */
#ifndef RAYCONTACT_DEMOS_SOFT_WORLD_HPP
#define RAYCONTACT_DEMOS_SOFT_WORLD_HPP

#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableGravityForce.h>
#include <BulletSoftBody/btDeformableLinearElasticityForce.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "raycontact/bullet.hpp"

namespace demo {

class SoftWorld {
 public:
  SoftWorld(double youngs_modulus, double poisson_ratio, const raycontact::bullet::ContactOptions& contact_options,
            const btVector3& gravity = btVector3(0, 0, 0))
      : gravity_(gravity),
        dispatcher_(&configuration_),
        world_(&dispatcher_, &broadphase_, &constraint_solver_, &configuration_, &solver_),
        contact_(contact_options) {
    constraint_solver_.setDeformableSolver(&solver_);
    world_.setGravity(gravity);
    world_.getWorldInfo().m_gravity = gravity;
    elasticity_.setPoissonRatio(static_cast<btScalar>(poisson_ratio));
    elasticity_.setYoungsModulus(static_cast<btScalar>(youngs_modulus));
    contact_.register_with(world_);
  }

  ~SoftWorld() {
    for (const std::unique_ptr<btSoftBody>& body : bodies_) world_.removeSoftBody(body.get());
  }

  SoftWorld(const SoftWorld&) = delete;
  SoftWorld& operator=(const SoftWorld&) = delete;

  btSoftBody& add(const raycontact::bullet::Cage& cage, double mass,
                  const raycontact::bullet::BodyOptions& options = {}) {
    bodies_.push_back(raycontact::bullet::make_soft_body(world_.getWorldInfo(), cage, static_cast<btScalar>(mass)));
    btSoftBody& body = *bodies_.back();
    world_.addSoftBody(&body);
    world_.addForce(&body, &elasticity_);
    world_.addForce(&body, &gravity_);
    contact_.add_body(body, cage.skin, options);
    return body;
  }

  void remove(btSoftBody& body) {
    world_.removeSoftBody(&body);
    bodies_.erase(
        std::find_if(bodies_.begin(), bodies_.end(), [&](const auto& other) { return other.get() == &body; }));
  }

  /** The part of a momentum that rounding may spend once nothing else does. */
  static constexpr double rounding = raycontact::bullet::double_precision ? 1e-12 : 1e-6;

  /** Takes away what else spends momentum in Bullet: conjugate gradients cut short, and damping by 1 % a second. */
  void keep_momentum() {
    solver_.solve_to_rounding();
    elasticity_.setDamping(0, elasticity_.m_damping_beta);
  }

  void step(double dt) { world_.stepSimulation(static_cast<btScalar>(dt), 0); }

  btDeformableMultiBodyDynamicsWorld& world() { return world_; }
  raycontact::bullet::ContactForce& contact() { return contact_; }
  const raycontact::bullet::ContactForce& contact() const { return contact_; }

 private:
  struct Solver : btDeformableBodySolver {
    void solve_to_rounding() {
      m_cg.m_maxIterations = 1000;
      m_cg.m_tolerance = SIMD_EPSILON * SIMD_EPSILON;
    }
  };

  btDeformableGravityForce gravity_;
  btSoftBodyRigidBodyCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broadphase_;
  Solver solver_;
  btDeformableMultiBodyConstraintSolver constraint_solver_;
  btDeformableMultiBodyDynamicsWorld world_;
  btDeformableLinearElasticityForce elasticity_;
  raycontact::bullet::ContactForce contact_;
  std::vector<std::unique_ptr<btSoftBody>> bodies_;
};

}  // namespace demo

#endif  // RAYCONTACT_DEMOS_SOFT_WORLD_HPP
