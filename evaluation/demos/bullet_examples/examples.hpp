// SPDX-License-Identifier: MIT OR Apache-2.0
/**
 * Scenes with the sizes, masses and materials of Bullet's own deformable examples, built anew, with Bullet's contact or
 * with raycontact's. A line that a user of Bullet adds or changes for raycontact ends in "// +".
 */
#ifndef RAYCONTACT_DEMOS_BULLET_EXAMPLES_HPP
#define RAYCONTACT_DEMOS_BULLET_EXAMPLES_HPP

#include <BulletDynamics/Featherstone/btMultiBodyJointMotor.h>
#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableGravityForce.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btDeformableNeoHookeanForce.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "inside_test.hpp"
#include "multibody.hpp"
#include "raycontact/bullet.hpp"  // +

namespace demo {

using collision = btSoftBody::fCollision;

/** A world of soft boxes, rigid boxes and what the scene adds. */
class Example {
 public:
  struct Material {
    double youngs_modulus, poisson_ratio;
    double friction;
    double element_edge;
    bool is_explicit;  // how Bullet's example integrates, with neo-Hookean elements then
  };

  Example(bool is_ours, double gravity, const Material& material)
      : is_ours_(is_ours),
        material_(material),
        gravity_(btVector3(0, btScalar(-gravity), 0)),
        world_(&dispatcher_, &broadphase_, &constraint_solver_, &configuration_, &solver_),
        contact_(options(material)) {  // +
    constraint_solver_.setDeformableSolver(&solver_);
    world_.setGravity(gravity_.m_gravity);
    world_.getWorldInfo().m_gravity = gravity_.m_gravity;
    world_.getWorldInfo().m_sparsesdf.setDefaultVoxelsz(btScalar(material.element_edge / 2));
    world_.getWorldInfo().m_sparsesdf.Reset();
    world_.setImplicit(!material.is_explicit);
    world_.setUseProjection(!material.is_explicit);
    world_.setLineSearch(false);
    world_.getSolverInfo().m_deformable_erp = btScalar(0.3);
    world_.getSolverInfo().m_numIterations = 100;
    if (is_ours) contact_.register_with(world_);  // +
    if (is_ours || !material.is_explicit) {
      auto linear = is_ours ? std::make_unique<raycontact::bullet::CorotatedElasticity>()  // +
                            : std::make_unique<btDeformableLinearElasticityForce>();
      linear->setPoissonRatio(btScalar(material.poisson_ratio));
      linear->setYoungsModulus(btScalar(material.youngs_modulus));
      linear->setDamping(btScalar(0.1), btScalar(0.01));
      elasticity_ = std::move(linear);
    } else {
      auto rubber = std::make_unique<btDeformableNeoHookeanForce>();
      rubber->setPoissonRatio(btScalar(material.poisson_ratio));
      rubber->setYoungsModulus(btScalar(material.youngs_modulus));
      rubber->setDamping(btScalar(0.01));
      elasticity_ = std::move(rubber);
    }
  }

  virtual ~Example() {
    for (const auto& body : soft_) world_.removeSoftBody(body.get());
    for (const auto& body : rigid_) world_.removeRigidBody(body.get());
  }

  Example(const Example&) = delete;
  Example& operator=(const Example&) = delete;

  /** Steps of Bullet's own contact are those of its examples; raycontact takes the same. */
  virtual void step(double dt) {
    time_ += dt;
    world_.stepSimulation(btScalar(dt), 0);
  }

  virtual std::string outcome() const = 0;

  int inverted() const {
    int count = 0;
    for (const auto& body : soft_) count += raycontact::bullet::inverted_tetrahedra(*body);
    return count;
  }

