// SPDX-License-Identifier: MIT OR Apache-2.0
/**
 * @file
 * Contact for hosts whose solvers do not ask for its derivative.
 */
#ifndef RAYCONTACT_FREE_POINTS_HPP
#define RAYCONTACT_FREE_POINTS_HPP

#include <cmath>
#include <cstddef>
#include <vector>

#include "contact_system.hpp"

namespace raycontact {

/**
 * Ends a step of a contact system as if each node were a free point of its mass, by conjugate gradients: implicit
 * Euler, so no step is too long, and no push is stronger than the points' masses can bear.
 */
class FreePoints {
 public:
  /**
   * Moves `velocities`, between begin() and finish(), from what they would be without contact to those at the end of
   * the step: M (v - velocities) = dt * force(v). Nodes of infinite mass keep theirs.
   * @param system with a step under way
   * @param dt of that step, s
   * @param masses of the nodes, kg
   * @param velocities three numbers for each node, m/s
   * @return how many iterations it took; most_iterations where it was not done by then
   */
  int solve(ContactSystem& system, double dt, const std::vector<double>& masses, std::vector<double>& velocities) {
    const std::size_t count = velocities.size();
    const auto is_free = [&](std::size_t k) { return std::isfinite(masses[k / 3]); };
    forces_.assign(count, 0);
    system.add_forces(velocities, forces_);
    // The mass is the preconditioner: residuals are kept over their mass.
    residuals_.assign(count, 0);
    double left = 0;
    for (std::size_t k = 0; k < count; ++k) {
      if (!is_free(k)) continue;
      residuals_[k] = dt * forces_[k] / masses[k / 3];
      left += masses[k / 3] * residuals_[k] * residuals_[k];
    }
    const double all = left;
    changes_ = residuals_;
    int iteration = 0;
    for (; iteration < most_iterations && left > 1e-12 * all; ++iteration) {
      products_.assign(count, 0);
      system.add_product(dt, changes_, products_);
      double curvature = 0;
      for (std::size_t k = 0; k < count; ++k)
        if (is_free(k)) curvature += changes_[k] * (products_[k] += masses[k / 3] * changes_[k]);
      const double step = left / curvature, before = left;
      left = 0;
      for (std::size_t k = 0; k < count; ++k) {
        if (!is_free(k)) continue;
        velocities[k] += step * changes_[k];
        residuals_[k] -= step * products_[k] / masses[k / 3];
        left += masses[k / 3] * residuals_[k] * residuals_[k];
      }
      for (std::size_t k = 0; k < count; ++k) changes_[k] = residuals_[k] + left / before * changes_[k];
    }
    return iteration;
  }

  static constexpr int most_iterations = 500;  ///< Of one solve.

 private:
  std::vector<double> forces_, residuals_, changes_, products_;
};

}  // namespace raycontact

#endif  // RAYCONTACT_FREE_POINTS_HPP
