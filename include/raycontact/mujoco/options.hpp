// SPDX-License-Identifier: MIT OR Apache-2.0
/** What may be chosen about the contact of flexes. */
#ifndef RAYCONTACT_MUJOCO_OPTIONS_HPP
#define RAYCONTACT_MUJOCO_OPTIONS_HPP

#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "raycontact.hpp"

namespace raycontact::mujoco {

/** How flexes touch. Where a number is 0 or negative for "the flex's own", each flex has a value of its own. */
struct ContactOptions {
  std::vector<std::string> flexes;  ///< the names of those that touch one another; none named: all of the model
  double pressure = 0;              ///< Pa that surfaces bear at `depth`; 0: each flex's Young's or bulk modulus
  /// m; also the most that a step is asked to press out; 0: a fortieth of an element's or cell's edge, as in
  /// elastic_material(), and the most is a sixteenth of an element's edge and a quarter of a cell's.
  double depth = 0;
  double damping_time = 0.01;   ///< s, >= 0: damping over stiffness
  double friction = -1;         ///< Coulomb's coefficient, >= 0; -1: the first number of each flex's `friction`
  bool self_collision = false;  ///< also contacts of each flex with itself
  double close_holes = 0;  ///< the largest part of a flex's area that caps over its holes may have: rayc_mesh_options
  rayc_sampling sampling = RAYC_SAMPLING_SPACING;  ///< where rays start
  /// See rayc_sampling. 0 with RAYC_SAMPLING_SPACING: a quarter of the smallest flex's element's or cell's edge.
  double sampling_value = 0;
  uint32_t threads = 1;     ///< for detection; 1: the caller's own, 0: one for each core
  int solves = 4;           ///< >= 1: solves in a step at most; a solve follows where forces were predicted wrongly
  double tolerance = 1e-3;  ///< 0 to 1: a solve ends where its residual is that part of what it was
};

/** Throws std::invalid_argument naming the first option that is out of its range. */
inline void check_options(const ContactOptions& options) {
  const auto refuse = [](const char* name, double value, const char* range) {
    throw std::invalid_argument(std::string("raycontact: ") + name + " is " + std::to_string(value) + "; it must be " +
                                range);
  };
  const auto at_least_zero = [&](const char* name, double value) {
    if (!(value >= 0) || !std::isfinite(value)) refuse(name, value, "finite and at least 0");
  };
  at_least_zero("pressure", options.pressure);
  at_least_zero("depth", options.depth);
  at_least_zero("damping_time", options.damping_time);
  if (options.friction != -1) at_least_zero("friction", options.friction);
  at_least_zero("sampling_value", options.sampling_value);
  if (options.solves < 1) refuse("solves", options.solves, "at least 1");
  if (!(options.tolerance > 0 && options.tolerance < 1)) refuse("tolerance", options.tolerance, "between 0 and 1");
}

}  // namespace raycontact::mujoco

#endif  // RAYCONTACT_MUJOCO_OPTIONS_HPP
