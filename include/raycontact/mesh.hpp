// SPDX-License-Identifier: MIT OR Apache-2.0
/**
 * @file
 * Meshes, and octrees to trace rays with.
 */
#ifndef RAYCONTACT_MESH_HPP
#define RAYCONTACT_MESH_HPP

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "distributed.h"
#include "result.hpp"
#include "span.hpp"

namespace raycontact {

#ifdef RAYCONTACT_NO_EXCEPTIONS
inline namespace with_results {
#else
inline namespace with_exceptions {
#endif

/// @cond internal
namespace detail {

template <class Handle, rayc_status (*destroy)(Handle*)>
struct Destroy {
  void operator()(Handle* handle) const noexcept { static_cast<void>(destroy(handle)); }
};

template <class Handle, rayc_status (*destroy)(Handle*)>
using Owner = std::unique_ptr<Handle, Destroy<Handle, destroy>>;

/** The library's defaults. Where they cannot be had the struct's size stays 0, which every call refuses. */
template <class Options>
Options defaults(rayc_status (*fill)(std::size_t, Options*)) {
  Options options{};
  const rayc_status abi = check_abi();
  const rayc_status status = abi == RAYC_STATUS_OK ? fill(sizeof options, &options) : abi;
#ifdef RAYCONTACT_NO_EXCEPTIONS
  static_cast<void>(status);
#else
  check(status);
#endif
  return options;
}

}  // namespace detail
/// @endcond

/** The library's defaults, to be changed field by field. */
inline rayc_mesh_options default_mesh_options() { return detail::defaults(rayc_default_mesh_options); }
/** The library's defaults, to be changed field by field. */
inline rayc_detection_options default_detection_options() { return detail::defaults(rayc_default_detection_options); }
/** What makes a query just what the paper does: rayc_paper_detection_options(). */
inline rayc_detection_options paper_detection_options() { return detail::defaults(rayc_paper_detection_options); }
/** The library's defaults, to be changed field by field. */
inline rayc_octree_options default_octree_options() { return detail::defaults(rayc_default_octree_options); }
/** The library's defaults, to be changed field by field. */
inline rayc_response_options default_response_options() { return detail::defaults(rayc_default_response_options); }
/** The library's defaults, to be changed field by field. */
inline rayc_scene_options default_scene_options() { return detail::defaults(rayc_default_scene_options); }

/** One triangle surface; owns an rayc_mesh, which says what threads may do with it. Moves, does not copy. */
class Mesh {
 public:
#ifndef RAYCONTACT_NO_EXCEPTIONS
  /** As create(). */
  Mesh(const rayc_vectors& positions, Span<const uint32_t> triangles,
       const rayc_mesh_options& options = default_mesh_options())
      : Mesh(create(positions, triangles, options)) {}
#endif

  /** Checks and copies a surface: rayc_mesh_create(). `triangles`: three vertex numbers for each. */
  static Outcome<Mesh> create(const rayc_vectors& positions, Span<const uint32_t> triangles,
                              const rayc_mesh_options& options = default_mesh_options()) {
    rayc_mesh* mesh = nullptr;
    rayc_status status = detail::check_abi();
    const std::size_t count = triangles.size() / 3;
    if (status == RAYC_STATUS_OK && triangles.size() % 3 != 0)
      return detail::failure<Mesh>(Error(RAYC_STATUS_WRONG_COUNT, "triangles has " + std::to_string(triangles.size()) +
                                                                      " vertex numbers; give three for each triangle"));
    if (status == RAYC_STATUS_OK) status = rayc_mesh_create(&options, &positions, triangles.data(), count, &mesh);
    return detail::outcome(status, Mesh(mesh));
  }

  /** Reads a Wavefront file: rayc_mesh_create_from_obj(). */
  static Outcome<Mesh> from_obj(const std::string& path, const rayc_mesh_options& options = default_mesh_options()) {
    rayc_mesh* mesh = nullptr;
    rayc_status status = detail::check_abi();
    if (status == RAYC_STATUS_OK) status = rayc_mesh_create_from_obj(&options, path.c_str(), &mesh);
    return detail::outcome(status, Mesh(mesh));
  }

  /** How many vertices the mesh was made with. */
  Outcome<std::size_t> vertex_count() const {
    std::size_t count = 0;
    const rayc_status status = rayc_mesh_vertex_count(get(), &count);
    return detail::outcome(status, count);
  }

  /** How many triangles. */
  Outcome<std::size_t> triangle_count() const {
    std::size_t count = 0;
    const rayc_status status = rayc_mesh_triangle_count(get(), &count);
    return detail::outcome(status, count);
  }

  /** Renews all positions: rayc_mesh_set_positions(). Octrees of the mesh are stale then. */
  Outcome<void> set_positions(const rayc_vectors& positions) {
    return check(rayc_mesh_set_positions(get(), &positions));
  }

  /** x, y, z of every vertex, packed, as a new array. */
  Outcome<std::vector<double>> positions() const {
    std::size_t count = 0;
    rayc_status status = rayc_mesh_vertex_count(get(), &count);
    std::vector<double> packed(3 * count);
    const rayc_vectors_mut view = vectors_mut(packed);
    if (status == RAYC_STATUS_OK) status = rayc_mesh_copy_positions(get(), &view);
    return detail::outcome(status, std::move(packed));
  }

  /** Three vertex numbers for each triangle, as a new array. */
  Outcome<std::vector<uint32_t>> triangles() const {
    std::size_t count = 0;
    rayc_status status = rayc_mesh_triangle_count(get(), &count);
    std::vector<uint32_t> indices(3 * count);
    if (status == RAYC_STATUS_OK) status = rayc_mesh_copy_triangles(get(), indices.size(), indices.data());
    return detail::outcome(status, std::move(indices));
  }

  /** What `close_holes` closed when the mesh was made, as a new array: rayc_mesh_copy_holes(). */
  Outcome<std::vector<rayc_hole>> holes() const {
    std::size_t count = 0;
    rayc_status status = rayc_mesh_hole_count(get(), &count);
    std::vector<rayc_hole> closed(count);
    if (status == RAYC_STATUS_OK) status = rayc_mesh_copy_holes(get(), count, closed.data());
    return detail::outcome(status, std::move(closed));
  }

  /** The mesh as it was created, as bytes: rayc_mesh_pack(). */
  Outcome<std::vector<uint8_t>> pack() const {
    std::size_t length = 0;
    rayc_status status = rayc_mesh_packed_length(get(), &length);
    std::vector<uint8_t> bytes(length);
    if (status == RAYC_STATUS_OK) status = rayc_mesh_pack(get(), length, bytes.data());
    return detail::outcome(status, std::move(bytes));
  }

  /** The mesh that was packed, at the positions of its creation: rayc_mesh_unpack(). */
  static Outcome<Mesh> unpack(Span<const uint8_t> bytes) {
    rayc_mesh* mesh = nullptr;
    rayc_status status = detail::check_abi();
    if (status == RAYC_STATUS_OK) status = rayc_mesh_unpack(bytes.size(), bytes.data(), &mesh);
    return detail::outcome(status, Mesh(mesh));
  }

  /** For raycontact.h; stays this object's. NULL after a move. */
  rayc_mesh* get() const noexcept { return handle_.get(); }

 private:
  explicit Mesh(rayc_mesh* mesh) : handle_(mesh) {}
  detail::Owner<rayc_mesh, rayc_mesh_destroy> handle_;
};

/** The search structure over one mesh's triangles; owns an rayc_octree. Moves, does not copy. */
class Octree {
 public:
#ifndef RAYCONTACT_NO_EXCEPTIONS
  /** As create(). */
  explicit Octree(const Mesh& mesh, const rayc_octree_options& options = default_octree_options())
      : Octree(create(mesh, options)) {}
#endif

  /** For the mesh's present positions: rayc_octree_create(). */
  static Outcome<Octree> create(const Mesh& mesh, const rayc_octree_options& options = default_octree_options()) {
    rayc_octree* octree = nullptr;
    const rayc_status status = rayc_octree_create(&options, mesh.get(), &octree);
    return detail::outcome(status, Octree(octree));
  }

  /** Follows the mesh to new positions: rayc_octree_update(). */
  Outcome<void> update(const Mesh& mesh) { return check(rayc_octree_update(get(), mesh.get())); }

  /** Where the ray first meets the mesh: rayc_octree_trace_ray(). */
  Outcome<rayc_hit> trace(const Mesh& mesh, const rayc_ray& ray) const {
    rayc_hit hit{};
    const rayc_status status = rayc_octree_trace_ray(get(), mesh.get(), &ray, &hit);
    return detail::outcome(status, hit);
  }

  /** The same for many rays; `hits` has room for as many: rayc_octree_trace_rays(). */
  Outcome<void> trace(const Mesh& mesh, Span<const rayc_ray> rays, Span<rayc_hit> hits) const {
    if (hits.size() != rays.size())
      return detail::failure<void>(Error(
          RAYC_STATUS_WRONG_COUNT,
          std::to_string(rays.size()) + " rays, but room for " + std::to_string(hits.size()) + " hits; give as many"));
    return check(rayc_octree_trace_rays(get(), mesh.get(), rays.data(), rays.size(), hits.data()));
  }

  /**
   * The points of the surface nearest to some points; `closest` has room for as many, and `bounds` is empty or has one
   * for each: rayc_octree_closest_points().
   */
  Outcome<void> closest_points(const Mesh& mesh, const rayc_vectors& points, Span<rayc_closest_point> closest,
                               Span<const double> bounds = {}) const {
    if (closest.size() != points.count || (bounds.size() != 0 && bounds.size() != points.count))
      return detail::failure<void>(
          Error(RAYC_STATUS_WRONG_COUNT, std::to_string(points.count) + " points, but room for " +
                                             std::to_string(closest.size()) + " closest ones and " +
                                             std::to_string(bounds.size()) + " bounds; give as many, or no bounds"));
    const double* bound = bounds.size() == 0 ? nullptr : bounds.data();
    return check(rayc_octree_closest_points(get(), mesh.get(), &points, bound, closest.data()));
  }

  /** How often the surface winds around each point; `numbers` has room for as many: rayc_octree_winding_numbers(). */
  Outcome<void> winding_numbers(const Mesh& mesh, const rayc_vectors& points, Span<int32_t> numbers) const {
    if (numbers.size() != points.count)
      return detail::failure<void>(
          Error(RAYC_STATUS_WRONG_COUNT, std::to_string(points.count) + " points, but room for " +
                                             std::to_string(numbers.size()) + " winding numbers; give as many"));
    return check(rayc_octree_winding_numbers(get(), mesh.get(), &points, numbers.data()));
  }

  /**
   * The vertices inside another part of their own body, with their shortest ways out: rayc_octree_own_exits(). `exits`
   * has room for as many as there may be, at most one for each vertex. How many there are.
   */
  Outcome<std::size_t> own_exits(const Mesh& mesh, Span<rayc_own_exit> exits) {
    std::size_t count = 0;
    const rayc_status status = rayc_octree_own_exits(get(), mesh.get(), exits.size(), exits.data(), &count);
    return detail::outcome(status, count);
  }

  /** For raycontact.h; stays this object's. NULL after a move. */
  rayc_octree* get() const noexcept { return handle_.get(); }

 private:
  explicit Octree(rayc_octree* octree) : handle_(octree) {}
  detail::Owner<rayc_octree, rayc_octree_destroy> handle_;
};

}  // inline namespace
}  // namespace raycontact

#endif  // RAYCONTACT_MESH_HPP
