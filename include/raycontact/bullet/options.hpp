// SPDX-License-Identifier: MIT OR Apache-2.0
/** How contacts are found and how they push: the choices a program makes once. */
#ifndef RAYCONTACT_BULLET_OPTIONS_HPP
#define RAYCONTACT_BULLET_OPTIONS_HPP

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>

#include "raycontact.hpp"
#include "raycontact/bullet/precision.hpp"

namespace raycontact::bullet {

/**
 * A depth (m) for ContactOptions::depth_cap: a quarter of an element's edge h, or more where the contact is so soft
 * that it takes more to strain an element by a quarter. `stiffness` in N/m^3.
 */
inline double suggested_depth_cap(double youngs_modulus, double element_edge, double stiffness, double factor = 0.25) {
  return factor * std::max(element_edge, stiffness > 0 ? youngs_modulus / stiffness : 0);
}

/** How bodies touch; the constructors of ContactForce and ClassicContact refuse values out of range. */
struct ContactOptions {
  double stiffness = 1000;                   ///< N/m^3 (N/m with RAYC_WEIGHTING_VERTEX), >= 0; see elastic()
  double damping_time = 0.05;                ///< s, >= 0; damping along the ray = stiffness * damping_time
  uint32_t weighting = RAYC_WEIGHTING_AREA;  ///< a rayc_weighting: what a contact's stiffness is multiplied by
  uint32_t law = RAYC_LAW_PRESSURE;          ///< a rayc_law: what a contact's force grows with
  double friction = 0;  ///< Coulomb's coefficient, >= 0; 0 = none. Bodies at rest hold on to one another
  /// m, > 0; asked of one step, or what the bodies close in it if that is more: a tenth to half an element edge.
  double depth_cap = std::numeric_limits<double>::infinity();
  /// Where rays start. A larger sampling_value than 0.01 leaves fewer rows for the solver.
  rayc_sampling sampling = RAYC_SAMPLING_ACCURACY;
  double sampling_value = 0;  ///< what `sampling` is told: see rayc_sampling
  /// Detect where the bodies will be at the end of the step if nothing stops them, so that an impact is met in the step
  /// in which it happens; false: where they are at its start, as in the paper.
  bool look_ahead = true;
  bool edges = true;     ///< trace edges where rays settle nothing
  bool escape = true;    ///< push pairs that contacts cannot part along one direction, as whole bodies
  uint32_t threads = 1;  ///< for detection; 1 = the caller's own, 0 = one for each core

  /**
   * For bodies of this Young's modulus (Pa), Poisson's ratio and edge of elements (m): a twentieth as stiff as two
   * bodies of elastic_material(). Bullet solves a step once, with elements that let themselves be turned inside out,
   * and what is stiffer crushes them (docs/bullet.md). Throws where elastic_material() does.
   */
  static ContactOptions elastic(double youngs_modulus, double poissons_ratio, double element_edge) {
    ContactOptions options;
    options.stiffness = elastic_material(youngs_modulus, poissons_ratio, element_edge).stiffness / 2 / 20;
    return options;
  }

  /** What the paper describes: rays from the vertices, stiffness per vertex, nothing beyond. `stiffness` in N/m. */
  static ContactOptions paper(double stiffness) {
    ContactOptions options;
    options.stiffness = stiffness;
    options.weighting = RAYC_WEIGHTING_VERTEX;
    options.law = RAYC_LAW_RAY_LENGTH;
    options.sampling = RAYC_SAMPLING_VERTICES;
    options.look_ahead = options.edges = options.escape = false;
    return options;
  }
};

/** What may differ from body to body. */
struct BodyOptions {
  bool self_collision = false;   ///< also contacts of the body with itself
  bool open = false;             ///< the surface may be open: cloth, whose front faces the closed bodies that it meets
  uint32_t group = 1;            ///< bits; two bodies touch where each one's group has a bit of the other's mask
  uint32_t mask = ~uint32_t{0};  ///< bits
};

/** A floor: pushes along `normal` where normal . x < offset, with the friction of ContactOptions. */
struct HalfSpace {
  btVector3 normal;    ///< unit, out of the solid
  btScalar offset;     ///< m
  btScalar stiffness;  ///< N/m^3: the pressure under what stands there over the depth to which it may sink in
};

/** Throws std::invalid_argument naming the first option that is out of its range. */
inline void check_options(const ContactOptions& options) {
  const auto refuse = [](const char* name, double value, const char* range) {
    throw std::invalid_argument(std::string("ContactOptions::") + name + " is " + std::to_string(value) +
                                "; it must be " + range);
  };
  const auto at_least_zero = [&](const char* name, double value) {
    if (!(value >= 0) || !std::isfinite(value)) refuse(name, value, "finite and at least 0");
  };
  at_least_zero("stiffness", options.stiffness);
  at_least_zero("damping_time", options.damping_time);
  at_least_zero("friction", options.friction);
  at_least_zero("sampling_value", options.sampling_value);
  if (!(options.depth_cap > 0)) refuse("depth_cap", options.depth_cap, "above 0");
}

/** Throws std::invalid_argument when the floor's normal is no unit vector or its stiffness is negative. */
inline void check_half_space(const HalfSpace& half_space) {
  if (!(std::fabs(double(half_space.normal.length2()) - 1) < 1e-3))
    throw std::invalid_argument("half-space: its normal has length " +
                                std::to_string(double(half_space.normal.length())) + "; normalise it");
  if (!(half_space.stiffness >= 0)) throw std::invalid_argument("half-space: its stiffness must be at least 0");
}

}  // namespace raycontact::bullet

#endif  // RAYCONTACT_BULLET_OPTIONS_HPP
