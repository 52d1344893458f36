// SPDX-License-Identifier: MIT OR Apache-2.0
#include "engine.hpp"

#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableGravityForce.h>
#include <BulletSoftBody/btDeformableLinearElasticityForce.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <limits>

#include "raycontact/bullet.hpp"
#include "system_engine.hpp"
#include "tuned_solver.hpp"

namespace demo {

namespace rb = raycontact::bullet;

namespace {

btScalar scalar(double x) { return static_cast<btScalar>(x); }

rb::ContactOptions contact_options(const Scene& scene, const Setting& setting) {
  const double stiffness = setting.stiffness > 0 ? setting.stiffness : scene.stiffness();
  rb::ContactOptions options;
  if (setting.method == Method::paper) {
    options = rb::ContactOptions::paper(stiffness);
  } else {
    options.stiffness = stiffness / scene.area_per_vertex();
    if (setting.method == Method::ours) options.law = RAYC_LAW_RAY_LENGTH;
    options.depth_cap =
        rb::suggested_depth_cap(scene.youngs_modulus, scene.edge(), options.stiffness, setting.depth_cap);
    // Skins much finer than their cages: their vertices are more than the cages can tell apart.
    const SceneBody& body = scene.bodies.front();
    if (body.cage.skin.points.size() > 2 * body.cage.nodes.size()) {
      options.sampling = scene.sample_spacing > 0 ? RAYC_SAMPLING_SPACING : RAYC_SAMPLING_VERTICES;
      options.sampling_value = scene.sample_spacing * scene.edge();
    }
  }
  options.friction = setting.friction >= 0 ? setting.friction : scene.friction;
  options.damping_time = setting.damping_time;
  options.threads = setting.threads;
  return options;
}

rb::HalfSpace floor_of(const Scene& scene, const Setting& setting) {
  const double stiffness = setting.stiffness > 0 ? setting.stiffness : scene.stiffness();
  return {btVector3(0, 1, 0), 0, scalar(stiffness / scene.area_per_vertex())};
}

/** What both worlds share: bodies made of cages, and a rigid floor for Bullet's own contact. */
class Base : public Engine {
 public:
  Nodes nodes(std::size_t body) const override {
    Nodes all;
    for (int n = 0; n < pointers_[body]->m_nodes.size(); ++n) {
      const btSoftBody::Node& node = pointers_[body]->m_nodes[n];
      for (int axis = 0; axis < 3; ++axis) {
        all.positions.push_back(double(node.m_x[axis]));
        all.velocities.push_back(double(node.m_v[axis]));
      }
      all.masses.push_back(node.m_im > 0 ? 1 / double(node.m_im) : std::numeric_limits<double>::infinity());
    }
    return all;
  }

 protected:
  btSoftBody& make_body(btSoftBodyWorldInfo& info, const SceneBody& description) {
    owned_.push_back(rb::make_soft_body(info, description.cage, scalar(description.mass)));
    btSoftBody& body = *owned_.back();
    pointers_.push_back(&body);
    for (int node : description.pinned) body.setMass(node, 0);
    body.setVelocity(description.velocity);
    return body;
  }

  void add_floor(btDiscreteDynamicsWorld& world) {
    floor_shape_ = std::make_unique<btBoxShape>(btVector3(50, 5, 50));
    floor_ = std::make_unique<btRigidBody>(btRigidBody::btRigidBodyConstructionInfo(0, nullptr, floor_shape_.get()));
    btTransform below = btTransform::getIdentity();
    below.setOrigin(btVector3(0, -5, 0));
    floor_->setWorldTransform(below);
    world.addRigidBody(floor_.get());
  }

  btSoftBodyRigidBodyCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  std::vector<std::unique_ptr<btSoftBody>> owned_;
  std::vector<btSoftBody*> pointers_;
  std::unique_ptr<btBoxShape> floor_shape_;
  std::unique_ptr<btRigidBody> floor_;
};

class DeformableEngine : public Base {
 public:
  DeformableEngine(const Scene& scene, const Setting& setting)
      : is_ours_(setting.method <= Method::paper),
        solver_(setting.iterations > 0 ? setting.iterations : scene.iterations),
        world_(&dispatcher_, &broadphase_, &constraint_solver_, &configuration_, &solver_),
        elasticity_(setting.stock_elasticity || setting.method == Method::vf_dd_explicit
                        ? std::make_unique<btDeformableLinearElasticityForce>()
                        : std::make_unique<MergedElasticity>()),
        contact_(contact_options(scene, setting)) {
    // The merged product is for implicit integration: the explicit one needs Bullet's damping differential alone.
    const bool is_implicit = setting.method != Method::vf_dd_explicit;
    constraint_solver_.setDeformableSolver(&solver_);
    world_.setImplicit(is_implicit);
    world_.setUseProjection(true);  // without it nothing moves
    world_.setLineSearch(false);
    world_.setGravity(scene.gravity);
    world_.getWorldInfo().m_gravity = scene.gravity;
    elasticity_->setPoissonRatio(scalar(scene.poisson_ratio));
    elasticity_->setYoungsModulus(scalar(scene.youngs_modulus));
    elasticity_->setDamping(scalar(scene.damping_alpha), scalar(0.01));
    gravity_ = std::make_unique<btDeformableGravityForce>(scene.gravity);
    if (is_ours_) contact_.register_with(world_);
    if (setting.method == Method::ours || setting.method == Method::pressure)
      solver_.detect_again(contact_, setting.passes);
    for (const SceneBody& description : scene.bodies) add(scene, description, setting);
    if (scene.has_floor && is_ours_) contact_.add_half_space(floor_of(scene, setting));
    if (scene.has_floor && !is_ours_) add_floor(world_);
  }

