// SPDX-License-Identifier: MIT OR Apache-2.0
/** The surface of a flex, closed or an open sheet, and how the flex's nodes carry it. */
#ifndef RAYCONTACT_MUJOCO_FLEX_SURFACE_HPP
#define RAYCONTACT_MUJOCO_FLEX_SURFACE_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "raycontact/mujoco/version.hpp"

namespace raycontact::mujoco {

/** What moves a flex: its vertices, or the nodes of its cells where it is interpolated. */
struct FlexNodes {
  const int* bodies;     ///< in which each sits
  const mjtNum* places;  ///< in the frame of that body; NULL: at its origin
  std::size_t count;     ///< of nodes
};

/** The nodes of a flex of the model. */
inline FlexNodes nodes_of(const mjModel* m, int flex) {
  if (m->flex_interp[flex] != 0) {
    const int first = m->flex_nodeadr[flex];
    return {m->flex_nodebodyid + first, m->flex_node + 3 * first, static_cast<std::size_t>(m->flex_nodenum[flex])};
  }
  const int first = m->flex_vertadr[flex];
  return {m->flex_vertbodyid + first, m->flex_vert + 3 * first, static_cast<std::size_t>(m->flex_vertnum[flex])};
}

/** "flex 'name'", for messages. */
inline std::string title_of(const mjModel* m, int flex) {
  const char* name = mj_id2name(m, mjOBJ_FLEX, flex);
  return name != nullptr && *name != '\0' ? "flex '" + std::string(name) + "'" : "flex " + std::to_string(flex);
}

/** A surface of triangles, and a table of weights by which nodes carry its vertices. */
struct FlexSurface {
  std::vector<double> positions;     ///< at rest
  std::vector<uint32_t> triangles;   ///< outward
  std::vector<uint32_t> vertices;    ///< which of the flex's vertices each is
  std::vector<uint32_t> offsets{0};  ///< where each vertex's entries begin
  std::vector<uint32_t> nodes;       ///< counted from the flex's first
  std::vector<double> weights;       ///< of those nodes; those of a vertex sum to 1

