// SPDX-License-Identifier: MIT OR Apache-2.0
/** What Bullet's deformable world needs of a body but does not check: it hangs, reads past arrays or does nothing. */
#ifndef RAYCONTACT_BULLET_BODY_CHECK_HPP
#define RAYCONTACT_BULLET_BODY_CHECK_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "raycontact/bullet/precision.hpp"

namespace raycontact::bullet {

/** Six times the signed volume, in double: float gets the sign of flat tetrahedra wrong. */
template <class Point>
double six_volumes(const Point& a, const Point& b, const Point& c, const Point& d) {
  double e[3][3];
  const Point* ends[3] = {&b, &c, &d};
  for (int i = 0; i < 3; ++i)
    for (unsigned axis = 0; axis < 3; ++axis) e[i][axis] = double((*ends[i])[axis]) - double(a[axis]);
  return e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) - e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
         e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
}

/** Tetrahedra turned inside out, where the nodes are now. */
inline int inverted_tetrahedra(const btSoftBody& body) {
  int count = 0;
  for (int t = 0; t < body.m_tetras.size(); ++t) {
    const auto& n = body.m_tetras[t].m_n;
    if (!(six_volumes(n[0]->m_x, n[1]->m_x, n[2]->m_x, n[3]->m_x) > 0)) ++count;
  }
  return count;
}

/** Throws std::invalid_argument naming the first thing that is wrong with a body, and the call that puts it right. */
inline void check_body(const btSoftBody& body, bool is_open) {
  const auto refuse = [](const std::string& what) { throw std::invalid_argument("soft body: " + what); };
  const auto number = [&](const btSoftBody::Node* node) { return static_cast<int>(node - &body.m_nodes[0]); };
  const int tetra_count = body.m_tetras.size();
  if (body.m_nodes.size() == 0) refuse("it has no nodes");
  if (tetra_count == 0 && !is_open)
    refuse(
        "it has no tetrahedra, so it is cloth, an open surface, or an empty shell; leave cloth to Bullet's own "
        "contact, "
        "or turn its front to what it meets and set BodyOptions::open; fill a closed shell with appendTetra");

  std::vector<std::pair<int, int>> links;
  links.reserve(static_cast<std::size_t>(body.m_links.size()));
  for (int l = 0; l < body.m_links.size(); ++l)
    links.push_back(std::minmax({number(body.m_links[l].m_n[0]), number(body.m_links[l].m_n[1])}));
  std::sort(links.begin(), links.end());

  for (int t = 0; t < tetra_count; ++t) {
    const btSoftBody::Tetra& tetra = body.m_tetras[t];
    const std::string name = "tetrahedron " + std::to_string(t);
    if (!(six_volumes(tetra.m_n[0]->m_x, tetra.m_n[1]->m_x, tetra.m_n[2]->m_x, tetra.m_n[3]->m_x) > 0))
      refuse(name + " has no positive volume; swap two of its nodes, or drop it if it is flat");
    if (!(tetra.m_element_measure > 0))
      refuse(name + " has no rest shape; call initializeDmInverse() after the last appendTetra");
    for (int i = 0; i < 4; ++i)
      for (int j = i + 1; j < 4; ++j) {
        const std::pair<int, int> edge = std::minmax({number(tetra.m_n[i]), number(tetra.m_n[j])});
        if (!std::binary_search(links.begin(), links.end(), edge))
          refuse(name + " has no link between nodes " + std::to_string(edge.first) + " and " +
                 std::to_string(edge.second) + "; appendLink every edge of every tetrahedron");
      }
  }
  if (body.m_tetraScratches.size() < tetra_count || body.m_tetraScratchesTn.size() < tetra_count)
    refuse("m_tetraScratches and m_tetraScratchesTn are shorter than m_tetras; resize both to its size");
  // Bullet's contact of two bodies needs the flag of both, and of two open ones it is the only one.
  if (!is_open && (body.m_cfg.collisions & btSoftBody::fCollision::VF_DD) != 0)
    refuse(
        "m_cfg.collisions has VF_DD, Bullet's own contact between soft bodies; use 0, or, to meet bodies that are not "
        "added here, SDF_RD with SDF_RDN, SDF_RDF or SDF_MDF");
  if (body.getActivationState() != DISABLE_DEACTIVATION)
    refuse("it may fall asleep and then ignores forces; call setActivationState(DISABLE_DEACTIVATION)");
}

}  // namespace raycontact::bullet

#endif  // RAYCONTACT_BULLET_BODY_CHECK_HPP
