// SPDX-License-Identifier: MIT OR Apache-2.0
/**
 * @file
 * A coarse lattice of tetrahedra around a closed surface, which carries it: for simulations of fine surfaces, in
 * whatever engine. Refuses with exceptions.
 */
#ifndef RAYCONTACT_CAGE_HPP
#define RAYCONTACT_CAGE_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "mesh.hpp"
#include "skin.hpp"
#include "span.hpp"

namespace raycontact {

/** Tetrahedra and the surface that they carry. */
struct Cage {
  std::vector<std::array<double, 3>> nodes;  ///< at rest, m
  std::vector<double> fill;  ///< for each node, its part of the volume inside the skin, m^3; masses follow it
  std::vector<std::array<int, 4>> tetrahedra;  ///< positive volume
  Skin skin;                                   ///< the surface, over those nodes
  double cell_edge = 0;                        ///< the shortest edge of a cell, m
};

namespace detail {

/** The cells of a box lattice that touch a surface or lie inside it. */
class Lattice {
 public:
  using Cell = std::array<int, 3>;

  Lattice(const std::vector<double>& positions, const std::vector<uint32_t>& triangles, const Cell& cells,
          const std::array<double, 3>& origin, const std::array<double, 3>& edges)
      : positions_(positions), triangles_(triangles), cells_(cells), origin_(origin), edges_(edges) {
    used_.assign(
        static_cast<std::size_t>(cells[0]) * static_cast<std::size_t>(cells[1]) * static_cast<std::size_t>(cells[2]),
        0);
    fill_.assign(used_.size(), 0);
    mark_surface();
    mark_inside();
  }

  Cage cage() {
    Cage cage;
    cage.cell_edge = *std::min_element(edges_.begin(), edges_.end());
    Cell c;
    for (c[2] = 0; c[2] < cells_[2]; ++c[2])
      for (c[1] = 0; c[1] < cells_[1]; ++c[1])
        for (c[0] = 0; c[0] < cells_[0]; ++c[0])
          if (used_[number(c)]) add_tetrahedra(c, cage);
    cage.skin.triangles = triangles_;
    cage.skin.points.reserve(positions_.size() / 3);
    for (std::size_t i = 0; i + 2 < positions_.size(); i += 3) cage.skin.points.push_back(carry(&positions_[i]));
    return cage;
  }

 private:
  using Axes = std::array<int, 3>;

  std::size_t number(const Cell& c) const {
    return static_cast<std::size_t>((c[2] * cells_[1] + c[1]) * cells_[0] + c[0]);
  }

  // Clamped: the surface often lies exactly on the border of the lattice.
  Cell cell_of(const double* x) const {
    Cell c;
    for (std::size_t a = 0; a < 3; ++a)
      c[a] = std::clamp(static_cast<int>(std::floor((x[a] - origin_[a]) / edges_[a])), 0, cells_[a] - 1);
    return c;
  }

  void mark_surface() {
    const double spacing = *std::min_element(edges_.begin(), edges_.end()) / 4;
    for (std::size_t t = 0; t + 2 < triangles_.size(); t += 3) {
      const double* corner[3];
      for (std::size_t k = 0; k < 3; ++k) corner[k] = &positions_[3 * triangles_[t + k]];
      double longest = 0;
      for (int k = 0; k < 3; ++k) {
        const double *p = corner[k], *q = corner[(k + 1) % 3];
        longest = std::max(longest, std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]));
      }
      const int parts = std::max(1, static_cast<int>(std::ceil(longest / spacing)));
      for (int i = 0; i <= parts; ++i)
        for (int j = 0; i + j <= parts; ++j) {
          double x[3];
          const double u = double(i) / parts, v = double(j) / parts;
          for (int a = 0; a < 3; ++a) x[a] = (1 - u - v) * corner[0][a] + u * corner[1][a] + v * corner[2][a];
          used_[number(cell_of(x))] = 1;
        }
    }
    // The corners once more, without rounding: each must find its cell.
    for (std::size_t i = 0; i + 2 < positions_.size(); i += 3) used_[number(cell_of(&positions_[i]))] = 1;
  }

