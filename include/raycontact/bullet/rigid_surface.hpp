// SPDX-License-Identifier: MIT OR Apache-2.0
/** The surface of a rigid body as triangles, out of its collision shape. */
#ifndef RAYCONTACT_BULLET_RIGID_SURFACE_HPP
#define RAYCONTACT_BULLET_RIGID_SURFACE_HPP

#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <BulletCollision/CollisionShapes/btConcaveShape.h>
#include <BulletCollision/CollisionShapes/btConvexShape.h>
#include <BulletCollision/CollisionShapes/btPolyhedralConvexShape.h>
#include <BulletCollision/CollisionShapes/btTriangleCallback.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <LinearMath/btConvexHullComputer.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "raycontact/bullet/precision.hpp"

namespace raycontact::bullet {

/** In the body's own coordinates, outward. */
struct RigidSurface {
  std::vector<btVector3> points;    ///< its vertices, m
  std::vector<uint32_t> triangles;  ///< three point numbers each
};

namespace detail {

inline RigidSurface convex_hull(const std::vector<btVector3>& points) {
  btConvexHullComputer hull;
  hull.compute(&points[0][0], sizeof(btVector3), static_cast<int>(points.size()), 0, 0);
  RigidSurface surface;
  for (int i = 0; i < hull.vertices.size(); ++i) surface.points.push_back(hull.vertices[i]);
  btVector3 middle(0, 0, 0);
  for (const btVector3& p : surface.points) middle += p / btScalar(surface.points.size());
  for (int f = 0; f < hull.faces.size(); ++f) {
    const btConvexHullComputer::Edge* first = &hull.edges[hull.faces[f]];
    const int apex = first->getSourceVertex();
    for (const auto* edge = first->getNextEdgeOfFace(); edge->getTargetVertex() != apex;
         edge = edge->getNextEdgeOfFace()) {
      int b = edge->getSourceVertex(), c = edge->getTargetVertex();
      const btVector3& a = hull.vertices[apex];
      if ((hull.vertices[b] - a).cross(hull.vertices[c] - a).dot(a - middle) < 0) std::swap(b, c);
      for (int v : {apex, b, c}) surface.triangles.push_back(static_cast<uint32_t>(v));
    }
  }
  return surface;
}

/** Triangles of an indexed mesh arrive one by one, with their corners as copies: equal ones are one point again. */
class TriangleCollector : public btTriangleCallback {
 public:
  void processTriangle(btVector3* corners, int, int) override {
    for (int k = 0; k < 3; ++k) {
      const std::array<btScalar, 3> key{{corners[k].x(), corners[k].y(), corners[k].z()}};
      const auto found = numbers_.emplace(key, static_cast<uint32_t>(surface.points.size()));
      if (found.second) surface.points.push_back(corners[k]);
      surface.triangles.push_back(found.first->second);
    }
  }
  RigidSurface surface;

 private:
  std::map<std::array<btScalar, 3>, uint32_t> numbers_;
};

inline std::vector<btVector3> points_of_convex_shape(const btConvexShape& shape) {
  std::vector<btVector3> points;
  if (shape.isPolyhedral()) {
    const auto& polyhedron = static_cast<const btPolyhedralConvexShape&>(shape);
    points.resize(static_cast<std::size_t>(polyhedron.getNumVertices()));
    for (std::size_t i = 0; i < points.size(); ++i) polyhedron.getVertex(static_cast<int>(i), points[i]);
    return points;
  }
  // Round shapes by their outermost points along directions that spread evenly (a spiral by the golden angle).
  constexpr int directions = 400;
  for (int i = 0; i < directions; ++i) {
    const double z = 1 - (2 * i + 1.0) / directions, r = std::sqrt(1 - z * z), turn = 2.399963229728653 * i;
    points.push_back(shape.localGetSupportingVertex(
        btVector3(btScalar(r * std::cos(turn)), btScalar(r * std::sin(turn)), btScalar(z))));
  }
  return points;
}

}  // namespace detail

/**
 * Convex shapes by their hull, round ones with about 400 points; triangle meshes and height fields as they are;
 * compounds by the surfaces of their children, which should not overlap. Throws std::invalid_argument for other shapes
 * (planes).
 */
inline RigidSurface surface_of_shape(const btCollisionShape& shape) {
  if (shape.isCompound()) {
    const auto& compound = static_cast<const btCompoundShape&>(shape);
    RigidSurface all;
    for (int c = 0; c < compound.getNumChildShapes(); ++c) {
      const RigidSurface child = surface_of_shape(*compound.getChildShape(c));
      const auto first = static_cast<uint32_t>(all.points.size());
      for (const btVector3& point : child.points) all.points.push_back(compound.getChildTransform(c) * point);
      for (uint32_t corner : child.triangles) all.triangles.push_back(first + corner);
    }
    return all;
  }
  if (shape.isConvex())
    return detail::convex_hull(detail::points_of_convex_shape(static_cast<const btConvexShape&>(shape)));
  if (shape.isConcave() && shape.getShapeType() != STATIC_PLANE_PROXYTYPE) {
    detail::TriangleCollector collector;
    const btVector3 everywhere(BT_LARGE_FLOAT, BT_LARGE_FLOAT, BT_LARGE_FLOAT);
    static_cast<const btConcaveShape&>(shape).processAllTriangles(&collector, -everywhere, everywhere);
    return std::move(collector.surface);
  }
  throw std::invalid_argument(std::string("rigid body: no surface can be made of its shape (") + shape.getName() +
                              "); give add_rigid_body a RigidSurface, or use a half-space for a plane");
}

}  // namespace raycontact::bullet

#endif  // RAYCONTACT_BULLET_RIGID_SURFACE_HPP
