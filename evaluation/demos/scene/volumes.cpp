// SPDX-License-Identifier: MIT OR Apache-2.0
#include "volumes.hpp"

#include <cmath>
#include <map>
#include <utility>

#include "raycontact/bullet/body_check.hpp"

namespace demo {

namespace rb = raycontact::bullet;

Surface box(const std::array<double, 3>& size, uint32_t cuts) {
  Surface surface{"box", {}, {}};
  const double longest = std::max({size[0], size[1], size[2]});
  std::array<uint32_t, 3> counts{};
  for (std::size_t a = 0; a < 3; ++a)
    counts[a] = std::max(1u, static_cast<uint32_t>(std::lround(cuts * size[a] / longest)));
  std::map<std::array<uint32_t, 3>, uint32_t> numbers;
  const auto vertex = [&](const std::array<uint32_t, 3>& at) {
    const auto found = numbers.emplace(at, static_cast<uint32_t>(numbers.size()));
    if (found.second)
      for (std::size_t a = 0; a < 3; ++a) surface.positions.push_back(size[a] * (double(at[a]) / counts[a] - 0.5));
    return found.first->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (int side = 0; side < 2; ++side)
      for (uint32_t i = 0; i < counts[u]; ++i)
        for (uint32_t j = 0; j < counts[v]; ++j) {
          const auto corner = [&](uint32_t di, uint32_t dj) {
            std::array<uint32_t, 3> at{};
            at[axis] = side == 1 ? counts[axis] : 0;
            at[u] = i + di;
            at[v] = j + dj;
            return vertex(at);
          };
          uint32_t b = corner(1, 0), d = corner(0, 1);
          if (side == 0) std::swap(b, d);
          const uint32_t a = corner(0, 0), c = corner(1, 1);
          surface.triangles.insert(surface.triangles.end(), {a, b, c, a, c, d});
        }
  }
  return surface;
}

Surface ball(double radius, uint32_t around, double radius_y) {
  Surface surface{"ball", {}, {}};
  if (!(radius_y > 0)) radius_y = radius;
  const uint32_t rings = around / 2;
  const double pi = std::acos(-1.0);
  surface.positions = {0, radius_y, 0, 0, -radius_y, 0};
  for (uint32_t i = 1; i < rings; ++i)
    for (uint32_t j = 0; j < around; ++j) {
      const double u = pi * i / rings, v = 2 * pi * j / around;
      surface.positions.insert(surface.positions.end(), {radius * std::sin(u) * std::cos(v), radius_y * std::cos(u),
                                                         -radius * std::sin(u) * std::sin(v)});
    }
  const auto at = [&](uint32_t i, uint32_t j) { return 2 + (i - 1) * around + j % around; };
  for (uint32_t j = 0; j < around; ++j) {
    surface.triangles.insert(surface.triangles.end(),
                             {0, at(1, j), at(1, j + 1), 1, at(rings - 1, j + 1), at(rings - 1, j)});
    for (uint32_t i = 1; i + 1 < rings; ++i)
      surface.triangles.insert(surface.triangles.end(),
                               {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i, j + 1)});
  }
  return surface;
}

Surface spike(double radius, double height, uint32_t around) {
  Surface surface{"spike", {0, -height / 2, 0, 0, height / 2, 0}, {}};
  const double pi = std::acos(-1.0);
  constexpr uint32_t rings = 6;
  for (uint32_t i = 1; i <= rings; ++i)
    for (uint32_t j = 0; j < around; ++j) {
      const double part = double(i) / rings, v = 2 * pi * j / around;
      surface.positions.insert(surface.positions.end(),
                               {radius * part * std::cos(v), height * (part - 0.5), -radius * part * std::sin(v)});
    }
  const auto at = [&](uint32_t i, uint32_t j) { return 2 + (i - 1) * around + j % around; };
  for (uint32_t j = 0; j < around; ++j) {
    surface.triangles.insert(surface.triangles.end(), {0, at(1, j + 1), at(1, j), 1, at(rings, j), at(rings, j + 1)});
    for (uint32_t i = 1; i < rings; ++i)
      surface.triangles.insert(surface.triangles.end(),
                               {at(i, j), at(i + 1, j + 1), at(i + 1, j), at(i, j), at(i, j + 1), at(i + 1, j + 1)});
  }
  return surface;
}

void rotate(Surface& surface, const std::array<double, 3>& axis, double angle) {
  const btVector3 unit = btVector3(btScalar(axis[0]), btScalar(axis[1]), btScalar(axis[2])).normalized();
  const double c = std::cos(angle), s = std::sin(angle);
  const double k[3] = {double(unit.x()), double(unit.y()), double(unit.z())};
  for (std::size_t i = 0; i < surface.positions.size(); i += 3) {
    double* x = &surface.positions[i];
    const double along = k[0] * x[0] + k[1] * x[1] + k[2] * x[2];
    const double cross[3] = {k[1] * x[2] - k[2] * x[1], k[2] * x[0] - k[0] * x[2], k[0] * x[1] - k[1] * x[0]};
    for (int a = 0; a < 3; ++a) x[a] = x[a] * c + cross[a] * s + k[a] * along * (1 - c);
  }
}

Cage filled_torus(const Surface& torus, uint32_t around, uint32_t across) {
  Cage cage;
  const auto point = [](const double* x) { return std::array<double, 3>{{x[0], x[1], x[2]}}; };
  for (std::size_t v = 0; v < torus.vertex_count(); ++v) cage.nodes.push_back(point(&torus.positions[3 * v]));
  for (uint32_t i = 0; i < around; ++i) {
    std::array<double, 3> middle{};
    for (uint32_t j = 0; j < across; ++j)
      for (std::size_t axis = 0; axis < 3; ++axis) middle[axis] += cage.nodes[i * across + j][axis] / across;
    cage.nodes.push_back(middle);
  }
  cage.fill.assign(cage.nodes.size(), 0);
  const auto add = [&](uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    std::array<int, 4> t{{int(a), int(b), int(c), int(d)}};
    const auto six = [&] {
      const auto& nodes = cage.nodes;
      return rb::six_volumes(nodes[std::size_t(t[0])], nodes[std::size_t(t[1])], nodes[std::size_t(t[2])],
                             nodes[std::size_t(t[3])]);
    };
    if (six() < 0) std::swap(t[1], t[2]);
    for (int n : t) cage.fill[static_cast<std::size_t>(n)] += six() / 24;
    cage.tetrahedra.push_back(t);
  };
  for (uint32_t i = 0; i < around; ++i)
    for (uint32_t j = 0; j < across; ++j) {
      const uint32_t i1 = (i + 1) % around, j1 = (j + 1) % across;
      const uint32_t a = i * across + j, b = i1 * across + j, c = i1 * across + j1, d = i * across + j1;
      const uint32_t middle = around * across + i, next_middle = around * across + i1;
      add(middle, a, b, c);
      add(middle, a, c, d);
      add(middle, b, c, next_middle);
    }
  for (std::size_t v = 0; v < torus.vertex_count(); ++v) {
    rb::SkinPoint point;
    point.nodes[0] = static_cast<int>(v);
    cage.skin.points.push_back(point);
  }
  cage.skin.triangles = torus.triangles;
  cage.cell_edge = 2 * std::acos(-1.0) / around;
  return cage;
}

Cage caged_torus(const Surface& torus) {
  return rb::make_cage(torus.positions, torus.triangles, std::array<int, 3>{{5, 1, 4}});
}

Cage caged(const Surface& surface, int cells) { return rb::make_cage(surface.positions, surface.triangles, cells); }

}  // namespace demo
