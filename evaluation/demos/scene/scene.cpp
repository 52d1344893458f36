// SPDX-License-Identifier: MIT OR Apache-2.0
#include "scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "raycontact/bullet/options.hpp"

namespace demo {

namespace {

using Point = std::array<double, 3>;

double six_volumes(const Point& a, const Point& b, const Point& c, const Point& d) {
  double e[3][3];
  for (std::size_t k = 0; k < 3; ++k) {
    e[0][k] = b[k] - a[k];
    e[1][k] = c[k] - a[k];
    e[2][k] = d[k] - a[k];
  }
  return e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) - e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
         e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
}

double area_of(const Point& a, const Point& b, const Point& c) {
  const double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
  return std::hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]) / 2;
}

// +1 or -1 when the segment p q passes through the triangle a b c from its back or from its front.
int crossing(const Point& p, const Point& q, const Point& a, const Point& b, const Point& c) {
  const bool above = six_volumes(a, b, c, q) > 0;
  if (above == (six_volumes(a, b, c, p) > 0)) return 0;
  const bool ab = six_volumes(p, q, a, b) > 0, bc = six_volumes(p, q, b, c) > 0, ca = six_volumes(p, q, c, a) > 0;
  if (ab != bc || bc != ca) return 0;
  return above ? 1 : -1;
}

}  // namespace

std::array<double, 3> State::centre(const std::vector<double>& body) {
  Point sum{};
  for (std::size_t i = 0; i < body.size(); ++i) sum[i % 3] += body[i];
  for (double& s : sum) s /= static_cast<double>(body.size() / 3);
  return sum;
}

double Scene::edge() const {
  double edge = std::numeric_limits<double>::infinity();
  for (const SceneBody& body : bodies) edge = std::min(edge, body.cage.cell_edge);
  return edge;
}

double Scene::area_per_vertex() const {
  double area = 0, count = 0;
  for (const SceneBody& body : bodies) {
    std::vector<Point> positions;
    for (const auto& point : body.cage.skin.points) {
      Point x{};
      for (std::size_t k = 0; k < 4; ++k)
        for (std::size_t axis = 0; axis < 3; ++axis)
          x[axis] += point.weights[k] * body.cage.nodes[static_cast<std::size_t>(point.nodes[k])][axis];
      positions.push_back(x);
    }
    const std::vector<uint32_t>& triangles = body.cage.skin.triangles;
    for (std::size_t t = 0; t + 2 < triangles.size(); t += 3)
      area += area_of(positions[triangles[t]], positions[triangles[t + 1]], positions[triangles[t + 2]]);
    count += static_cast<double>(body.cage.skin.points.size());
  }
  return area / count;
}

double Scene::stiffness(double factor) const {
  using Options = raycontact::bullet::ContactOptions;
  return factor * Options::elastic(youngs_modulus, poisson_ratio, edge()).stiffness * area_per_vertex();
}

bool Scene::keeps_momentum() const {
  return !has_floor && std::all_of(bodies.begin(), bodies.end(), [](const SceneBody& b) { return b.pinned.empty(); });
}

int linking_number(const std::vector<Point>& a, const std::vector<Point>& b) {
  Point middle{};
  for (const Point& p : b)
    for (std::size_t k = 0; k < 3; ++k) middle[k] += p[k] / static_cast<double>(b.size());
  // Any surface that b borders counts the passages of a: here a fan around b's middle.
  int sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < b.size(); ++j)
      sum += crossing(a[i], a[(i + 1) % a.size()], middle, b[j], b[(j + 1) % b.size()]);
  return sum;
}

std::vector<Point> middle_line(const std::vector<double>& torus, std::size_t across) {
  std::vector<Point> line(torus.size() / 3 / across, Point{});
  for (std::size_t i = 0; i < line.size() * across; ++i)
    for (std::size_t k = 0; k < 3; ++k) line[i / across][k] += torus[3 * i + k] / static_cast<double>(across);
  return line;
}

}  // namespace demo
