// SPDX-License-Identifier: MIT OR Apache-2.0
// Bullet 3.24: btConvexHullShape where both shapes are convex, else btGImpactMeshShape, its shape for concave bodies
// that move. At the end its own world, for solvers.py.
// c++ -std=c++17 -O3 -shared -fPIC -isystem /usr/include/bullet bullet.cpp -o bullet.so
// with -lBulletDynamics -lBulletCollision -lLinearMath
#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <btBulletDynamicsCommon.h>

#include <memory>
#include <vector>

#include "penetration.h"

namespace {

// The shapes' size is 1. Bullet's own default, 0.04, is made for bodies of a metre that must not overlap.
constexpr btScalar margin = 0.001f;

// Of 3 x 4 numbers.
btTransform transform(const double* pose) {
  const auto at = [pose](int k) { return btScalar(pose[k]); };
  const btMatrix3x3 turn(at(0), at(1), at(2), at(4), at(5), at(6), at(8), at(9), at(10));
  return btTransform(turn, {at(3), at(7), at(11)});
}

struct Body {
  std::vector<btScalar> positions;
  std::vector<int> triangles;
  std::unique_ptr<btTriangleIndexVertexArray> mesh;
  std::unique_ptr<btCollisionShape> shape;
  btCollisionObject object;

  Body(const penetration_surface& surface, bool is_hull)
      : positions(surface.positions, surface.positions + 3 * surface.vertex_count),
        triangles(surface.triangles, surface.triangles + 3 * surface.triangle_count) {
    const int stride = 3 * sizeof(btScalar);
    if (is_hull) {
      shape = std::make_unique<btConvexHullShape>(positions.data(), int(surface.vertex_count), stride);
    } else {
      mesh = std::make_unique<btTriangleIndexVertexArray>(int(surface.triangle_count), triangles.data(),
                                                          int(3 * sizeof(int)), int(surface.vertex_count),
                                                          positions.data(), stride);
      auto concave = std::make_unique<btGImpactMeshShape>(mesh.get());
      concave->setMargin(margin);
      concave->updateBound();
      shape = std::move(concave);
    }
    shape->setMargin(margin);
    object.setCollisionShape(shape.get());
  }
};

struct World {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btCollisionWorld world{&dispatcher, &broadphase, &configuration};
  std::unique_ptr<Body> bodies[2];
  // With its manifold, which hulls keep from step to step.
  btCollisionAlgorithm* algorithm = nullptr;

  World() { btGImpactCollisionAlgorithm::registerAlgorithm(&dispatcher); }
};

// Never freed: the order in which shared libraries end is nobody's.
World& world() {
  static World* const only = new World;
  return *only;
}

struct List {
  penetration_contact* contacts;
  size_t capacity, count = 0;

  // The normal leads from the second body to the first; overlaps are negative distances.
  void add(const btVector3& normal, const btVector3& second, btScalar distance) {
    if (distance >= 0) return;
    if (count < capacity) {
      const btVector3 first = second + normal * distance;
      penetration_contact& out = contacts[count];
      for (int k = 0; k < 3; ++k) {
        out.first[k] = first[k];
        out.second[k] = second[k];
        out.direction[k] = normal[k];
      }
      out.depth = -distance;
      out.weight = 1;
    }
    ++count;
  }
};

// All contacts of GImpact, which keeps none: its manifolds would pick four of each.
struct Collector : btManifoldResult {
  List& list;

  Collector(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b, List& out)
      : btManifoldResult(a, b), list(out) {}

  void addContactPoint(const btVector3& normal, const btVector3& second, btScalar distance) override {
    list.add(normal, second, distance);
  }
};

}  // namespace

int penetration_load(const penetration_surface* first, const penetration_surface* second) {
  const bool are_hulls = first->is_convex && second->is_convex;
  if (world().algorithm) {
    world().algorithm->~btCollisionAlgorithm();
    world().dispatcher.freeCollisionAlgorithm(world().algorithm);
    world().algorithm = nullptr;
  }
  world().bodies[0] = std::make_unique<Body>(*first, are_hulls);
  world().bodies[1] = std::make_unique<Body>(*second, are_hulls);
  return PENETRATION_OK;
}

int penetration_move(const double poses[24], const double*, const double*) {
  for (int i = 0; i < 2; ++i) world().bodies[i]->object.setWorldTransform(transform(poses + 12 * i));
  return PENETRATION_OK;
}

int penetration_inside(uint8_t*, uint8_t*) { return PENETRATION_NOT_SUPPORTED; }

