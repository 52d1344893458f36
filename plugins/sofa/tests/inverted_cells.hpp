// SPDX-License-Identifier: MIT OR Apache-2.0
// How many hexahedra and tetrahedra of a scene are turned inside out.
#pragma once

#include <sofa/core/behavior/MechanicalState.h>
#include <sofa/core/topology/BaseMeshTopology.h>
#include <sofa/defaulttype/VecTypes.h>
#include <sofa/simulation/Node.h>

#include <array>

/** Three edges' triple product at the middle of each cell. */
inline int inverted_cells(sofa::simulation::Node* root) {
  int inverted = 0;
  for (auto* topology : root->getTreeObjects<sofa::core::topology::BaseMeshTopology>()) {
    using State = sofa::core::behavior::MechanicalState<sofa::defaulttype::Vec3Types>;
    auto* state = dynamic_cast<State*>(topology->getContext()->getMechanicalState());
    if (state == nullptr) continue;
    const auto& x = state->read(sofa::core::vec_id::read_access::position)->getValue();
    const auto turned = [](const auto& a, const auto& b, const auto& c) { return !(dot(cross(a, b), c) > 0); };
    for (sofa::Size i = 0; i < topology->getNbTetrahedra(); ++i) {
      const auto t = topology->getTetrahedron(i);
      inverted += turned(x[t[1]] - x[t[0]], x[t[2]] - x[t[0]], x[t[3]] - x[t[0]]);
    }
    for (sofa::Size i = 0; i < topology->getNbHexahedra(); ++i) {
      const auto h = topology->getHexahedron(i);
      const auto across = [&](const std::array<int, 8>& sign) {
        sofa::type::Vec3 sum(0, 0, 0);
        for (int k = 0; k < 8; ++k) sum += x[h[k]] * sign[k];
        return sum;
      };
      inverted += turned(across({-1, 1, 1, -1, -1, 1, 1, -1}), across({-1, -1, 1, 1, -1, -1, 1, 1}),
                         across({-1, -1, -1, -1, 1, 1, 1, 1}));
    }
  }
  return inverted;
}
