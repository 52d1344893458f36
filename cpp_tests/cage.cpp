// Cages without an engine: what they fill, what they carry, and what is refused.
#include "raycontact/cage.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "expect.hpp"
#include "torus.hpp"

namespace {

double volume(const raycontact::Cage& cage, const std::array<int, 4>& t) {
  double e[3][3];
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t a = 0; a < 3; ++a)
      e[k][a] = cage.nodes[std::size_t(t[k + 1])][a] - cage.nodes[std::size_t(t[0])][a];
  return (e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) - e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
          e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0])) /
         6;
}

// By the divergence theorem.
double volume(const std::vector<double>& x, const std::vector<uint32_t>& triangles) {
  double six = 0;
  for (std::size_t t = 0; t < triangles.size(); t += 3) {
    const double *a = &x[3 * triangles[t]], *b = &x[3 * triangles[t + 1]], *c = &x[3 * triangles[t + 2]];
    six += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
  return six / 6;
}

void fills_and_carries(const std::vector<double>& positions, const std::vector<uint32_t>& triangles) {
  const char* test = "cage";
  const raycontact::Cage cage = raycontact::make_cage(positions, triangles, 12);
  double filled = 0, all = 0, least = 1;
  for (const double part : cage.fill) filled += part;
  for (const auto& tetrahedron : cage.tetrahedra) {
    least = std::fmin(least, volume(cage, tetrahedron));
    all += volume(cage, tetrahedron);
  }
  expect(least > 0, test, "tetrahedra have positive volume");
  const double solid = volume(positions, triangles);
  expect(all > solid, test, "the cage holds the body");
  // Cells that are entered a little count with a fifth: no less than the body, and not much more.
  expect(filled > 0.98 * solid && filled < 1.2 * solid, test, "the nodes' parts sum to the body's volume");
  for (std::size_t p = 0; p < cage.skin.points.size(); ++p) {
    const raycontact::SkinPoint& point = cage.skin.points[p];
    double sum = 0;
    for (const double weight : point.weights) sum += weight;
    expect_near(sum, 1, 1e-12, test, "sum of a point's weights");
    for (std::size_t a = 0; a < 3; ++a) {
      double x = 0;
      for (std::size_t k = 0; k < 4; ++k) x += point.weights[k] * cage.nodes[std::size_t(point.nodes[k])][a];
      expect_near(x, positions[3 * p + a], 1e-12, test, "coordinate of a point that is carried");
    }
  }
  expect(cage.skin.triangles == triangles, test, "the same triangles");
}

}  // namespace

int main() {
  const Torus ring = torus(24, 12);
  fills_and_carries(ring.positions, ring.triangles);
  expect_refusal([&] { raycontact::make_cage(ring.positions, ring.triangles, 0); }, "cells", "at least one cell");
  std::vector<uint32_t> open = ring.triangles;
  open.resize(open.size() - 3);
  expect_refusal([&] { raycontact::make_cage(ring.positions, open); }, "open", "MESH_OPEN");
  expect_refusal([&] { raycontact::make_cage(std::vector<double>(9, 1.0), {0, 1, 2}); }, "a point", "no extent");
  return failures == 0 ? 0 : 1;
}