  void mark_inside() {
    constexpr int samples = 4;  // along each edge of a cell
    constexpr std::size_t in_cell = samples * samples * samples;
    const Mesh mesh(vectors(positions_), triangles_);
    const Octree octree(mesh);
    std::vector<double> points(3 * in_cell);
    std::vector<int32_t> windings(in_cell);
    Cell c;
    for (c[2] = 0; c[2] < cells_[2]; ++c[2])
      for (c[1] = 0; c[1] < cells_[1]; ++c[1])
        for (c[0] = 0; c[0] < cells_[0]; ++c[0]) {
          for (std::size_t s = 0; s < in_cell; ++s) {
            const std::size_t offset[3] = {s % samples, s / samples % samples, s / samples / samples};
            for (std::size_t a = 0; a < 3; ++a)
              points[3 * s + a] = origin_[a] + edges_[a] * (c[a] + (double(offset[a]) + 0.5) / samples);
          }
          octree.winding_numbers(mesh, vectors(points), windings);
          const auto hits = std::count_if(windings.begin(), windings.end(), [](int32_t number) { return number > 0; });
          fill_[number(c)] = double(hits) / double(in_cell);
          if (hits > 0) used_[number(c)] = 1;
        }
  }

  int node(const Cell& corner, Cage& cage) {
    const auto found = node_of_corner_.find(corner);
    if (found != node_of_corner_.end()) return found->second;
    const int fresh = static_cast<int>(cage.nodes.size());
    node_of_corner_[corner] = fresh;
    std::array<double, 3> x{};
    for (std::size_t a = 0; a < 3; ++a) x[a] = origin_[a] + edges_[a] * corner[a];
    cage.nodes.push_back(x);
    cage.fill.push_back(0);
    return fresh;
  }

  // A cell falls into six tetrahedra, one for each order in which a walk from the low to the high corner takes the
  // three axes (Kuhn). Neighbouring cells then agree on their common faces.
  static std::array<Cell, 4> walk(const Cell& c, const Axes& order) {
    std::array<Cell, 4> corners{{c, c, c, c}};
    for (std::size_t k = 1; k < 4; ++k) {
      corners[k] = corners[k - 1];
      ++corners[k][static_cast<std::size_t>(order[k - 1])];
    }
    return corners;
  }

  void add_tetrahedra(const Cell& c, Cage& cage) {
    Axes order{{0, 1, 2}};
    bool even = true;
    for (int k = 0; k < 6; ++k) {
      std::array<int, 4> tetrahedron{};
      const std::array<Cell, 4> corners = walk(c, order);
      for (std::size_t i = 0; i < 4; ++i) tetrahedron[i] = node(corners[i], cage);
      if (!even) std::swap(tetrahedron[1], tetrahedron[2]);
      cage.tetrahedra.push_back(tetrahedron);
      // Exchanging the last two and the first two in turn visits all six orders and flips the parity each time.
      if (k % 2 == 0)
        std::swap(order[1], order[2]);
      else
        std::swap(order[0], order[1]);
      even = !even;
    }
    // Cells that the surface barely enters would make nodes so light that the solver does not converge.
    const double volume = edges_[0] * edges_[1] * edges_[2] * std::max(0.2, fill_[number(c)]);
    for (int k = 0; k < 8; ++k)
      cage.fill[static_cast<std::size_t>(node({{c[0] + (k & 1), c[1] + (k >> 1 & 1), c[2] + (k >> 2)}}, cage))] +=
          volume / 8;
  }

