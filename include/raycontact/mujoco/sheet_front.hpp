// SPDX-License-Identifier: MIT OR Apache-2.0
/** On which side of an open sheet a flex stands where the model begins. */
#ifndef RAYCONTACT_MUJOCO_SHEET_FRONT_HPP
#define RAYCONTACT_MUJOCO_SHEET_FRONT_HPP

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "raycontact/mujoco/flex_surface.hpp"

namespace raycontact::mujoco {

/** x, y, z of each of the surface's vertices in the state that the model begins with, qpos0. */
inline std::vector<double> starting_positions(const mjModel* m, int flex, const FlexSurface& surface) {
  const FlexNodes nodes = nodes_of(m, flex);
  std::vector<double> places(nodes.places, nodes.places + 3 * nodes.count), positions(3 * surface.vertices.size());
  for (std::size_t n = 0; n < nodes.count; ++n)
    for (int body = nodes.bodies[n]; body > 0; body = m->body_parentid[body]) {
      mju_rotVecQuat(&places[3 * n], &places[3 * n], m->body_quat + 4 * body);
      mju_addTo3(&places[3 * n], m->body_pos + 3 * body);
    }
  for (std::size_t v = 0; v < surface.vertices.size(); ++v)
    for (uint32_t e = surface.offsets[v]; e < surface.offsets[v + 1]; ++e)
      mju_addToScl3(&positions[3 * v], &places[3 * surface.nodes[e]], surface.weights[e]);
  return positions;
}

/** The solid angle under which a sheet is seen from a point: above 0 from its front, below 0 from its back. */
inline double angle_of_sheet(const std::vector<double>& positions, const std::vector<uint32_t>& triangles,
                             const std::array<double, 3>& from) {
  double sum = 0;
  for (std::size_t t = 0; t < triangles.size(); t += 3) {
    std::array<std::array<mjtNum, 3>, 3> to{};
    std::array<double, 3> length{};
    for (std::size_t c = 0; c < 3; ++c) {
      mju_sub3(to[c].data(), &positions[3 * triangles[t + c]], from.data());
      length[c] = mju_norm3(to[c].data());
    }
    mjtNum normal[3];
    mju_cross(normal, to[1].data(), to[2].data());
    const double cosine = length[0] * length[1] * length[2] + mju_dot3(to[0].data(), to[1].data()) * length[2] +
                          mju_dot3(to[1].data(), to[2].data()) * length[0] +
                          mju_dot3(to[2].data(), to[0].data()) * length[1];
    sum -= 2 * std::atan2(mju_dot3(to[0].data(), normal), cosine);
  }
  return sum;
}

}  // namespace raycontact::mujoco

#endif  // RAYCONTACT_MUJOCO_SHEET_FRONT_HPP
