// SPDX-License-Identifier: MIT OR Apache-2.0
/** How stiff a flex is and how coarse, from which its contact's stiffness follows unless it is told. */
#ifndef RAYCONTACT_MUJOCO_ELASTICITY_HPP
#define RAYCONTACT_MUJOCO_ELASTICITY_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "raycontact/mujoco/flex_surface.hpp"

namespace raycontact::mujoco {

/** What an elastic solid resists with, Pa; 0 where a flex is none. */
struct Moduli {
  double shear = 0;  ///< G
  double bulk = 0;   ///< K
  /** About Young's modulus, to within a fifth. */
  double youngs() const { return 2.6 * shear; }
  /** What its surface bears: what hardly gives way in volume is as stiff under a load as its bulk. */
  double pressure() const { return std::max(youngs(), bulk); }
};

namespace detail {

/** How much each axis is stretched: a shear, whose energy is 2 G, and a growth, whose energy is 9/2 K. */
using Stretches = std::array<double, 3>;
constexpr std::array<Stretches, 2> shear_and_growth{{{{1, -1, 0}}, {{1, 1, 1}}}};

inline Moduli moduli_from_energies(const std::array<double, 2>& density) {
  return {density[0] / 2, 2 * density[1] / 9};
}

/** The stiffness with which an equality constraint's rows bear a load, times their inverse mass; 0: no constraint. */
inline double stiffness_of_equality(const mjModel* m, int flex, mjtEq type) {
  for (int e = 0; e < m->neq; ++e) {
    if (m->eq_type[e] != type || m->eq_obj1id[e] != flex || !m->eq_active0[e]) continue;
    const mjtNum *reference = m->eq_solref + mjNREF * e, *impedance = m->eq_solimp + mjNIMP * e;
    // A row accelerates by (1 - d) a - d k r under a load that alone would accelerate it by a, so it comes to rest at
    // r = (1 - d) a / (d k). And it pushes with that share d of its own inverse mass. The impedance d
    // grows with r: what begins far below its most is pushed to where it bears.
    const double d = std::max(impedance[0], impedance[1] / 2), most = impedance[1] * impedance[1];
    const double rate = reference[0] > 0 ? 1 / (most * std::pow(reference[0] * reference[1], 2)) : -reference[0] / most;
    return rate * d * d / (1 - d);
  }
  return 0;
}

/** Moduli of a flex of tetrahedra: means over its elements, and what its edges add. */
inline Moduli moduli_of_tetrahedra(const mjModel* m, int flex, bool has_elements) {
  // The order in which MuJoCo counts a tetrahedron's edges.
  constexpr std::array<std::array<std::size_t, 2>, 6> edges{
      {{{0, 1}}, {{1, 2}}, {{2, 0}}, {{2, 3}}, {{0, 3}}, {{1, 3}}}};
  constexpr int numbers = 24;  // for each element: the upper triangle of a matrix over its edges, and three zeros
  const auto index = static_cast<std::size_t>(flex);
  const mjtNum* places = m->flex_vert0 + 3 * static_cast<std::size_t>(m->flex_vertadr[flex]);
  const auto along = [&](const int* ends, std::size_t k) {
    return 2 * m->flex_size[3 * index + k] * (places[3 * ends[1] + int(k)] - places[3 * ends[0] + int(k)]);
  };
  // A stretch changes the square of an edge's length by twice this.
  const auto change_of = [&](const int* ends, const Stretches& stretches) {
    double change = 0;
    for (std::size_t k = 0; k < 3; ++k) change += stretches[k] * along(ends, k) * along(ends, k);
    return change;
  };
  std::array<double, 2> sums{};
  double whole_volume = 0;
  for (int e = 0; e < m->flex_elemnum[flex]; ++e) {
    const int* corners = m->flex_elem + m->flex_elemdataadr[flex] + 4 * e;
    std::array<std::array<int, 2>, 6> ends{};
    for (std::size_t i = 0; i < 6; ++i) ends[i] = {{corners[edges[i][0]], corners[edges[i][1]]}};
    std::array<std::array<double, 3>, 3> to{};
    for (std::size_t k = 0; k < 3; ++k)
      to[0][k] = along(ends[0].data(), k), to[1][k] = -along(ends[2].data(), k), to[2][k] = along(ends[4].data(), k);
    const double volume = std::fabs(to[0][0] * (to[1][1] * to[2][2] - to[1][2] * to[2][1]) +
                                    to[0][1] * (to[1][2] * to[2][0] - to[1][0] * to[2][2]) +
                                    to[0][2] * (to[1][0] * to[2][1] - to[1][1] * to[2][0])) /
                          6;
    whole_volume += volume;
    if (!has_elements || !(volume > 0)) continue;
    const mjtNum* stiffness = m->flex_stiffness + m->flex_stiffnessadr[flex] + numbers * e;
    for (std::size_t s = 0; s < 2; ++s) {
      std::size_t place = 0;
      for (std::size_t i = 0; i < 6; ++i)
        for (std::size_t j = i; j < 6; ++j)
          sums[s] += (i == j ? 1 : 2) * stiffness[place++] * change_of(ends[i].data(), shear_and_growth[s]) *
                     change_of(ends[j].data(), shear_and_growth[s]) / volume;
    }
  }
  for (double& sum : sums) sum /= std::max(1, m->flex_elemnum[flex]);
  const double held = stiffness_of_equality(m, flex, mjEQ_FLEX), springs = m->flex_edgestiffness[flex];
  for (int e = m->flex_edgeadr[flex]; e < m->flex_edgeadr[flex] + m->flex_edgenum[flex]; ++e) {
    if (m->flexedge_rigid[e]) continue;
    const double stiffness = springs + held / std::max(m->flexedge_invweight0[e], mjMINVAL);
    for (std::size_t s = 0; s < 2; ++s) {
      const double longer = change_of(m->flex_edge + 2 * e, shear_and_growth[s]) / m->flexedge_length0[e];
      if (whole_volume > 0) sums[s] += stiffness * longer * longer / (2 * whole_volume);
    }
  }
  return moduli_from_energies(sums);
}

/** Moduli of a flex of cells: the largest of a cell, since those at the surface are partly empty. */
inline Moduli moduli_of_cells(const mjModel* m, int flex) {
  const int order = m->flex_interp[flex];
  const int* cells = m->flex_cellnum + 3 * flex;
  const int corners = (order + 1) * (order + 1) * (order + 1), size = 3 * corners;
  const mjtNum* places = m->flex_node0 + 3 * static_cast<std::size_t>(m->flex_nodeadr[flex]);
  const auto node = [&](int x, int y, int z) { return (x * (order * cells[1] + 1) + y) * (order * cells[2] + 1) + z; };
  // Where a constraint holds strains, a cell has their rows instead of a matrix, after how many they are.
  const bool is_held = m->flex_edgeequality[flex] == 3;
  const double held = stiffness_of_equality(m, flex, mjEQ_FLEXSTRAIN);
  Moduli most;
  std::vector<double> moved(static_cast<std::size_t>(size));
  for (int cell = 0; cell < cells[0] * cells[1] * cells[2]; ++cell) {
    const std::array<int, 3> at{{cell / (cells[1] * cells[2]), cell / cells[2] % cells[1], cell % cells[2]}};
    const mjtNum* first = places + 3 * node(order * at[0], order * at[1], order * at[2]);
    const mjtNum* last = places + 3 * node(order * (at[0] + 1), order * (at[1] + 1), order * (at[2] + 1));
    const double volume = std::fabs((last[0] - first[0]) * (last[1] - first[1]) * (last[2] - first[2]));
    if (!(volume > 0)) continue;
    const mjtNum* stiffness =
        m->flex_stiffness + m->flex_stiffnessadr[flex] + static_cast<std::ptrdiff_t>(cell) * size * size;
    std::array<double, 2> densities{};
    for (std::size_t s = 0; s < 2; ++s) {
      double inverse_mass = 0;
      for (int c = 0; c < corners; ++c) {
        const int x = c / ((order + 1) * (order + 1)), y = c / (order + 1) % (order + 1), z = c % (order + 1);
        const int number = node(order * at[0] + x, order * at[1] + y, order * at[2] + z);
        for (int k = 0; k < 3; ++k)
          moved[static_cast<std::size_t>(3 * c + k)] =
              shear_and_growth[s][static_cast<std::size_t>(k)] * (places[3 * number + k] - first[k]);
        inverse_mass += m->body_invweight0[2 * m->flex_nodebodyid[m->flex_nodeadr[flex] + number]] / corners;
      }
      const int rows = is_held ? static_cast<int>(stiffness[0]) : size;
      double energy = 0;
      for (int i = 0; i < rows; ++i) {
        double row = 0;
        for (int j = 0; j < size; ++j) row += stiffness[i * size + j + (is_held ? 1 : 0)] * moved[std::size_t(j)];
        energy += row * (is_held ? row : moved[static_cast<std::size_t>(i)]);
      }
      if (is_held) energy *= held / std::max(inverse_mass, mjMINVAL);
      densities[s] = std::fabs(energy) / (2 * volume);
    }
    const Moduli here = moduli_from_energies(densities);
    most = {std::max(most.shear, here.shear), std::max(most.bulk, here.bulk)};
  }
  return most;
}

}  // namespace detail

/** The moduli of a flex, from MuJoCo's stiffness matrices and from what holds its edges or strains. */
inline Moduli moduli_of(const mjModel* m, int flex) {
  const int first = m->flex_stiffnessadr[flex];
  // Flexes without stiffness have no address.
  auto end = static_cast<mjtSize>(first < 0 ? first : m->nflexstiffness);
  for (int other = 0; other < m->nflex; ++other)
    if (m->flex_stiffnessadr[other] > first) end = std::min(end, static_cast<mjtSize>(m->flex_stiffnessadr[other]));
  const int order = m->flex_interp[flex], size = 3 * (order + 1) * (order + 1) * (order + 1);
  if (order == 0)
    return m->flex_dim[flex] == 3 ? detail::moduli_of_tetrahedra(m, flex, end > first) : Moduli();
  const int* cells = m->flex_cellnum + 3 * flex;
  const bool is_solid = order > 0 && end - first == static_cast<mjtSize>(size) * size * cells[0] * cells[1] * cells[2];
  return is_solid ? detail::moduli_of_cells(m, flex) : Moduli();
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
