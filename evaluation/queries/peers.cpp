// SPDX-License-Identifier: MIT OR Apache-2.0
// Nearest points, inside tests and signed distances by libraries without a Python package that offers them: Embree's point
// query and CGAL's trees of boxes. measure.py calls it.
#include <CGAL/AABB_face_graph_triangle_primitive.h>
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Side_of_triangle_mesh.h>
#include <CGAL/Surface_mesh.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

#include "embree_library.hpp"

namespace {

struct Float3 {
  float x, y, z;
};

Float3 operator+(Float3 a, Float3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Float3 operator-(Float3 a, Float3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Float3 operator*(float factor, Float3 a) { return {factor * a.x, factor * a.y, factor * a.z}; }
float dot(Float3 a, Float3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

Float3 nearest_of_segment(Float3 start, Float3 way, Float3 point) {
  const float squared = dot(way, way);
  if (!(squared > 0)) return start;
  return start + std::fmin(std::fmax(dot(point - start, way) / squared, 0.0f), 1.0f) * way;
}

// In barycentric coordinates; where one of them is negative the nearest point lies on an edge.
Float3 nearest_of_triangle(Float3 a, Float3 b, Float3 c, Float3 point) {
  const Float3 ab = b - a, ac = c - a, ap = point - a;
  const float bb = dot(ab, ab), bc = dot(ab, ac), cc = dot(ac, ac), pb = dot(ap, ab), pc = dot(ap, ac);
  const float area = bb * cc - bc * bc, v = cc * pb - bc * pc, w = bb * pc - bc * pb;
  if (area > 0 && v >= 0 && w >= 0 && v + w <= area) return a + (v / area) * ab + (w / area) * ac;
  Float3 nearest = nearest_of_segment(a, ab, point);
  float least = dot(point - nearest, point - nearest);
  for (const Float3 other : {nearest_of_segment(a, ac, point), nearest_of_segment(b, c - b, point)}) {
    const float squared = dot(point - other, point - other);
    if (squared < least) least = squared, nearest = other;
  }
  return nearest;
}

// As Embree 3 has it, with room for what Embree 4 adds behind: another number of an instance.
struct Context {
  RTCPointQueryContext of_3;
  unsigned more[14];

  Context() : of_3{}, more{} {
    of_3.instID[0] = RTC_INVALID_GEOMETRY_ID;
    of_3.instStackSize = 0;
  }
};

class Embree {
 public:
  Embree(const char* path, const float* positions, size_t vertex_count, const uint32_t* triangles,
         size_t triangle_count)
      : embree_(path), triangles_(triangles), vertex_count_(vertex_count) {
    device_ = embree_.rtcNewDevice("threads=1,set_affinity=0");
    scene_ = embree_.rtcNewScene(device_);
    embree_.rtcSetSceneFlags(scene_, RTCSceneFlags(RTC_SCENE_FLAG_DYNAMIC | RTC_SCENE_FLAG_ROBUST));
    embree_.rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_LOW);
    geometry_ = embree_.rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    embree_.rtcSetGeometryBuildQuality(geometry_, RTC_BUILD_QUALITY_REFIT);
    set_positions(positions);
    embree_.rtcSetSharedGeometryBuffer(geometry_, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, triangles, 0,
                                       3 * sizeof(uint32_t), triangle_count);
    embree_.rtcCommitGeometry(geometry_);
    embree_.rtcAttachGeometry(scene_, geometry_);
    embree_.rtcCommitScene(scene_);
  }
  Embree(const Embree&) = delete;
  ~Embree() {
    embree_.rtcReleaseGeometry(geometry_);
    embree_.rtcReleaseScene(scene_);
    embree_.rtcReleaseDevice(device_);
  }

  void move(const float* positions) {
    set_positions(positions);
    embree_.rtcUpdateGeometryBuffer(geometry_, RTC_BUFFER_TYPE_VERTEX, 0);
    embree_.rtcCommitGeometry(geometry_);
    embree_.rtcCommitScene(scene_);
  }

  void closest(const float* points, size_t count, double* distances) {
    for (size_t i = 0; i < count; ++i) {
      RTCPointQuery query{points[3 * i], points[3 * i + 1], points[3 * i + 2], 0, INFINITY};
      Context context;
      embree_.rtcPointQuery(scene_, &query, &context.of_3, look_at_triangle, this);
      distances[i] = query.radius;
    }
  }

 private:
  void set_positions(const float* positions) {
    positions_ = reinterpret_cast<const Float3*>(positions);
    embree_.rtcSetSharedGeometryBuffer(geometry_, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, positions, 0,
                                       sizeof(Float3), vertex_count_);
  }

  static bool look_at_triangle(RTCPointQueryFunctionArguments* arguments) {
    const Embree& self = *static_cast<const Embree*>(arguments->userPtr);
    const uint32_t* corners = self.triangles_ + 3 * size_t(arguments->primID);
    RTCPointQuery& query = *arguments->query;
    const Float3 point{query.x, query.y, query.z};
    const Float3 way = nearest_of_triangle(self.positions_[corners[0]], self.positions_[corners[1]],
                                           self.positions_[corners[2]], point) - point;
    const float distance = std::sqrt(dot(way, way));
    if (!(distance < query.radius)) return false;
    query.radius = distance;
    return true;
  }

  bench::EmbreeLibrary embree_;
  const Float3* positions_ = nullptr;
  const uint32_t* triangles_;
  size_t vertex_count_;
  RTCDevice device_;
  RTCScene scene_;
  RTCGeometry geometry_;
};

class Cgal {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using Surface = CGAL::Surface_mesh<Kernel::Point_3>;
  using Primitive = CGAL::AABB_face_graph_triangle_primitive<Surface>;
  using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;
  using Side = CGAL::Side_of_triangle_mesh<Surface, Kernel, CGAL::Default, Tree>;

 public:
  Cgal(const double* positions, size_t vertex_count, const uint32_t* triangles, size_t triangle_count) {
    for (size_t i = 0; i < vertex_count; ++i)
      surface_.add_vertex({positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]});
    for (size_t i = 0; i < triangle_count; ++i)
      surface_.add_face(Surface::Vertex_index(triangles[3 * i]), Surface::Vertex_index(triangles[3 * i + 1]),
                        Surface::Vertex_index(triangles[3 * i + 2]));
    build();
  }

  void move(const double* positions) {
    for (const auto vertex : surface_.vertices())
      surface_.point(vertex) = {positions[3 * vertex], positions[3 * vertex + 1], positions[3 * vertex + 2]};
    build();
  }

  void closest(const double* points, size_t count, double* distances) {
    for (size_t i = 0; i < count; ++i) distances[i] = std::sqrt(tree_->squared_distance(at(points, i)));
  }

  // 1 inside, else 0.
  void inside(const double* points, size_t count, double* marks) {
    const Side side(*tree_);
    for (size_t i = 0; i < count; ++i) marks[i] = side(at(points, i)) == CGAL::ON_BOUNDED_SIDE;
  }

  void signed_distances(const double* points, size_t count, double* distances) {
    closest(points, count, distances);
    const Side side(*tree_);
    for (size_t i = 0; i < count; ++i)
      if (side(at(points, i)) == CGAL::ON_BOUNDED_SIDE) distances[i] = -distances[i];
  }

 private:
  static Kernel::Point_3 at(const double* points, size_t i) {
    return {points[3 * i], points[3 * i + 1], points[3 * i + 2]};
  }

  // The tree cannot be refitted. It makes its hints for distances by itself, as is documented.
  void build() {
    tree_.emplace(surface_.faces().begin(), surface_.faces().end(), surface_);
    tree_->build();
    tree_->accelerate_distance_queries();
  }

  Surface surface_;
  std::optional<Tree> tree_;
};

}  // namespace

extern "C" {
void* embree_create(const char* path, const float* positions, size_t vertex_count, const uint32_t* triangles,
                    size_t triangle_count) {
  return new Embree(path, positions, vertex_count, triangles, triangle_count);
}
void embree_move(void* it, const float* positions) { static_cast<Embree*>(it)->move(positions); }
void embree_closest(void* it, const float* points, size_t count, double* distances) {
  static_cast<Embree*>(it)->closest(points, count, distances);
}
void embree_destroy(void* it) { delete static_cast<Embree*>(it); }

void* cgal_create(const double* positions, size_t vertex_count, const uint32_t* triangles, size_t triangle_count) {
  return new Cgal(positions, vertex_count, triangles, triangle_count);
}
void cgal_move(void* it, const double* positions) { static_cast<Cgal*>(it)->move(positions); }
void cgal_closest(void* it, const double* points, size_t count, double* distances) {
  static_cast<Cgal*>(it)->closest(points, count, distances);
}
void cgal_inside(void* it, const double* points, size_t count, double* marks) {
  static_cast<Cgal*>(it)->inside(points, count, marks);
}
void cgal_signed(void* it, const double* points, size_t count, double* distances) {
  static_cast<Cgal*>(it)->signed_distances(points, count, distances);
}
void cgal_destroy(void* it) { delete static_cast<Cgal*>(it); }
}
