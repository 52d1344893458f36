// SPDX-License-Identifier: MIT OR Apache-2.0
/** Soft bodies made of cages. */
#ifndef RAYCONTACT_BULLET_SOFT_BODY_HPP
#define RAYCONTACT_BULLET_SOFT_BODY_HPP

#include <BulletSoftBody/btSoftBody.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "raycontact/bullet/skin.hpp"
#include "raycontact/cage.hpp"

namespace raycontact::bullet {

using raycontact::Cage;
using raycontact::make_cage;

/** A soft body made of the cage, with everything Bullet's deformable world needs of one; `mass` in kg, spread by fill.
 */
inline std::unique_ptr<btSoftBody> make_soft_body(btSoftBodyWorldInfo& info, const Cage& cage, btScalar mass) {
  std::vector<btVector3> nodes;
  for (const auto& x : cage.nodes) nodes.push_back(btVector3(btScalar(x[0]), btScalar(x[1]), btScalar(x[2])));
  const std::vector<btScalar> fill(cage.fill.begin(), cage.fill.end());
  auto body = std::make_unique<btSoftBody>(&info, static_cast<int>(nodes.size()), nodes.data(), fill.data());
  std::set<std::pair<int, int>> edges;
  std::map<std::array<int, 3>, std::array<int, 3>> boundary;  // sorted corners -> outward order
  for (const std::array<int, 4>& t : cage.tetrahedra) {
    body->appendTetra(t[0], t[1], t[2], t[3]);
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j) edges.insert(std::minmax(t[i], t[j]));
    const std::array<int, 3> faces[4] = {
        {{t[0], t[2], t[1]}}, {{t[0], t[1], t[3]}}, {{t[0], t[3], t[2]}}, {{t[1], t[2], t[3]}}};
    for (const std::array<int, 3>& face : faces) {
      std::array<int, 3> corners = face;
      std::sort(corners.begin(), corners.end());
      if (boundary.erase(corners) == 0) boundary[corners] = face;  // a face seen twice is between two tetrahedra
    }
  }
  for (const std::pair<int, int>& edge : edges) body->appendLink(edge.first, edge.second);
  for (const auto& face : boundary) body->appendFace(face.second[0], face.second[1], face.second[2]);
  body->initializeDmInverse();
  body->m_tetraScratches.resize(body->m_tetras.size());
  body->m_tetraScratchesTn.resize(body->m_tetras.size());
  body->setTotalMass(mass);
  body->getCollisionShape()->setMargin(btScalar(0.03));
  body->m_cfg.collisions = 0;
  body->setActivationState(DISABLE_DEACTIVATION);
  return body;
}

}  // namespace raycontact::bullet

#endif  // RAYCONTACT_BULLET_SOFT_BODY_HPP
