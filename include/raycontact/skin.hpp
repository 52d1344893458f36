// SPDX-License-Identifier: MIT OR Apache-2.0
/**
 * @file
 * Surfaces that the nodes of a simulation carry.
 */
#ifndef RAYCONTACT_SKIN_HPP
#define RAYCONTACT_SKIN_HPP

#include <array>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "contact_system.hpp"

namespace raycontact {

/** A point of a skin: a weighted mean of at most four nodes of the body that carries it. */
struct SkinPoint {
  std::array<int, 4> nodes{{0, 0, 0, 0}};       ///< their numbers in the body
  std::array<double, 4> weights{{1, 0, 0, 0}};  ///< sum 1; barycentric in one tetrahedron, or one node alone
};

/** A closed, outward-oriented surface over such points. */
struct Skin {
  std::vector<SkinPoint> points;    ///< the surface's vertices
  std::vector<uint32_t> triangles;  ///< three point numbers each
};

/// @cond internal
namespace detail {

/** Throws std::invalid_argument where one or two numbers are left over. */
inline void check_threes(std::size_t size, const std::string& name, const std::string& each) {
  if (size % 3 != 0)
    throw std::invalid_argument(name + " has " + std::to_string(size) +
                                " numbers, which is no multiple of three; give three for each " + each);
}

}  // namespace detail
/// @endcond

/**
 * Throws std::invalid_argument where a point names a node beyond `node_count`, or a triangle a point that is not there,
 * and where the triangles' numbers are no multiple of three.
 */
inline void check_skin(const Skin& skin, int node_count) {
  for (std::size_t i = 0; i < skin.points.size(); ++i)
    for (const int node : skin.points[i].nodes)
      if (node < 0 || node >= node_count)
        throw std::invalid_argument("skin point " + std::to_string(i) + " is carried by node " + std::to_string(node) +
                                    ", but the body has " + std::to_string(node_count) + " nodes");
  detail::check_threes(skin.triangles.size(), "skin.triangles", "triangle");
  for (std::size_t i = 0; i < skin.triangles.size(); ++i)
    if (skin.triangles[i] >= skin.points.size())
      throw std::invalid_argument("skin triangle " + std::to_string(i / 3) + " refers to point " +
                                  std::to_string(skin.triangles[i]) + ", but the skin has " +
                                  std::to_string(skin.points.size()) + " points");
}

/** The weights of a skin as ContactSystem::add_deformable() takes them. */
struct SkinCarriers {
  std::vector<uint32_t> offsets{0};  ///< where each point's entries begin
  std::vector<uint32_t> nodes;       ///< counted from the body's first
  std::vector<double> weights;       ///< of each of them

  explicit SkinCarriers(const Skin& skin) {  ///< Those of this skin; nodes that weigh nothing are left out.
    for (const SkinPoint& point : skin.points) {
      for (std::size_t k = 0; k < 4; ++k) {
        if (point.weights[k] == 0) continue;
        nodes.push_back(static_cast<uint32_t>(point.nodes[k]));
        weights.push_back(point.weights[k]);
      }
      offsets.push_back(static_cast<uint32_t>(nodes.size()));
    }
  }

  operator Carriers() const { return {offsets, nodes, weights}; }  ///< For as long as this lives.
};

}  // namespace raycontact

#endif  // RAYCONTACT_SKIN_HPP
