// SPDX-License-Identifier: MIT OR Apache-2.0
/** Bullet's deformable world, set up the one way that works with implicit forces from outside. */
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
    world_.setImplicit(true);
    world_.setUseProjection(true);  // without it nothing moves
    world_.setLineSearch(false);
    world_.setGravity(gravity);
    world_.getWorldInfo().m_gravity = gravity;
    elasticity_.setPoissonRatio(static_cast<btScalar>(poisson_ratio));
    elasticity_.setYoungsModulus(static_cast<btScalar>(youngs_modulus));
    contact_.register_with(solver_, world_);
  }

  ~SoftWorld() {
    solver_.getLagrangianForceArray()->clear();  // removing a body would detect once more
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

  void step(double dt) { world_.stepSimulation(static_cast<btScalar>(dt), 0); }

  btDeformableMultiBodyDynamicsWorld& world() { return world_; }
  raycontact::bullet::ContactForce& contact() { return contact_; }
  const raycontact::bullet::ContactForce& contact() const { return contact_; }

 private:
  btDeformableGravityForce gravity_;
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
