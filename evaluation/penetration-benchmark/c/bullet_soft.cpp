// SPDX-License-Identifier: MIT OR Apache-2.0
// Bullet 3.24's deformable world with its own contact between soft bodies, for deforming.py. The settings are those of
// its deformable examples: implicit steps, linear elasticity with a little damping, contact impulses of vertices on faces.
// c++ -std=c++17 -O3 -shared -fPIC -isystem /usr/include/bullet bullet_soft.cpp -o bullet_soft.so
// with -lBulletSoftBody -lBulletDynamics -lBulletCollision -lLinearMath
#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableGravityForce.h>
#include <BulletSoftBody/btDeformableLinearElasticityForce.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <btBulletDynamicsCommon.h>

#include <memory>
#include <vector>

namespace {

struct SoftWorld {
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btDeformableBodySolver solver;
  btDeformableMultiBodyConstraintSolver constraint_solver;
  btDeformableMultiBodyDynamicsWorld world{&dispatcher, &broadphase, &constraint_solver, &configuration, &solver};
  btDeformableLinearElasticityForce elasticity;
  std::unique_ptr<btDeformableGravityForce> weight;
  std::vector<std::unique_ptr<btSoftBody>> bodies;

  ~SoftWorld() {
    for (auto& body : bodies) world.removeSoftBody(body.get());
  }
};

std::unique_ptr<SoftWorld>& current() {
  static auto* const only = new std::unique_ptr<SoftWorld>;
  return *only;
}

btVector3 vector(const double* v) { return {btScalar(v[0]), btScalar(v[1]), btScalar(v[2])}; }

}  // namespace

extern "C" {

/** A new, empty world in place of the one before; gravity pulls down along x. */
void bullet_soft_begin(double young, double poisson, double gravity) {
  current() = std::make_unique<SoftWorld>();
  SoftWorld& made = *current();
  made.constraint_solver.setDeformableSolver(&made.solver);
  const btVector3 pull(btScalar(-gravity), 0, 0);
  made.world.setGravity(pull);
  made.world.getWorldInfo().m_gravity = pull;
  made.weight = std::make_unique<btDeformableGravityForce>(pull);
  made.world.setImplicit(true);
  made.world.setLineSearch(false);
  made.world.setUseProjection(true);
  made.world.getSolverInfo().m_deformable_erp = btScalar(0.3);
  made.world.getSolverInfo().m_deformable_maxErrorReduction = btScalar(200);
  made.world.getSolverInfo().m_leastSquaresResidualThreshold = btScalar(1e-3);
  made.world.getSolverInfo().m_splitImpulse = false;
  made.world.getSolverInfo().m_numIterations = 100;
  made.elasticity.setYoungsModulus(btScalar(young));
  made.elasticity.setPoissonRatio(btScalar(poisson));
  made.elasticity.setDamping(btScalar(0.1), btScalar(0.01));
}

/** Adds a body of nodes with positions and velocities (count x 3) and masses, 0 for those that are held, and
 * tetrahedra. */
void bullet_soft_add(const double* positions, const double* velocities, const double* masses, int count,
                     const int* tetrahedra, int tetrahedron_count, double margin) {
  SoftWorld& into = *current();
  std::vector<btVector3> nodes;
  std::vector<btScalar> weights(masses, masses + count);
  for (int n = 0; n < count; ++n) nodes.push_back(vector(positions + 3 * n));
  into.bodies.push_back(
      std::make_unique<btSoftBody>(&into.world.getWorldInfo(), count, nodes.data(), weights.data()));
  btSoftBody& body = *into.bodies.back();
  for (int t = 0; t < tetrahedron_count; ++t) {
    const int* n = tetrahedra + 4 * t;
    body.appendTetra(n[0], n[1], n[2], n[3]);
    for (int i = 0; i < 4; ++i)
      for (int j = i + 1; j < 4; ++j) body.appendLink(n[i], n[j], nullptr, true);
  }
  btSoftBodyHelpers::generateBoundaryFaces(&body);
  body.initializeDmInverse();
  body.m_tetraScratches.resize(body.m_tetras.size());
  body.m_tetraScratchesTn.resize(body.m_tetras.size());
  // The implicit step starts from the second of these.
  for (int n = 0; n < count; ++n) body.m_nodes[n].m_v = body.m_nodes[n].m_vn = vector(velocities + 3 * n);
  body.getCollisionShape()->setMargin(btScalar(margin));
  body.m_cfg.kKHR = body.m_cfg.kCHR = 1;
  body.m_cfg.kDF = 0;
  body.m_cfg.collisions = btSoftBody::fCollision::SDF_RD | btSoftBody::fCollision::VF_DD;
  body.m_sleepingThreshold = 0;
  body.setActivationState(DISABLE_DEACTIVATION);
  into.world.addSoftBody(&body);
  into.world.addForce(&body, &into.elasticity);
  into.world.addForce(&body, into.weight.get());
}

/** From now on these nodes, held ones, counted over all bodies, move along x with a speed. */
void bullet_soft_push(const int* nodes, int count, double speed) {
  for (int i = 0; i < count; ++i) {
    int n = nodes[i];
    auto body = current()->bodies.begin();
    for (; n >= (*body)->m_nodes.size(); ++body) n -= (*body)->m_nodes.size();
    btSoftBody::Node& node = (*body)->m_nodes[n];
    node.m_v = node.m_vn = btVector3(btScalar(speed), 0, 0);
  }
}

void bullet_soft_step(double time_step, int steps) {
  for (int i = 0; i < steps; ++i) current()->world.stepSimulation(btScalar(time_step), 0);
}

/** The positions of all nodes, body by body. */
void bullet_soft_read(double* out) {
  for (const auto& body : current()->bodies)
    for (int n = 0; n < body->m_nodes.size(); ++n)
      for (int axis = 0; axis < 3; ++axis) *out++ = double(body->m_nodes[n].m_x[axis]);
}
}
