// SPDX-License-Identifier: MIT OR Apache-2.0
/**
 * raycontact for C++17: move-only owners of the handles in raycontact.h, errors as exceptions.
 *
 * Header-only. `get()` gives the C handle, so that everything in raycontact.h stays within reach.
 */
#ifndef RAYCONTACT_HPP
#define RAYCONTACT_HPP

#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "raycontact.h"

namespace raycontact {

/** What a call of the library refused, with its status number and its own message. */
class Error : public std::runtime_error {
 public:
  Error(rayc_status status, const std::string& message) : std::runtime_error(message), status_(status) {}
  rayc_status status() const noexcept { return status_; }

 private:
  rayc_status status_;
};

/** Throws `Error` unless `status` is RAYC_STATUS_OK. Call it on the thread that made the call. */
inline void check(rayc_status status) {
  if (status == RAYC_STATUS_OK) return;
  const char* message = rayc_last_error_message();
  std::string text = rayc_status_name(static_cast<uint32_t>(status));
  if (message != nullptr && *message != '\0') text += std::string(": ") + message;
  throw Error(status, text);
}

namespace detail {

/** Refuses a library of another ABI before anything else is asked of it. */
inline void check_abi() {
  if (rayc_abi_version() == RAYC_ABI_VERSION) return;
  throw Error(RAYC_STATUS_OTHER_ABI, "the headers are of ABI " + std::to_string(RAYC_ABI_VERSION) +
                                         ", the library is of ABI " + std::to_string(rayc_abi_version()) +
                                         "; build with the headers of the library that is linked");
}

template <class Scalar>
constexpr uint32_t scalar_code() {
  static_assert(std::is_same<Scalar, float>::value || std::is_same<Scalar, double>::value,
                "raycontact reads arrays of float or of double");
  return static_cast<uint32_t>(std::is_same<Scalar, float>::value ? RAYC_SCALAR_F32 : RAYC_SCALAR_F64);
}

template <class Handle, rayc_status (*destroy)(Handle*)>
struct Destroy {
  void operator()(Handle* handle) const noexcept { static_cast<void>(destroy(handle)); }
};

template <class Handle, rayc_status (*destroy)(Handle*)>
using Owner = std::unique_ptr<Handle, Destroy<Handle, destroy>>;

}  // namespace detail

/** `count` 3-vectors of float or double; `stride` in bytes, 0 = packed. The memory stays the caller's. */
template <class Scalar>
rayc_vectors vectors(const Scalar* data, std::size_t count, std::size_t stride = 0) {
  rayc_vectors view{};
  view.data = data;
  view.count = count;
  view.stride = stride;
  view.scalar = detail::scalar_code<Scalar>();
  return view;
}

/** As `vectors`, for memory the library writes to. */
template <class Scalar>
rayc_vectors_mut vectors_mut(Scalar* data, std::size_t count, std::size_t stride = 0) {
  rayc_vectors_mut view{};
  view.data = data;
  view.count = count;
  view.stride = stride;
  view.scalar = detail::scalar_code<Scalar>();
  return view;
}

/** One closed, outward-oriented triangle surface. */
class Mesh {
 public:
  /** `triangles`: three vertex numbers for each triangle. */
  Mesh(const rayc_vectors& positions, const std::vector<uint32_t>& triangles) {
    detail::check_abi();
    rayc_mesh* mesh = nullptr;
    check(rayc_mesh_create(nullptr, &positions, triangles.data(), triangles.size() / 3, &mesh));
    handle_.reset(mesh);
  }

  static Mesh from_obj(const std::string& path) {
    detail::check_abi();
    rayc_mesh* mesh = nullptr;
    check(rayc_mesh_create_from_obj(nullptr, path.c_str(), &mesh));
    return Mesh(mesh);
  }

  std::size_t vertex_count() const {
    std::size_t count = 0;
    check(rayc_mesh_vertex_count(get(), &count));
    return count;
  }