ptrdiff_t penetration_contacts(penetration_contact* contacts, size_t capacity) {
  btCollisionObject &a = world().bodies[0]->object, &b = world().bodies[1]->object;
  const btCollisionObjectWrapper first(nullptr, a.getCollisionShape(), &a, a.getWorldTransform(), -1, -1);
  const btCollisionObjectWrapper second(nullptr, b.getCollisionShape(), &b, b.getWorldTransform(), -1, -1);
  btCollisionAlgorithm*& algorithm = world().algorithm;
  // contactPairTest() asks for another kind of algorithm, which GImpact has not got.
  if (!algorithm)
    algorithm = world().dispatcher.findAlgorithm(&first, &second, nullptr, BT_CONTACT_POINT_ALGORITHMS);
  if (!algorithm) return -PENETRATION_FAILED;
  List list{contacts, capacity};
  if (a.getCollisionShape()->isConcave()) {
    Collector result(&first, &second, list);
    algorithm->processCollision(&first, &second, world().world.getDispatchInfo(), &result);
    return ptrdiff_t(list.count);
  }
  btManifoldResult result(&first, &second);
  algorithm->processCollision(&first, &second, world().world.getDispatchInfo(), &result);
  btManifoldArray manifolds;
  algorithm->getAllContactManifolds(manifolds);
  for (int m = 0; m < manifolds.size(); ++m)
    for (int i = 0; i < manifolds[m]->getNumContacts(); ++i) {
      const btManifoldPoint& point = manifolds[m]->getContactPoint(i);
      if (manifolds[m]->getBody0() == &a)
        list.add(point.m_normalWorldOnB, point.m_positionWorldOnB, point.getDistance());
      else
        list.add(-point.m_normalWorldOnB, point.m_positionWorldOnA, point.getDistance());
    }
  return ptrdiff_t(list.count);
}

namespace {

// The numbers of the parts of solvers.py.
enum Kind { hulls, gimpact, static_mesh };

struct Solid {
  std::vector<std::unique_ptr<Body>> parts;
  std::unique_ptr<btCompoundShape> compound;
  std::unique_ptr<btBvhTriangleMeshShape> ground;
  std::unique_ptr<btRigidBody> body;
};

struct Dynamics {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
  std::vector<Solid> solids;

  Dynamics() { btGImpactCollisionAlgorithm::registerAlgorithm(&dispatcher); }
  ~Dynamics() {
    for (Solid& solid : solids) world.removeRigidBody(solid.body.get());
  }
};

std::unique_ptr<Dynamics>& dynamics() {
  static auto* const only = new std::unique_ptr<Dynamics>;
  return *only;
}

btVector3 vector(const double* v) { return {btScalar(v[0]), btScalar(v[1]), btScalar(v[2])}; }

}  // namespace

extern "C" {

/** A new, empty world in place of the one before. erp: what part of an overlap is taken out in a step. */
void bullet_begin(const double* gravity, double erp) {
  dynamics() = std::make_unique<Dynamics>();
  dynamics()->world.setGravity(vector(gravity));
  dynamics()->world.getSolverInfo().m_erp2 = btScalar(erp);
}

/** Adds a body by its parts, in the frame of its principal axes; pose: 3 x 4. No mass: it stands still. */
void bullet_add(const penetration_surface* parts, int count, int kind, double mass, const double* inertia,
                const double* pose, const double* velocity) {
  Solid solid;
  for (int i = 0; i < count; ++i) solid.parts.push_back(std::make_unique<Body>(parts[i], kind == hulls));
  btCollisionShape* shape = solid.parts[0]->shape.get();
  if (kind == static_mesh) {
    solid.ground = std::make_unique<btBvhTriangleMeshShape>(solid.parts[0]->mesh.get(), true);
    solid.ground->setMargin(margin);
    shape = solid.ground.get();
  } else if (count > 1) {
    solid.compound = std::make_unique<btCompoundShape>();
    for (auto& part : solid.parts) solid.compound->addChildShape(btTransform::getIdentity(), part->shape.get());
    shape = solid.compound.get();
  }
  const btVector3 moments = mass > 0 ? vector(inertia) : btVector3(0, 0, 0);
  btRigidBody::btRigidBodyConstructionInfo info(btScalar(mass), nullptr, shape, moments);
  info.m_startWorldTransform = transform(pose);
  solid.body = std::make_unique<btRigidBody>(info);
  if (mass > 0) solid.body->setLinearVelocity(vector(velocity));
  dynamics()->world.addRigidBody(solid.body.get());
  dynamics()->solids.push_back(std::move(solid));
}

void bullet_step(double time_step, int steps) {
  for (int i = 0; i < steps; ++i) dynamics()->world.stepSimulation(btScalar(time_step), 0);
}

/** 18 numbers of each body: its pose, 3 x 4, its velocity and its spin. */
void bullet_read(double* out) {
  for (const Solid& solid : dynamics()->solids) {
    const btTransform& at = solid.body->getWorldTransform();
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) *out++ = at.getBasis()[i][j];
      *out++ = at.getOrigin()[i];
    }
    for (int i = 0; i < 3; ++i) *out++ = solid.body->getLinearVelocity()[i];
    for (int i = 0; i < 3; ++i) *out++ = solid.body->getAngularVelocity()[i];
  }
}
}
