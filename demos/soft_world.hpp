// SPDX-License-Identifier: MIT OR Apache-2.0
/** Bullet's deformable world, set up the one way that works with implicit forces from outside. */
#ifndef RAYCONTACT_DEMOS_SOFT_WORLD_HPP
#define RAYCONTACT_DEMOS_SOFT_WORLD_HPP

#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableLinearElasticityForce.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <btBulletDynamicsCommon.h>

#include <memory>
#include <utility>
#include <vector>

#include "raycontact/bullet.hpp"

namespace demo {

class SoftWorld {
 public:
  SoftWorld(double youngs_modulus, double poisson_ratio, const raycontact::bullet::ContactOptions& contact_options)
      : dispatcher_(&configuration_),
        world_(&dispatcher_, &broadphase_, &constraint_solver_, &configuration_, &solver_),
        contact_(contact_options) {
    constraint_solver_.setDeformableSolver(&solver_);
    world_.setImplicit(true);
    world_.setUseProjection(true);  // without it nothing moves
    world_.setLineSearch(false);
    world_.setGravity(btVector3(0, 0, 0));
    world_.getWorldInfo().m_gravity.setZero();
    elasticity_.setPoissonRatio(static_cast<btScalar>(poisson_ratio));
    elasticity_.setYoungsModulus(static_cast<btScalar>(youngs_modulus));
    contact_.register_with(solver_);
  }

  ~SoftWorld() {
    solver_.getLagrangianForceArray()->clear();  // removing a body would detect once more
    for (const std::unique_ptr<btSoftBody>& body : bodies_) world_.removeSoftBody(body.get());
  }

  SoftWorld(const SoftWorld&) = delete;
  SoftWorld& operator=(const SoftWorld&) = delete;

  btSoftBody& add(const raycontact::bullet::Cage& cage, double mass) {
    bodies_.push_back(make_soft_body(world_.getWorldInfo(), cage, static_cast<btScalar>(mass)));
    btSoftBody& body = *bodies_.back();
    world_.addSoftBody(&body);
    world_.addForce(&body, &elasticity_);
    contact_.add_body(body, cage.skin);
    return body;
  }

  void step(double dt) { world_.stepSimulation(static_cast<btScalar>(dt), 0); }

  const raycontact::bullet::ContactForce& contact() const { return contact_; }

 private:
  btSoftBodyRigidBodyCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broadphase_;
  btDeformableBodySolver solver_;
  btDeformableMultiBodyConstraintSolver constraint_solver_;
  btDeformableMultiBodyDynamicsWorld world_;
  btDeformableLinearElasticityForce elasticity_;
  raycontact::bullet::ContactForce contact_;
  std::vector<std::unique_ptr<btSoftBody>> bodies_;
};

}  // namespace demo

#endif  // RAYCONTACT_DEMOS_SOFT_WORLD_HPP