  /** The speed of the fastest node, m/s. NaN where one is not finite. */
  double fastest() const {
    double fastest = 0;
    for (const auto& body : soft_)
      for (int n = 0; n < body->m_nodes.size(); ++n) {
        const double speed = double(body->m_nodes[n].m_v.length());
        if (!std::isfinite(speed) || !std::isfinite(double(body->m_nodes[n].m_x.length()))) return std::nan("");
        fastest = std::max(fastest, speed);
      }
    return fastest;
  }

  /** How deep the deepest node lies below the surface of another body, m. */
  double deepest() const {
    double deepest = 0;
    for (std::size_t b = 0; b < soft_.size(); ++b) {
      for (int n = 0; n < soft_[b]->m_nodes.size(); ++n)
        for (const auto& [object, half] : boxes_)
          deepest = std::max(deepest, depth_in_box(soft_[b]->m_nodes[n].m_x, object->getWorldTransform(), half));
      for (std::size_t other = 0; other < soft_.size(); ++other)
        if (other != b) deepest = std::max(deepest, depth_in(*soft_[other], *soft_[b]));
    }
    return deepest;
  }

  /** The height of the lowest node of all, m. */
  double lowest() const {
    double lowest = std::numeric_limits<double>::infinity();
    for (const auto& body : soft_)
      for (int n = 0; n < body->m_nodes.size(); ++n) lowest = std::min(lowest, double(body->m_nodes[n].m_x.y()));
    return lowest;
  }

  /** From the lowest node of the first body to its highest, m. */
  double size() const {
    double highest = -std::numeric_limits<double>::infinity();
    for (int n = 0; n < soft(0).m_nodes.size(); ++n) highest = std::max(highest, double(soft(0).m_nodes[n].m_x.y()));
    return highest - lowest();
  }

  const btSoftBody& soft(std::size_t i) const { return *soft_[i]; }
  raycontact::bullet::ContactForce& contact() { return contact_; }

 protected:
  static raycontact::bullet::ContactOptions options(const Material& m) {
    auto options = raycontact::bullet::ContactOptions::elastic(m.youngs_modulus, m.poisson_ratio, m.element_edge);  // +
    options.friction = m.friction;                                                                                  // +
    return options;
  }

  btSoftBody& add_soft(const btVector3& half, const btVector3& middle, double mass, int flags, double margin) {
    std::vector<double> positions;
    for (int n = 0; n < 8; ++n)
      for (int axis = 0; axis < 3; ++axis)
        positions.push_back(double(middle[axis]) + ((n >> axis & 1) == 1 ? 1 : -1) * double(half[axis]));
    const std::vector<uint32_t> triangles{0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                          2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    std::array<int, 3> cells{};
    for (std::size_t axis = 0; axis < 3; ++axis)
      cells[axis] = std::max(1, int(std::lround(2 * double(half[int(axis)]) / material_.element_edge)));
    const raycontact::bullet::Cage cage = raycontact::bullet::make_cage(positions, triangles, cells);
    soft_.push_back(raycontact::bullet::make_soft_body(world_.getWorldInfo(), cage, btScalar(mass)));
    btSoftBody& body = *soft_.back();
    if (!is_ours_) {
      body.setActivationState(ACTIVE_TAG);  // + (DISABLE_DEACTIVATION for raycontact, as make_soft_body has it)
      body.m_cfg.collisions = flags;        // + (0 for raycontact, the same)
      body.m_cfg.kKHR = body.m_cfg.kCHR = 1;
      body.m_cfg.kDF = btScalar(material_.friction);
      body.setSpringStiffness(10);
      body.getCollisionShape()->setMargin(btScalar(margin));
    }
    world_.addSoftBody(&body);
    world_.addForce(&body, elasticity_.get());
    world_.addForce(&body, &gravity_);
    if (is_ours_) contact_.add_body(body);  // +
    return body;
  }

  btRigidBody& add_box(const btVector3& half, double mass, const btVector3& at) {
    shapes_.push_back(std::make_unique<btBoxShape>(half));
    btVector3 inertia(0, 0, 0);
    if (mass > 0) shapes_.back()->calculateLocalInertia(btScalar(mass), inertia);
    rigid_.push_back(std::make_unique<btRigidBody>(
        btRigidBody::btRigidBodyConstructionInfo(btScalar(mass), nullptr, shapes_.back().get(), inertia)));
    btRigidBody& body = *rigid_.back();
    body.setCenterOfMassTransform(btTransform(btQuaternion::getIdentity(), at));
    body.setFriction(btScalar(material_.friction));
    body.setActivationState(DISABLE_DEACTIVATION);
    world_.addRigidBody(&body);
    if (is_ours_) contact_.add_rigid_body(body);  // +
    boxes_.push_back({&body, half});
    return body;
  }

  bool is_ours_;
  double time_ = 0;
  Material material_;
  std::vector<std::pair<const btCollisionObject*, btVector3>> boxes_;  // judged

 private:
  static double depth_in_box(const btVector3& point, const btTransform& place, const btVector3& half) {
    const btVector3 local = place.invXform(point);
    double depth = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) depth = std::min(depth, double(half[axis] - btFabs(local[axis])));
    return depth;
  }

