// SPDX-License-Identifier: MIT OR Apache-2.0
/** Is a point inside a closed surface? By winding number along one ray; a judge that does not ask the library. */
#ifndef RAYCONTACT_DEMOS_INSIDE_TEST_HPP
#define RAYCONTACT_DEMOS_INSIDE_TEST_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "raycontact/cage.hpp"

namespace demo {

/**
 * Turns the surface by a fixed, arbitrary rotation, sorts its triangles into the squares of a grid in the plane, and
 * sums the signed crossings above a point. The rotation keeps edges of axis-aligned shapes off the ray; edge functions
 * are exactly antisymmetric, so a ray at a shared edge crosses one of its two triangles, neither none nor both.
 */
class InsideTest {
 public:
  /**
   * `positions`: x, y, z packed. `triangles`: three vertex numbers each, outward. Throws std::invalid_argument where
   * either is no multiple of three numbers.
   */
  InsideTest(const std::vector<double>& positions, const std::vector<uint32_t>& triangles) : triangles_(triangles) {
    raycontact::detail::check_threes(positions.size(), "positions", "vertex");
    raycontact::detail::check_threes(triangles.size(), "triangles", "triangle");
    points_.resize(positions.size() / 3);
    low_.fill(std::numeric_limits<double>::infinity());
    high_.fill(-std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < points_.size(); ++i) {
      points_[i] = turn(&positions[3 * i]);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        low_[axis] = std::min(low_[axis], points_[i][axis]);
        high_[axis] = std::max(high_[axis], points_[i][axis]);
      }
    }
    const double side = std::sqrt(static_cast<double>(triangles.size()) / 3);
    squares_ = static_cast<std::size_t>(std::min(512.0, std::max(1.0, side)));
    sort_triangles();
  }

  /** 1 inside, 0 outside, 2 where the surface overlaps itself. */
  int winding_number(const double* position) const {
    const Point p = turn(position);
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (!(p[axis] >= low_[axis] && p[axis] <= high_[axis])) return 0;
    const std::size_t square = square_of(p[0], 0) + squares_ * square_of(p[1], 1);
    int winding = 0;
    for (std::size_t k = first_[square]; k < first_[square + 1]; ++k) winding += crossing(sorted_[k], p);
    return winding;
  }

  /** Whether the surface winds around x, y, z at `position`. */
  bool contains(const double* position) const { return winding_number(position) > 0; }

 private:
  using Point = std::array<double, 3>;

  static Point turn(const double* x) {
    // The quaternion (0.7, 0.31, -0.53, 0.37), normalised: nothing about it matters but that it is in no relation to
    // the axes.
    static const std::array<double, 4> q = [] {
      std::array<double, 4> r{{0.7, 0.31, -0.53, 0.37}};
      const double length = std::sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + r[3] * r[3]);
      for (double& c : r) c /= length;
      return r;
    }();
    const Point t{{2 * (q[2] * x[2] - q[3] * x[1]), 2 * (q[3] * x[0] - q[1] * x[2]), 2 * (q[1] * x[1] - q[2] * x[0])}};
    return {{x[0] + q[0] * t[0] + q[2] * t[2] - q[3] * t[1], x[1] + q[0] * t[1] + q[3] * t[0] - q[1] * t[2],
             x[2] + q[0] * t[2] + q[1] * t[1] - q[2] * t[0]}};
  }

  // Taken from the smaller vertex number to the larger, so that both triangles at an edge see the same number.
  double edge_function(uint32_t a, uint32_t b, const Point& p) const {
    const bool swap = a > b;
    const Point& s = points_[swap ? b : a];
    const Point& e = points_[swap ? a : b];
    const double value = (s[0] - p[0]) * (e[1] - p[1]) - (s[1] - p[1]) * (e[0] - p[0]);
    return swap ? -value : value;
  }

  int crossing(std::size_t triangle, const Point& p) const {
    const uint32_t v[3] = {triangles_[3 * triangle], triangles_[3 * triangle + 1], triangles_[3 * triangle + 2]};
    double w[3], sum = 0, z = 0;
    int left = 0;
    for (int k = 0; k < 3; ++k) {
      const uint32_t a = v[(k + 1) % 3], b = v[(k + 2) % 3];
      w[k] = edge_function(a, b, p);
      // Exactly on the edge, the triangle that runs along it upwards has the point on its left, its neighbour not.
      if (w[k] > 0 || (w[k] == 0 && a < b)) ++left;
      sum += w[k];
      z += w[k] * points_[v[k]][2];
    }
    if ((left != 0 && left != 3) || sum == 0 || !(z / sum > p[2])) return 0;
    return left == 3 ? 1 : -1;
  }

  std::size_t square_of(double x, std::size_t axis) const {
    const double width = high_[axis] - low_[axis];
    const double cell = width > 0 ? (x - low_[axis]) / width * static_cast<double>(squares_) : 0;
    return std::min(squares_ - 1, static_cast<std::size_t>(std::max(0.0, cell)));
  }

  template <class Function>
  void for_each_square(std::size_t triangle, Function function) const {
    std::array<std::size_t, 2> from{}, to{};
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const double x = points_[triangles_[3 * triangle]][axis], y = points_[triangles_[3 * triangle + 1]][axis],
                   z = points_[triangles_[3 * triangle + 2]][axis];
      from[axis] = square_of(std::min({x, y, z}), axis);
      to[axis] = square_of(std::max({x, y, z}), axis);
    }
    for (std::size_t j = from[1]; j <= to[1]; ++j)
      for (std::size_t i = from[0]; i <= to[0]; ++i) function(i + squares_ * j);
  }

  void sort_triangles() {
    const std::size_t count = triangles_.size() / 3;
    first_.assign(squares_ * squares_ + 1, 0);
    for (std::size_t t = 0; t < count; ++t) for_each_square(t, [&](std::size_t s) { ++first_[s + 1]; });
    for (std::size_t s = 0; s + 1 < first_.size(); ++s) first_[s + 1] += first_[s];
    sorted_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t t = 0; t < count; ++t) for_each_square(t, [&](std::size_t s) { sorted_[next[s]++] = t; });
  }

  std::vector<Point> points_;
  std::vector<uint32_t> triangles_;
  Point low_{}, high_{};
  std::size_t squares_ = 1;
  std::vector<std::size_t> first_, sorted_;
};

}  // namespace demo

#endif  // RAYCONTACT_DEMOS_INSIDE_TEST_HPP
