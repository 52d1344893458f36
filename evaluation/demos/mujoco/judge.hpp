// SPDX-License-Identifier: MIT OR Apache-2.0
/** Looks at flexes from outside, whoever makes their contact: depths, inverted elements, energy. */
#ifndef RAYCONTACT_DEMOS_MUJOCO_JUDGE_HPP
#define RAYCONTACT_DEMOS_MUJOCO_JUDGE_HPP

#include <mujoco/mujoco.h>

#include <array>
#include <memory>
#include <vector>

#include "model.hpp"
#include "raycontact.hpp"

namespace flexes {

class Judge {
 public:
  /** Flex i of the model is body i. */
  Judge(const mjModel* m, const Model& model);

  /** The largest distance to another body's surface that a surface vertex inside it has, m; 0: they are apart. */
  double depth(const mjData* d);
  /** How many tetrahedra have turned inside out. */
  int inverted(const mjData* d) const;
  /** Kinetic energy, that of gravity, and that of St. Venant and Kirchhoff's law in tetrahedra, J. */
  double energy(const mjData* d) const;
  /** Of all bodies: the centre of mass's velocity times the mass, kg m/s. */
  std::array<double, 3> momentum(const mjData* d) const;
  /** Positions of a body's vertices as they are. */
  std::vector<double> positions(const mjData* d, std::size_t body) const;
  /** Of each of a body's vertices, at the last depth(): 1 where it is inside another body. */
  const std::vector<uint8_t>& inside(std::size_t body) const { return surfaces_[body].inside; }
  /** Triangles of a body's surface. */
  const std::vector<uint32_t>& triangles(std::size_t body) const { return surfaces_[body].triangles; }

 private:
  struct Surface {
    std::vector<uint32_t> triangles;  // outward
    std::vector<bool> is_outside;     // of each vertex: whether it is the surface's
    std::unique_ptr<raycontact::Mesh> mesh;
    std::unique_ptr<raycontact::Octree> octree;
    std::vector<double> positions;
    std::vector<uint8_t> inside;
  };
  struct Tetrahedron {
    std::array<std::size_t, 4> corners;  // among all vertices
    std::array<double, 9> rest_inverse;  // of its edges
    double volume, shear, dilation;      // m^3 and Lame's two parameters, Pa
  };

  const mjModel* m_;
  std::vector<Surface> surfaces_;
  std::vector<Tetrahedron> tetrahedra_;
};

}  // namespace flexes

#endif  // RAYCONTACT_DEMOS_MUJOCO_JUDGE_HPP
