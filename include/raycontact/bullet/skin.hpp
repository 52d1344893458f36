// SPDX-License-Identifier: MIT OR Apache-2.0
/** The collision surface of a soft body, as points carried by its nodes. */
#ifndef RAYCONTACT_BULLET_SKIN_HPP
#define RAYCONTACT_BULLET_SKIN_HPP

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "raycontact/bullet/precision.hpp"
#include "raycontact/skin.hpp"

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
 * The render mesh of a body whose interpolation weights have been set
 * (btSoftBodyHelpers::interpolateBarycentricWeights): each render node is carried by the four corners of a tetrahedron.
 * The mesh must be closed and outward.
 */
inline Skin skin_from_render_mesh(const btSoftBody& body) {
  const int count = body.m_renderNodes.size();
  if (count == 0) throw std::invalid_argument("soft body: it has no render mesh; read one, or use its faces");
  if (body.m_renderNodesParents.size() < count || body.m_renderNodesInterpolationWeights.size() < count)
    throw std::invalid_argument("soft body: its render mesh has no weights; call interpolateBarycentricWeights");
  Skin skin;
  skin.points.resize(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    const auto& parents = body.m_renderNodesParents[i];
    if (parents.size() != 4)
      throw std::invalid_argument("soft body: render node " + std::to_string(i) + " has " +
                                  std::to_string(parents.size()) + " parents, not the 4 corners of a tetrahedron");
    SkinPoint& point = skin.points[static_cast<std::size_t>(i)];
    for (int k = 0; k < 4; ++k) {
      point.nodes[static_cast<std::size_t>(k)] = static_cast<int>(parents[k] - &body.m_nodes[0]);
      point.weights[static_cast<std::size_t>(k)] = double(body.m_renderNodesInterpolationWeights[i][k]);
    }
  }
  skin.triangles.reserve(3 * static_cast<std::size_t>(body.m_renderFaces.size()));
  for (int f = 0; f < body.m_renderFaces.size(); ++f)
    for (const btSoftBody::RenderNode* node : body.m_renderFaces[f].m_n)
      skin.triangles.push_back(static_cast<uint32_t>(node - &body.m_renderNodes[0]));
  return skin;
}

}  // namespace raycontact::bullet

#endif  // RAYCONTACT_BULLET_SKIN_HPP