  // In the tetrahedron whose walk takes the axes by falling local coordinate, the weights are their differences.
  SkinPoint carry(const double* x) const {
    const Cell c = cell_of(x);
    std::array<double, 3> local{};
    for (std::size_t a = 0; a < 3; ++a) local[a] = std::clamp((x[a] - origin_[a]) / edges_[a] - c[a], 0.0, 1.0);
    Axes order{{0, 1, 2}};
    const auto along = [&](int axis) { return local[static_cast<std::size_t>(axis)]; };
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return along(a) > along(b); });
    const std::array<Cell, 4> corners = walk(c, order);
    const std::array<double, 5> steps{{1, along(order[0]), along(order[1]), along(order[2]), 0}};
    SkinPoint point;
    for (std::size_t k = 0; k < 4; ++k) {
      point.nodes[k] = node_of_corner_.at(corners[k]);
      point.weights[k] = steps[k] - steps[k + 1];
    }
    return point;
  }

  const std::vector<double>& positions_;
  const std::vector<uint32_t>& triangles_;
  Cell cells_;
  std::array<double, 3> origin_, edges_;
  std::vector<char> used_;
  std::vector<double> fill_;
  std::map<Cell, int> node_of_corner_;
};

struct Extent {
  std::array<double, 3> low, size;
};

inline Extent extent(const std::vector<double>& positions, const std::vector<uint32_t>& triangles) {
  check_threes(positions.size(), "positions", "vertex");
  check_threes(triangles.size(), "triangles", "triangle");
  if (positions.size() < 9) throw std::invalid_argument("a cage needs a surface with at least three vertices");
  Extent box{{{positions[0], positions[1], positions[2]}}, {{0, 0, 0}}};
  std::array<double, 3> high = box.low;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (!std::isfinite(positions[i])) throw std::invalid_argument("vertex " + std::to_string(i / 3) + " is not finite");
    box.low[i % 3] = std::min(box.low[i % 3], positions[i]);
    high[i % 3] = std::max(high[i % 3], positions[i]);
  }
  for (std::size_t a = 0; a < 3; ++a) box.size[a] = high[a] - box.low[a];
  return box;
}

}  // namespace detail

/** A cage of `cells` along x, y and z of the surface's box. `positions`: x, y, z packed; `triangles`: closed, outward.
 */
inline Cage make_cage(const std::vector<double>& positions, const std::vector<uint32_t>& triangles,
                      const std::array<int, 3>& cells) {
  const detail::Extent box = detail::extent(positions, triangles);
  std::array<double, 3> edges{};
  for (std::size_t a = 0; a < 3; ++a) {
    if (cells[a] < 1) throw std::invalid_argument("a cage needs at least one cell along every axis");
    if (!(box.size[a] > 0)) throw std::invalid_argument("the surface has no extent along axis " + std::to_string(a));
    edges[a] = box.size[a] / cells[a];
  }
  return detail::Lattice(positions, triangles, cells, box.low, edges).cage();
}

/** A cage of cubes, `cells` of them along the longest side of the surface's box. */
inline Cage make_cage(const std::vector<double>& positions, const std::vector<uint32_t>& triangles, int cells = 5) {
  if (cells < 1) throw std::invalid_argument("a cage needs at least one cell along the longest side");
  const detail::Extent box = detail::extent(positions, triangles);
  const double edge = *std::max_element(box.size.begin(), box.size.end()) / cells;
  if (!(edge > 0)) throw std::invalid_argument("the surface has no extent: all its vertices are in one place");
  std::array<int, 3> counts{};
  std::array<double, 3> origin{};
  for (std::size_t a = 0; a < 3; ++a) {
    counts[a] = std::max(1, static_cast<int>(std::ceil(box.size[a] / edge - 1e-9)));
    origin[a] = box.low[a] - (counts[a] * edge - box.size[a]) / 2;
  }
  return detail::Lattice(positions, triangles, counts, origin, {{edge, edge, edge}}).cage();
}

}  // namespace raycontact

#endif  // RAYCONTACT_CAGE_HPP
