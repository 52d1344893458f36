// SPDX-License-Identifier: MIT OR Apache-2.0
// Bullet 3.24: btConvexHullShape where both shapes are convex, else btGImpactMeshShape, its shape for concave bodies
// that move.
// c++ -std=c++17 -O3 -shared -fPIC -isystem /usr/include/bullet bullet.cpp -o bullet.so -lBulletCollision -lLinearMath
#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <btBulletCollisionCommon.h>

#include <memory>
#include <vector>

#include "penetration.h"

namespace {

// The shapes' size is 1. Bullet's own default, 0.04, is made for bodies of a metre that must not overlap.
constexpr btScalar margin = 0.001f;

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

  World() { btGImpactCollisionAlgorithm::registerAlgorithm(&dispatcher); }
};

// Never freed: the order in which shared libraries end is nobody's.
World& world() {
  static World* const only = new World;
  return *only;
}

// contactPairTest() asks for another kind of algorithm, which GImpact has not got.
struct Collector : btManifoldResult {
  penetration_contact* contacts;
  size_t capacity, count = 0;

  Collector(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b, penetration_contact* out, size_t room)
      : btManifoldResult(a, b), contacts(out), capacity(room) {}

  // The normal leads from the second body to the first; overlaps are negative distances.
  void addContactPoint(const btVector3& normal, const btVector3& second, btScalar distance) override {
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

}  // namespace

int penetration_load(const penetration_surface* first, const penetration_surface* second) {
  const bool are_hulls = first->is_convex && second->is_convex;
  world().bodies[0] = std::make_unique<Body>(*first, are_hulls);
  world().bodies[1] = std::make_unique<Body>(*second, are_hulls);
  return PENETRATION_OK;
}

int penetration_move(const double poses[24], const double*, const double*) {
  for (int i = 0; i < 2; ++i) {
    const double* m = poses + 12 * i;
    const auto at = [m](int k) { return btScalar(m[k]); };
    const btMatrix3x3 turn(at(0), at(1), at(2), at(4), at(5), at(6), at(8), at(9), at(10));
    world().bodies[i]->object.setWorldTransform(btTransform(turn, {at(3), at(7), at(11)}));
  }
  return PENETRATION_OK;
}

int penetration_inside(uint8_t*, uint8_t*) { return PENETRATION_NOT_SUPPORTED; }

ptrdiff_t penetration_contacts(penetration_contact* contacts, size_t capacity) {
  btCollisionObject &a = world().bodies[0]->object, &b = world().bodies[1]->object;
  const btCollisionObjectWrapper first(nullptr, a.getCollisionShape(), &a, a.getWorldTransform(), -1, -1);
  const btCollisionObjectWrapper second(nullptr, b.getCollisionShape(), &b, b.getWorldTransform(), -1, -1);
  Collector collector(&first, &second, contacts, capacity);
  btDispatcher& dispatcher = world().dispatcher;
  btCollisionAlgorithm* algorithm = dispatcher.findAlgorithm(&first, &second, nullptr, BT_CONTACT_POINT_ALGORITHMS);
  if (!algorithm) return -PENETRATION_FAILED;
  algorithm->processCollision(&first, &second, world().world.getDispatchInfo(), &collector);
  algorithm->~btCollisionAlgorithm();
  dispatcher.freeCollisionAlgorithm(algorithm);
  return ptrdiff_t(collector.count);
}
