// SPDX-License-Identifier: MIT OR Apache-2.0
/** What a scene is: bodies, where they start, and how to tell what became of them. No engine in here. */
#ifndef RAYCONTACT_DEMOS_SCENE_SCENE_HPP
#define RAYCONTACT_DEMOS_SCENE_SCENE_HPP

#include <LinearMath/btVector3.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "volumes.hpp"

namespace demo {

struct SceneBody {
  std::string name;
  Cage cage;
  double mass;                  // kg
  btVector3 velocity{0, 0, 0};  // m/s
  std::vector<int> pinned{};    // node numbers
  bool self_collision = false;
};

/** x, y, z of the skin of each body, packed. */
using Positions = std::vector<std::vector<double>>;

/** A state of the scene, as the scene's own checks see it. */
struct State {
  const Positions& start;
  const Positions& now;

  /** The mean of a body's skin points. */
  static std::array<double, 3> centre(const std::vector<double>& body);
};

struct Scene {
  std::string name;
  std::vector<SceneBody> bodies;
  double youngs_modulus = 2000;  // Pa, of all bodies
  double poisson_ratio = 0.3;
  double damping_alpha = 0.01;  // 1/s: of all motion, as Bullet's elasticity has it by default
  btVector3 gravity{0, 0, 0};   // m/s^2
  bool has_floor = false;       // at y = 0
  double friction = 0;          // Coulomb's coefficient, between bodies and on the floor
  int iterations = 0;           // of the linear solver at most; 0 = Bullet's 300
  double duration = 5;          // s, unless --steps says otherwise
  double time_step = 0.02;      // s, unless --dt says otherwise
  double speed_limit = 100;     // m/s; faster is an explosion
  // Where rays start on skins finer than their cages, in cell edges. 0 = at the vertices, right for round bodies; at a
  // sharp edge a vertex's ray is askew and pushes boxes off their stack.
  double sample_spacing = 0;
  int settling_steps = 0;       // after so many nothing may move; 0 = bodies need not come to rest
  double drift_tolerance = 0;   // m, from then on
  double depth_tolerance = 0;   // m; a vertex no deeper than this inside another body is at rest on it
  double inside_tolerance = 0;  // the share of vertices that may be deeper at the end
  std::function<bool(const State&)> passed_through;  // did a body go where only a passage brings it?
  std::function<int(const State&)> links_kept;       // how many links of a chain still hold
  int links = 0;                                     // how many there are at the start

  double edge() const;             // the smallest edge of the cages' cells, m
  double area_per_vertex() const;  // mean over all skins, m^2
  /** N/m for each surface vertex: factor * area * that of ContactOptions::elastic(). */
  double stiffness(double factor = 1) const;
  bool keeps_momentum() const;  // nothing from outside acts but gravity
};

/** How often loop a winds through loop b, 0 when it does not; each is a closed line of points. */
int linking_number(const std::vector<std::array<double, 3>>& a, const std::vector<std::array<double, 3>>& b);

/** The middle line of a torus whose vertices run around in groups of `across`. */
std::vector<std::array<double, 3>> middle_line(const std::vector<double>& torus, std::size_t across = 20);

}  // namespace demo

#endif  // RAYCONTACT_DEMOS_SCENE_SCENE_HPP