  std::size_t triangle_count() const {
    std::size_t count = 0;
    check(rayc_mesh_triangle_count(get(), &count));
    return count;
  }

  /** x, y, z of every vertex, packed. */
  std::vector<double> positions() const {
    std::vector<double> packed(3 * vertex_count());
    const rayc_vectors_mut view = vectors_mut(packed.data(), packed.size() / 3);
    check(rayc_mesh_copy_positions(get(), &view));
    return packed;
  }

  std::vector<uint32_t> triangles() const {
    std::vector<uint32_t> indices(3 * triangle_count());
    check(rayc_mesh_copy_triangles(get(), indices.size(), indices.data()));
    return indices;
  }

  rayc_mesh* get() const noexcept { return handle_.get(); }

 private:
  explicit Mesh(rayc_mesh* mesh) : handle_(mesh) {}
  detail::Owner<rayc_mesh, rayc_mesh_destroy> handle_;
};

/** The contacts of one detection. */
class Contacts {
 public:
  Contacts() {
    detail::check_abi();
    rayc_contacts* contacts = nullptr;
    check(rayc_contacts_create(&contacts));
    handle_.reset(contacts);
  }

  std::size_t size() const {
    std::size_t count = 0;
    check(rayc_contacts_count(get(), &count));
    return count;
  }

  /** Replaces what `contacts` held; its memory is used again. */
  void copy_to(std::vector<rayc_contact>& contacts) const {
    contacts.resize(size());
    check(rayc_contacts_copy(get(), 0, contacts.size(), contacts.data()));
  }

  /** The spring coefficient of each contact in N/m, by the library's own law. */
  void copy_coefficients_to(const rayc_response_options& options, std::vector<double>& coefficients) const {
    coefficients.resize(size());
    check(rayc_contacts_copy_coefficients(get(), &options, 0, coefficients.size(), coefficients.data()));
  }

  rayc_contacts* get() const noexcept { return handle_.get(); }

 private:
  detail::Owner<rayc_contacts, rayc_contacts_destroy> handle_;
};

/** Many bodies, one detection for all of them. */
class Scene {
 public:
  /** `threads`: 1 = the caller's own, n = a pool of n, 0 = one for each core. */
  explicit Scene(uint32_t threads = 1) {
    detail::check_abi();
    rayc_scene_options options{};
    check(rayc_default_scene_options(sizeof options, &options));
    options.threads = threads;
    rayc_scene* scene = nullptr;
    check(rayc_scene_create(&options, &scene));
    handle_.reset(scene);
  }

  /** Copies the mesh; returns the body's number. */
  uint32_t add(const Mesh& mesh) {
    uint32_t body = 0;
    check(rayc_scene_add_mesh(get(), mesh.get(), &body));
    return body;
  }

  void remove(uint32_t body) { check(rayc_scene_remove_body(get(), body)); }

  void set_positions(uint32_t body, const rayc_vectors& positions) {
    check(rayc_scene_set_positions(get(), body, &positions));
  }

  /** Switches contacts of a body with itself on or off; they have colliding = collided. Off for a new body. */
  void set_self_collision(uint32_t body, bool is_on) { check(rayc_scene_set_self_collision(get(), body, is_on)); }

  /** Where rays start, from the next query on: see `rayc_detection_options`. */
  void set_sample_spacing(double sample_spacing) {
    rayc_detection_options options{};
    check(rayc_default_detection_options(sizeof options, &options));
    options.sample_spacing = sample_spacing;
    check(rayc_scene_set_detection_options(get(), &options));
  }

  void query(Contacts& contacts) { check(rayc_scene_query(get(), contacts.get())); }

  rayc_scene* get() const noexcept { return handle_.get(); }

 private:
  detail::Owner<rayc_scene, rayc_scene_destroy> handle_;
};

/** The library's defaults, to be changed field by field. */
inline rayc_response_options default_response_options() {
  rayc_response_options options{};
  check(rayc_default_response_options(sizeof options, &options));
  return options;
}

}  // namespace raycontact

#endif  // RAYCONTACT_HPP
