// SPDX-License-Identifier: MIT OR Apache-2.0
/** The surfaces of the demo: the torus of the paper, and any surface brought to a common size and place. */
#ifndef RAYCONTACT_DEMOS_SHAPES_HPP
#define RAYCONTACT_DEMOS_SHAPES_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "raycontact.hpp"

namespace demo {

struct Surface {
  std::string name;
  std::vector<double> positions;    // x, y, z packed
  std::vector<uint32_t> triangles;  // outward

  std::size_t vertex_count() const { return positions.size() / 3; }
};

/** Radii 1 and 0.4, axis along y (Bullet's up); `around` x `across` quadrilaterals of two triangles each. */
inline Surface torus(uint32_t around = 40, uint32_t across = 20) {
  constexpr double ring = 1, tube = 0.4;
  const double pi = std::acos(-1.0);
  Surface surface{"torus", {}, {}};
  for (uint32_t i = 0; i < around; ++i)
    for (uint32_t j = 0; j < across; ++j) {
      const double u = 2 * pi * i / around, v = 2 * pi * j / across;
      const double r = ring + tube * std::cos(v);
      surface.positions.insert(surface.positions.end(), {r * std::cos(u), tube * std::sin(v), -r * std::sin(u)});
      const uint32_t i1 = (i + 1) % around, j1 = (j + 1) % across;
      const uint32_t a = i * across + j, b = i1 * across + j, c = i1 * across + j1, d = i * across + j1;
      surface.triangles.insert(surface.triangles.end(), {a, b, c, a, c, d});
    }
  return surface;
}

inline Surface read_obj(const std::string& path) {
  const raycontact::Mesh mesh = raycontact::Mesh::from_obj(path);
  const std::size_t slash = path.find_last_of('/');
  return {slash == std::string::npos ? path : path.substr(slash + 1), mesh.positions(), mesh.triangles()};
}

inline void move(Surface& surface, const std::array<double, 3>& by) {
  for (std::size_t i = 0; i < surface.positions.size(); ++i) surface.positions[i] += by[i % 3];
}

/** Scales the surface so that the longest side of its box is `size`, and puts the middle of the box at the origin. */
inline void normalise(Surface& surface, double size) {
  std::array<double, 3> low{}, high{};
  double longest = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    low[a] = high[a] = surface.positions[a];
    for (std::size_t i = a; i < surface.positions.size(); i += 3) {
      low[a] = std::min(low[a], surface.positions[i]);
      high[a] = std::max(high[a], surface.positions[i]);
    }
    longest = std::max(longest, high[a] - low[a]);
  }
  for (std::size_t i = 0; i < surface.positions.size(); ++i)
    surface.positions[i] = (surface.positions[i] - (low[i % 3] + high[i % 3]) / 2) * (size / longest);
}

/** The volume inside, by the divergence theorem. */
inline double volume(const Surface& surface) {
  double six = 0;
  for (std::size_t t = 0; t < surface.triangles.size(); t += 3) {
    const double* a = &surface.positions[3 * surface.triangles[t]];
    const double* b = &surface.positions[3 * surface.triangles[t + 1]];
    const double* c = &surface.positions[3 * surface.triangles[t + 2]];
    six += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
  return six / 6;
}

}  // namespace demo

#endif  // RAYCONTACT_DEMOS_SHAPES_HPP