  ~DeformableEngine() override {
    for (btSoftBody* body : pointers_) world_.removeSoftBody(body);
    if (floor_) world_.removeRigidBody(floor_.get());
  }

  void step(double dt) override { world_.stepSimulation(scalar(dt), 0); }
  std::size_t contact_count() const override { return contact_.contact_count(); }
  double detection_ms() const override { return contact_.last_detection_ms(); }

 private:
  void add(const Scene& scene, const SceneBody& description, const Setting& setting) {
    btSoftBody& body = make_body(world_.getWorldInfo(), description);
    if (!is_ours_) {
      const double friction = setting.friction >= 0 ? setting.friction : scene.friction;
      using collision = btSoftBody::fCollision;
      body.m_cfg.collisions = collision::SDF_RD | collision::SDF_RDN | collision::VF_DD;
      body.m_cfg.kDF = scalar(friction);
      if (setting.stiffness > 0) body.setSpringStiffness(scalar(setting.stiffness));
    }
    world_.addSoftBody(&body);
    world_.addForce(&body, elasticity_.get());
    world_.addForce(&body, gravity_.get());
    rb::BodyOptions options;
    options.self_collision = description.self_collision;
    if (is_ours_) contact_.add_body(body, description.cage.skin, options);
  }

  bool is_ours_;
  TunedSolver solver_;
  btDeformableMultiBodyConstraintSolver constraint_solver_;
  btDeformableMultiBodyDynamicsWorld world_;
  std::unique_ptr<btDeformableLinearElasticityForce> elasticity_;
  std::unique_ptr<btDeformableGravityForce> gravity_;
  rb::ContactForce contact_;
};

class ClassicEngine : public Base {
 public:
  ClassicEngine(const Scene& scene, const Setting& setting)
      : is_ours_(setting.method == Method::classic),
        world_(&dispatcher_, &broadphase_, &constraint_solver_, &configuration_),
        contact_(contact_options(scene, setting)) {
    world_.setGravity(scene.gravity);
    world_.getWorldInfo().m_gravity = scene.gravity;
    for (const SceneBody& description : scene.bodies) add(scene, description, setting);
    if (scene.has_floor && is_ours_) contact_.add_half_space(floor_of(scene, setting));
    if (scene.has_floor && !is_ours_) add_floor(world_);
  }

  ~ClassicEngine() override {
    for (btSoftBody* body : pointers_) world_.removeSoftBody(body);
    if (floor_) world_.removeRigidBody(floor_.get());
  }

  void step(double dt) override {
    world_.stepSimulation(scalar(dt), 0);
    if (is_ours_) contact_.apply(dt);
  }

  std::size_t contact_count() const override { return contact_.contact_count(); }
  double detection_ms() const override { return contact_.last_detection_ms(); }

 private:
  void add(const Scene& scene, const SceneBody& description, const Setting& setting) {
    btSoftBody& body = make_body(world_.getWorldInfo(), description);
    body.m_cfg.kDF = scalar(setting.friction >= 0 ? setting.friction : scene.friction);
    // Classic bodies have no Young's modulus: every edge of every tetrahedron is a link, stiff and solved ten times.
    body.m_materials[0]->m_kLST = scalar(0.9);
    body.m_cfg.piterations = 10;
    body.m_cfg.kDP = scalar(scene_damping);
    using collision = btSoftBody::fCollision;
    if (is_ours_) {
      body.m_cfg.collisions = 0;
    } else if (setting.method == Method::vf_ss) {
      body.m_cfg.collisions = collision::VF_SS | collision::SDF_RS;
    } else {
      body.m_cfg.collisions = collision::CL_SS | collision::CL_RS;
      body.generateClusters(32);
    }
    world_.addSoftBody(&body);
    rb::BodyOptions options;
    options.self_collision = description.self_collision;
    if (is_ours_) contact_.add_body(body, description.cage.skin, options);
  }

  static constexpr double scene_damping = 0.005;

  bool is_ours_;
  btSequentialImpulseConstraintSolver constraint_solver_;
  btSoftRigidDynamicsWorld world_;
  rb::ClassicContact contact_;
};

}  // namespace

const std::vector<std::string>& method_names() {
  static const std::vector<std::string> names = {
      "ours", "pressure", "paper", "classic", "vf_dd_implicit", "vf_dd_explicit", "vf_ss", "cl_ss", "contact_system"};
  return names;
}

std::unique_ptr<Engine> Engine::make(const Scene& scene, const Setting& setting) {
  if (setting.method == Method::contact_system) return make_system_engine(scene, setting);
  const bool is_classic =
      setting.method == Method::classic || setting.method == Method::vf_ss || setting.method == Method::cl_ss;
  if (is_classic) return std::make_unique<ClassicEngine>(scene, setting);
  return std::make_unique<DeformableEngine>(scene, setting);
}

}  // namespace demo
