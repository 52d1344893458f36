// SPDX-License-Identifier: MIT OR Apache-2.0
/** The collision surface of a soft body, as points carried by its nodes. */
#ifndef RAYCONTACT_BULLET_SKIN_HPP
#define RAYCONTACT_BULLET_SKIN_HPP

#include <array>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "raycontact/bullet/precision.hpp"
#include "raycontact/cage.hpp"

namespace raycontact::bullet {

using raycontact::Skin;
using raycontact::SkinPoint;

/** The body's own faces as its skin. Nodes no face uses stay in the list and do not matter. */
inline Skin skin_from_faces(const btSoftBody& body) {
  if (body.m_faces.size() == 0)
    throw std::invalid_argument("soft body: it has no faces; appendFace its boundary, outward, or give it a skin");
  Skin skin;
  skin.points.resize(static_cast<std::size_t>(body.m_nodes.size()));
  for (std::size_t i = 0; i < skin.points.size(); ++i) skin.points[i].nodes[0] = static_cast<int>(i);
  skin.triangles.reserve(3 * static_cast<std::size_t>(body.m_faces.size()));
  for (int f = 0; f < body.m_faces.size(); ++f)
    for (const btSoftBody::Node* node : body.m_faces[f].m_n)
      skin.triangles.push_back(static_cast<uint32_t>(node - &body.m_nodes[0]));
  return skin;
}

/** x, y, z of every point of the skin, packed; `positions` is used again. */
inline void skin_positions(const btSoftBody& body, const Skin& skin, std::vector<btScalar>& positions) {
  positions.resize(3 * skin.points.size());
  btScalar* out = positions.data();
  for (const SkinPoint& point : skin.points) {
    btVector3 x(0, 0, 0);
    for (std::size_t k = 0; k < 4; ++k) x += btScalar(point.weights[k]) * body.m_nodes[point.nodes[k]].m_x;
    for (int axis = 0; axis < 3; ++axis) *out++ = x[axis];
  }
}

/**
 * Throws std::invalid_argument when a point refers to a node the body does not have, or a triangle to no point, or
 * where the triangles' numbers are no multiple of three.
 */
inline void check_skin(const btSoftBody& body, const Skin& skin) {
  for (std::size_t i = 0; i < skin.points.size(); ++i)
    for (int node : skin.points[i].nodes)
      if (node < 0 || node >= body.m_nodes.size())
        throw std::invalid_argument("skin point " + std::to_string(i) + " is carried by node " + std::to_string(node) +
                                    ", but the body has " + std::to_string(body.m_nodes.size()) + " nodes");
  raycontact::detail::check_threes(skin.triangles.size(), "skin.triangles", "triangle");
  for (std::size_t i = 0; i < skin.triangles.size(); ++i)
    if (skin.triangles[i] >= skin.points.size())
      throw std::invalid_argument("skin triangle " + std::to_string(i / 3) + " refers to point " +
                                  std::to_string(skin.triangles[i]) + ", but the skin has " +
                                  std::to_string(skin.points.size()) + " points");
}

}  // namespace raycontact::bullet

#endif  // RAYCONTACT_BULLET_SKIN_HPP