  static double distance(const btVector3& p, const btVector3& a, const btVector3& b, const btVector3& c) {
    const btVector3 normal = (b - a).cross(c - a);
    const btVector3 corner[3] = {a, b, c};
    double nearest = std::numeric_limits<double>::infinity();
    bool is_over = true;
    for (int k = 0; k < 3; ++k) {
      const btVector3 edge = corner[(k + 1) % 3] - corner[k];
      const btScalar along = btClamped((p - corner[k]).dot(edge) / edge.length2(), btScalar(0), btScalar(1));
      nearest = std::min(nearest, double((p - corner[k] - along * edge).length()));
      is_over = is_over && normal.cross(edge).dot(p - corner[k]) >= 0;
    }
    return is_over ? double(btFabs(normal.dot(p - a)) / normal.length()) : nearest;
  }

  static double depth_in(const btSoftBody& body, const btSoftBody& nodes) {
    std::vector<double> positions;
    std::vector<uint32_t> triangles;
    for (int n = 0; n < body.m_nodes.size(); ++n)
      for (int axis = 0; axis < 3; ++axis) positions.push_back(double(body.m_nodes[n].m_x[axis]));
    for (int f = 0; f < body.m_faces.size(); ++f)
      for (const btSoftBody::Node* node : body.m_faces[f].m_n)
        triangles.push_back(static_cast<uint32_t>(node - &body.m_nodes[0]));
    const InsideTest inside(positions, triangles);
    double deepest = 0;
    for (int n = 0; n < nodes.m_nodes.size(); ++n) {
      const btVector3& p = nodes.m_nodes[n].m_x;
      const double at[3] = {double(p.x()), double(p.y()), double(p.z())};
      if (!inside.contains(at)) continue;
      double depth = std::numeric_limits<double>::infinity();
      for (int f = 0; f < body.m_faces.size(); ++f) {
        const auto& n3 = body.m_faces[f].m_n;
        depth = std::min(depth, distance(p, n3[0]->m_x, n3[1]->m_x, n3[2]->m_x));
      }
      deepest = std::max(deepest, depth);
    }
    return deepest;
  }

  btDeformableGravityForce gravity_;
  btSoftBodyRigidBodyCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btDeformableBodySolver solver_;
  btDeformableMultiBodyConstraintSolver constraint_solver_;

 protected:
  btDeformableMultiBodyDynamicsWorld world_;

 private:
  std::unique_ptr<btDeformableLagrangianForce> elasticity_;
  std::vector<std::unique_ptr<btBoxShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> rigid_;
  std::vector<std::unique_ptr<btSoftBody>> soft_;

 protected:
  raycontact::bullet::ContactForce contact_;
};

}  // namespace demo

#endif  // RAYCONTACT_DEMOS_BULLET_EXAMPLES_HPP
