// SPDX-License-Identifier: MIT OR Apache-2.0
// What every peer needs of a body besides its own structure: the box, and vertex normals.
#pragma once

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "peer.hpp"
#include "vector4.hpp"

namespace bench {

template <typename T>
struct Box {
  Vector4<T> lower_corner, upper_corner;

  bool is_empty() const {
    bool empty = false;
    for (int axis = 0; axis < 3; ++axis) empty |= lower_corner[axis] > upper_corner[axis];
    return empty;
  }
  bool contains(Vector4<T> p) const {
    const auto inside = (p >= lower_corner) & (p <= upper_corner);
    return inside[0] & inside[1] & inside[2];
  }
  Box intersection(const Box& other) const {
    return {upper(lower_corner, other.lower_corner), lower(upper_corner, other.upper_corner)};
  }
};

/// The vertices around each vertex, in order, the first repeated at the end until their number is even.
class Rings {
 public:
  explicit Rings(const BodyView& body) : start_(body.vertex_count + 1) {
    // next[v] holds (b, c) for each triangle (v, b, c).
    std::vector<std::vector<std::pair<uint32_t, uint32_t>>> next(body.vertex_count);
    for (uint32_t t = 0; t < body.triangle_count; ++t) {
      const uint32_t* corner = body.triangles + 3 * size_t(t);
      for (int i = 0; i < 3; ++i) next[corner[i]].push_back({corner[(i + 1) % 3], corner[(i + 2) % 3]});
    }
    for (uint32_t v = 0; v < body.vertex_count; ++v) {
      start_[v] = uint32_t(vertices_.size());
      uint32_t first = walk_fan(next[v]);
      // Where sheets touch in the vertex, a fan each, closed: the ways from fan to fan and back cancel out.
      while (!next[v].empty()) {
        vertices_.push_back(first);
        first = walk_fan(next[v]);
        if (next[v].empty()) vertices_.push_back(first);
      }
      if ((vertices_.size() - start_[v]) % 2 != 0) vertices_.push_back(vertices_[start_[v]]);
    }
    start_[body.vertex_count] = uint32_t(vertices_.size());
  }

  /// The sum of the surrounding triangles' normals, each as long as twice its area. The vertex itself cancels out, and
  /// each two triangles make a quad, whose area vector is half the product of its diagonals.
  template <typename T>
  Vector4<T> scaled_normal(const T* positions, uint32_t vertex) const {
    const uint32_t* at = vertices_.data() + start_[vertex];
    const uint32_t* end = vertices_.data() + start_[vertex + 1];
    const Vector4<T> first = load(positions + 3 * size_t(*at));
    Vector4<T> last = load(positions + 3 * size_t(at[1]));
    Vector4<T> sum{};
    for (at += 2; at + 1 < end; at += 2) {
      const Vector4<T> middle = load(positions + 3 * size_t(at[0]));
      const Vector4<T> next = load(positions + 3 * size_t(at[1]));
      sum += turned_cross<T>(middle - first, next - last);
      last = next;
    }
    return yzx<T>(sum);
  }

 private:
  /// Adds the vertices of the fan that the first of these triangles belongs to, takes its triangles away, and gives the
  /// first vertex.
  uint32_t walk_fan(std::vector<std::pair<uint32_t, uint32_t>>& triangles) {
    const uint32_t first = triangles.at(0).first;
    uint32_t at = first;
    do {
      vertices_.push_back(at);
      const auto starts_here = [at](const auto& triangle) { return triangle.first == at; };
      const auto found = std::find_if(triangles.begin(), triangles.end(), starts_here);
      if (found == triangles.end()) throw std::runtime_error("the surface is not closed");
      at = found->second;
      triangles.erase(found);
    } while (at != first);
    return first;
  }

  std::vector<uint32_t> start_, vertices_;
};

template <typename T>
Box<T> box_of(const T* positions, uint32_t count) {
  Box<T> boxes[4];
  for (auto& box : boxes) box = {load(positions), load(positions)};
  uint32_t i = 0;
  for (; i + 4 <= count; i += 4) {
    for (uint32_t k = 0; k < 4; ++k) {
      const Vector4<T> p = load(positions + 3 * size_t(i + k));
      boxes[k] = {lower(boxes[k].lower_corner, p), upper(boxes[k].upper_corner, p)};
    }
  }
  for (; i < count; ++i) {
    const Vector4<T> p = load(positions + 3 * size_t(i));
    boxes[0] = {lower(boxes[0].lower_corner, p), upper(boxes[0].upper_corner, p)};
  }
  for (int k = 1; k < 4; ++k) {
    boxes[0] = {lower(boxes[0].lower_corner, boxes[k].lower_corner),
                upper(boxes[0].upper_corner, boxes[k].upper_corner)};
  }
  return boxes[0];
}

}  // namespace bench
