// SPDX-License-Identifier: MIT OR Apache-2.0
/** Surfaces with legs: not convex, fine, and without a file. */
#ifndef RAYCONTACT_DEMOS_ENGINE_CREATURES_HPP
#define RAYCONTACT_DEMOS_ENGINE_CREATURES_HPP

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "../shapes.hpp"
#include "elasticity.hpp"

namespace caged {

struct Limb {
  Vector towards;
  double length;  // beyond a ball of radius 1
};

/** A ball with limbs, of about 2.3 * rings * rings triangles. */
inline demo::Surface creature(const std::string& name, const std::vector<Limb>& limbs, uint32_t rings) {
  const uint32_t around = rings * 58 / 50;
  const double pi = std::acos(-1.0);
  demo::Surface surface{name, {}, {}};
  const auto add = [&](double polar, double turn) {
    const Vector d{{std::sin(polar) * std::cos(turn), std::cos(polar), -std::sin(polar) * std::sin(turn)}};
    double radius = 1;
    for (const Limb& limb : limbs)
      radius += limb.length * std::exp(12 * (caged::dot(d, limb.towards) / caged::length(limb.towards) - 1));
    for (std::size_t k = 0; k < 3; ++k) surface.positions.push_back(radius * d[k]);
  };
  add(0, 0);
  for (uint32_t i = 1; i <= rings; ++i)
    for (uint32_t j = 0; j < around; ++j) add(pi * i / (rings + 1), 2 * pi * j / around);
  add(pi, 0);
  const auto at = [&](uint32_t ring, uint32_t j) { return 1 + ring * around + j % around; };
  const uint32_t last = 1 + rings * around;
  for (uint32_t j = 0; j < around; ++j) {
    surface.triangles.insert(surface.triangles.end(), {0, at(0, j), at(0, j + 1)});
    for (uint32_t i = 0; i + 1 < rings; ++i)
      surface.triangles.insert(surface.triangles.end(),
                               {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    surface.triangles.insert(surface.triangles.end(), {at(rings - 1, j), last, at(rings - 1, j + 1)});
  }
  return surface;
}

inline std::vector<demo::Surface> creatures(uint32_t rings) {
  const std::vector<Limb> legs{{{{1, -1.2, 1}}, 1}, {{{1, -1.2, -1}}, 1}, {{{-1, -1.2, 1}}, 1}, {{{-1, -1.2, -1}}, 1}};
  std::vector<Limb> cow = legs, stool = legs, crab = legs;
  cow.push_back({{{1, 0.6, 0}}, 1.2});
  cow.push_back({{{-1, 0.2, 0}}, 0.5});
  stool.push_back({{{0, 1, 0}}, 0.3});
  crab.push_back({{{0, 0.1, 1}}, 0.8});
  crab.push_back({{{0, 0.1, -1}}, 0.8});
  return {creature("cow", cow, rings), creature("stool", stool, rings), creature("crab", crab, rings)};
}

}  // namespace caged

#endif  // RAYCONTACT_DEMOS_ENGINE_CREATURES_HPP
