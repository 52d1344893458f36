// SPDX-License-Identifier: MIT OR Apache-2.0
/** How stiff a flex is and how coarse, from which its contact's stiffness follows unless it is told. */
#ifndef RAYCONTACT_MUJOCO_ELASTICITY_HPP
#define RAYCONTACT_MUJOCO_ELASTICITY_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "raycontact/mujoco/flex_surface.hpp"

namespace raycontact::mujoco {

namespace detail {

/** Shear modulus of a flex of tetrahedra: the mean over its elements, from the energy of a shear. */
inline double shear_modulus_of_tetrahedra(const mjModel* m, int flex) {
  // The order in which MuJoCo counts a tetrahedron's edges.
  constexpr std::array<std::array<std::size_t, 2>, 6> edges{
      {{{0, 1}}, {{1, 2}}, {{2, 0}}, {{2, 3}}, {{0, 3}}, {{1, 3}}}};
  constexpr int numbers = 24;  // for each element: the upper triangle of a matrix over its edges, and three zeros
  const auto index = static_cast<std::size_t>(flex);
  const mjtNum* places = m->flex_vert0 + 3 * static_cast<std::size_t>(m->flex_vertadr[flex]);
  double sum = 0;
  for (int e = 0; e < m->flex_elemnum[flex]; ++e) {
    const int* corners = m->flex_elem + m->flex_elemdataadr[flex] + 4 * e;
    const mjtNum* stiffness = m->flex_stiffness + m->flex_stiffnessadr[flex] + numbers * e;
    const auto along = [&](std::size_t edge, std::size_t k) {
      const auto a = static_cast<std::size_t>(corners[edges[edge][0]]),
                 b = static_cast<std::size_t>(corners[edges[edge][1]]);
      return 2 * m->flex_size[3 * index + k] * (places[3 * b + k] - places[3 * a + k]);
    };
    // A shear (x, -y, 0) changes the square of an edge's length by twice that.
    std::array<double, 6> change{};
    for (std::size_t i = 0; i < 6; ++i) change[i] = along(i, 0) * along(i, 0) - along(i, 1) * along(i, 1);
    double energy = 0;
    std::size_t place = 0;
    for (std::size_t i = 0; i < 6; ++i)
      for (std::size_t j = i; j < 6; ++j) energy += (i == j ? 1 : 2) * stiffness[place++] * change[i] * change[j];
    std::array<std::array<double, 3>, 3> to{};
    for (std::size_t k = 0; k < 3; ++k) to[0][k] = along(0, k), to[1][k] = -along(2, k), to[2][k] = along(4, k);
    const double volume = std::fabs(to[0][0] * (to[1][1] * to[2][2] - to[1][2] * to[2][1]) +
                                    to[0][1] * (to[1][2] * to[2][0] - to[1][0] * to[2][2]) +
                                    to[0][2] * (to[1][0] * to[2][1] - to[1][1] * to[2][0])) /
                          6;
    if (volume > 0) sum += energy / (2 * volume);
  }
  return sum / std::max(1, m->flex_elemnum[flex]);
}

/** Shear modulus of a flex of cells: the largest of a cell, since those at the surface are partly empty. */
inline double shear_modulus_of_cells(const mjModel* m, int flex) {
  const int order = m->flex_interp[flex];
  const int* cells = m->flex_cellnum + 3 * flex;
  const int corners = (order + 1) * (order + 1) * (order + 1), size = 3 * corners;
  const mjtNum* places = m->flex_node0 + 3 * static_cast<std::size_t>(m->flex_nodeadr[flex]);
  const auto node = [&](int x, int y, int z) { return (x * (order * cells[1] + 1) + y) * (order * cells[2] + 1) + z; };
  double most = 0;
  std::vector<double> shear(static_cast<std::size_t>(size));
  for (int cell = 0; cell < cells[0] * cells[1] * cells[2]; ++cell) {
    const std::array<int, 3> at{{cell / (cells[1] * cells[2]), cell / cells[2] % cells[1], cell % cells[2]}};
    const mjtNum* first = places + 3 * node(order * at[0], order * at[1], order * at[2]);
    const mjtNum* last = places + 3 * node(order * (at[0] + 1), order * (at[1] + 1), order * (at[2] + 1));
    const double volume = std::fabs((last[0] - first[0]) * (last[1] - first[1]) * (last[2] - first[2]));
    for (int c = 0; c < corners; ++c) {
      const int x = c / ((order + 1) * (order + 1)), y = c / (order + 1) % (order + 1), z = c % (order + 1);
      const mjtNum* place = places + 3 * node(order * at[0] + x, order * at[1] + y, order * at[2] + z);
      shear[3 * static_cast<std::size_t>(c)] = place[0] - first[0];
      shear[3 * static_cast<std::size_t>(c) + 1] = first[1] - place[1];
      shear[3 * static_cast<std::size_t>(c) + 2] = 0;
    }
    const mjtNum* stiffness =
        m->flex_stiffness + m->flex_stiffnessadr[flex] + static_cast<std::ptrdiff_t>(cell) * size * size;
    double energy = 0;
    for (int i = 0; i < size; ++i)
      for (int j = 0; j < size; ++j)
        energy += stiffness[i * size + j] * shear[static_cast<std::size_t>(i)] * shear[static_cast<std::size_t>(j)];
    if (volume > 0) most = std::max(most, std::fabs(energy) / (4 * volume));
  }
  return most;
}

}  // namespace detail

/** About Young's modulus (Pa), to within a fifth: 2.6 times the shear modulus. 0 where the flex is no elastic solid. */
inline double youngs_modulus_of(const mjModel* m, int flex) {
  const int first = m->flex_stiffnessadr[flex];
  // Flexes without stiffness have no address.
  auto end = static_cast<mjtSize>(first < 0 ? first : m->nflexstiffness);
  for (int other = 0; other < m->nflex; ++other)
    if (m->flex_stiffnessadr[other] > first) end = std::min(end, static_cast<mjtSize>(m->flex_stiffnessadr[other]));
  if (m->flex_interp[flex] == 0)
    return m->flex_dim[flex] == 3 && end > first ? 2.6 * detail::shear_modulus_of_tetrahedra(m, flex) : 0;
  const int order = m->flex_interp[flex], size = 3 * (order + 1) * (order + 1) * (order + 1);
  const int* cells = m->flex_cellnum + 3 * flex;
  const bool is_solid = end - first == static_cast<mjtSize>(size) * size * cells[0] * cells[1] * cells[2];
  return is_solid ? 2.6 * detail::shear_modulus_of_cells(m, flex) : 0;
}

/** The edge of a typical element or cell, m. */
inline double element_edge_of(const mjModel* m, int flex) {
  double sum = 0;
  if (m->flex_interp[flex] != 0) {
    for (int k = 0; k < 3; ++k) sum += 2 * m->flex_size[3 * flex + k] / m->flex_cellnum[3 * flex + k] / 3;
    return sum;
  }
  for (int e = 0; e < m->flex_edgenum[flex]; ++e) sum += m->flexedge_length0[m->flex_edgeadr[flex] + e];
  return sum / std::max(1, m->flex_edgenum[flex]);
}

}  // namespace raycontact::mujoco

#endif  // RAYCONTACT_MUJOCO_ELASTICITY_HPP
