// SPDX-License-Identifier: MIT OR Apache-2.0
/** Bullet's own render meshes as skins. */
#ifndef RAYCONTACT_BULLET_RENDER_SKIN_HPP
#define RAYCONTACT_BULLET_RENDER_SKIN_HPP

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>

#include "raycontact/bullet/skin.hpp"

namespace raycontact::bullet {

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

#endif  // RAYCONTACT_BULLET_RENDER_SKIN_HPP
