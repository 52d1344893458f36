// SPDX-License-Identifier: MIT OR Apache-2.0
/** The bodies of the scenes: surfaces, and the tetrahedra that carry them. */
#ifndef RAYCONTACT_DEMOS_SCENE_VOLUMES_HPP
#define RAYCONTACT_DEMOS_SCENE_VOLUMES_HPP

#include <array>
#include <cstdint>

#include "../shapes.hpp"
#include "raycontact/bullet/soft_body.hpp"

namespace demo {

using raycontact::bullet::Cage;

/** A box around the origin, each face cut into squares, `cuts` of them along its longest side. */
Surface box(const std::array<double, 3>& size, uint32_t cuts = 1);

/** A ball by latitude and longitude; tall for a radius along y that differs. */
Surface ball(double radius, uint32_t around, double radius_y = 0);

/** A cone with its tip down at the origin's side: height along y, closed by a disc. */
Surface spike(double radius, double height, uint32_t around);

void rotate(Surface& surface, const std::array<double, 3>& axis, double angle);

/** The torus of the paper, filled: every quadrilateral of the surface with the ring's middle line is three tetrahedra.
 */
Cage filled_torus(const Surface& torus, uint32_t around = 40, uint32_t across = 20);

/** The torus in the 6 x 5 x 2 nodes of the paper; its axis must be y. */
Cage caged_torus(const Surface& torus);

/** Any surface in cubes, `cells` of them along its longest side. */
Cage caged(const Surface& surface, int cells);

}  // namespace demo

#endif  // RAYCONTACT_DEMOS_SCENE_VOLUMES_HPP