  /** Makes its back its front. */
  void turn() {
    for (std::size_t t = 0; t < triangles.size(); t += 3) std::swap(triangles[t + 1], triangles[t + 2]);
  }
};

namespace detail {

/**
 * A node's share of a vertex. Within a shell of cells, which MuJoCo numbers below 0, inner nodes have no motion of
 * their own: they follow the shell's sides, less its edges, which two sides have, and with its corners, which three
 * have.
 */
inline void add_node(const std::array<int, 3>& node, const std::array<int, 3>& count, double weight, bool is_shell,
                     FlexSurface& surface) {
  const auto add = [&](const std::array<int, 3>& at, double share) {
    surface.nodes.push_back(static_cast<uint32_t>((at[0] * count[1] + at[1]) * count[2] + at[2]));
    surface.weights.push_back(share);
  };
  bool is_inner = is_shell;
  for (std::size_t k = 0; k < 3; ++k) is_inner = is_inner && node[k] > 0 && node[k] < count[k] - 1;
  if (!is_inner) return add(node, weight);
  // Along each axis a side is the first layer, the last one, or the axis is left as it is; one axis at least is not.
  for (int sides = 1; sides < 27; ++sides) {
    std::array<int, 3> at = node;
    double share = -weight;
    for (std::size_t k = 0, rest = static_cast<std::size_t>(sides); k < 3; ++k, rest /= 3) {
      const double along = double(node[k]) / (count[k] - 1);
      if (rest % 3 == 0) continue;
      share *= rest % 3 == 1 ? along - 1 : -along;
      at[k] = rest % 3 == 1 ? 0 : count[k] - 1;
    }
    add(at, share);
  }
}

/** Where a vertex of an interpolated flex lies among its cells: which nodes carry it, with which weights. */
inline void add_cell_weights(const mjModel* m, int flex, const mjtNum* place, FlexSurface& surface) {
  // Nodes stand at the ends of each cell, and with quadratic cells in their middles too; z runs fastest.
  const int order = std::abs(m->flex_interp[flex]);
  std::array<int, 3> first{}, count{};
  std::array<std::array<double, 3>, 3> shape{};
  for (std::size_t k = 0; k < 3; ++k) {
    const int cells = m->flex_cellnum[3 * static_cast<std::size_t>(flex) + k];
    const double along = place[k] * cells;
    int cell = static_cast<int>(along);
    cell = cell < 0 ? 0 : cell >= cells ? cells - 1 : cell;
    const double t = along - cell;
    if (order == 1)
      shape[k] = {{1 - t, t, 0}};
    else
      shape[k] = {{(1 - t) * (1 - 2 * t), 4 * t * (1 - t), t * (2 * t - 1)}};
    first[k] = order * cell;
    count[k] = order * cells + 1;
  }
  for (std::size_t i = 0; i <= static_cast<std::size_t>(order); ++i)
    for (std::size_t j = 0; j <= static_cast<std::size_t>(order); ++j)
      for (std::size_t k = 0; k <= static_cast<std::size_t>(order); ++k) {
        const double weight = shape[0][i] * shape[1][j] * shape[2][k];
        if (weight == 0) continue;
        add_node({{first[0] + static_cast<int>(i), first[1] + static_cast<int>(j), first[2] + static_cast<int>(k)}},
                 count, weight, m->flex_interp[flex] < 0, surface);
      }
}

}  // namespace detail

/** The surface of a flex; throws std::invalid_argument where it has none that contact could be made with. */
inline FlexSurface surface_of(const mjModel* m, int flex) {
  const auto refuse = [&](const std::string& what) {
    throw std::invalid_argument("raycontact: " + title_of(m, flex) + " " + what +
                                "; leave it out of the flexes that raycontact is told, or mend it");
  };
  const int dim = m->flex_dim[flex], order = m->flex_interp[flex];
  if (dim < 2) refuse("is of dim 1, a line without an inside");
  if (order < -2 || order > 2) refuse("is interpolated in a way that is not known here");
  const int* corners = dim == 3 ? m->flex_shell + m->flex_shelldataadr[flex] : m->flex_elem + m->flex_elemdataadr[flex];
  const int triangles = dim == 3 ? m->flex_shellnum[flex] : m->flex_elemnum[flex];

  FlexSurface surface;
  const auto index = static_cast<std::size_t>(flex);
  const mjtNum* places = m->flex_vert0 + 3 * static_cast<std::size_t>(m->flex_vertadr[flex]);
  std::vector<int64_t> numbers(static_cast<std::size_t>(m->flex_vertnum[flex]), -1);
  for (int i = 0; i < 3 * triangles; ++i) {
    const auto vertex = static_cast<std::size_t>(corners[i]);
    if (numbers[vertex] < 0) {
      numbers[vertex] = static_cast<int64_t>(surface.vertices.size());
      surface.vertices.push_back(static_cast<uint32_t>(vertex));
      for (std::size_t k = 0; k < 3; ++k)
        surface.positions.push_back((2 * places[3 * vertex + k] - 1) * m->flex_size[3 * index + k]);
      if (order == 0) {
        surface.nodes.push_back(static_cast<uint32_t>(vertex));
        surface.weights.push_back(1);
      } else {
        detail::add_cell_weights(m, flex, places + 3 * vertex, surface);
      }
      surface.offsets.push_back(static_cast<uint32_t>(surface.nodes.size()));
    }
    surface.triangles.push_back(static_cast<uint32_t>(numbers[vertex]));
  }

  // Outward: the volume is positive. A sheet has none, and is turned where it is known what it meets.
  double volume = 0;
  for (std::size_t t = 0; t < surface.triangles.size(); t += 3) {
    const double* a = &surface.positions[3 * surface.triangles[t]];
    const double* b = &surface.positions[3 * surface.triangles[t + 1]];
    const double* c = &surface.positions[3 * surface.triangles[t + 2]];
    volume +=
        a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
  if (volume < 0) surface.turn();
  return surface;
}

}  // namespace raycontact::mujoco

#endif  // RAYCONTACT_MUJOCO_FLEX_SURFACE_HPP
