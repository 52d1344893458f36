// SPDX-License-Identifier: MIT OR Apache-2.0
/** What became of a scene, judged without the library's contacts. */
#ifndef RAYCONTACT_DEMOS_SCENE_MEASURE_HPP
#define RAYCONTACT_DEMOS_SCENE_MEASURE_HPP

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "engine.hpp"
#include "scene.hpp"

namespace demo {

/** Where the skins are now. */
Positions skin_positions(const Scene& scene, const Engine& engine);

/** For each skin vertex of each body: 1 = inside another body, and deeper than `tolerance` below its surface. */
std::vector<std::vector<uint8_t>> inside_flags(const Scene& scene, const Positions& positions, double tolerance);

struct Result {
  double inside_start = 0, inside_end = 0;  // shares of all skin vertices
  int elements = 0, inverted = 0;           // tetrahedra, and how many are inverted at the end
  double peak_speed = 0;                    // m/s, of any node in any step
  double energy_end = 0;                    // J, of motion
  double momentum_drift = 0;                // |change of the momentum| / sum of m |v| at its most; NaN where not kept
  int links_kept = 0;
  int steps = 0;
  double drift = 0;                      // m: the longest way of a skin vertex since the bodies had settled
  double energy_gained = 0;              // J: of motion and height, at its most since then
  double step_ms = 0, detection_ms = 0;  // medians
  double most_contacts = 0;
  bool is_finite = true, passed_through = false;
  std::string verdict;  // ok, overlapping, inverted, exploded, passed_through, drifting
};

/** Keeps the running sums while a scene is stepped, and judges it at the end. */
class Measurement {
 public:
  Measurement(const Scene& scene, const Engine& engine);

  /** After each step; false when there is no sense in going on. */
  bool observe(const Engine& engine, double dt, double step_ms);

  Result result(const Engine& engine);

 private:
  void judge(const Engine& engine);
  void watch_rest(const Engine& engine);

  const Scene& scene_;
  Positions start_, settled_;
  Result result_;
  double momentum_start_[3], motion_most_ = 0, time_ = 0, energy_settled_ = 0;
  std::vector<double> step_ms_, detection_ms_;
};

}  // namespace demo

#endif  // RAYCONTACT_DEMOS_SCENE_MEASURE_HPP
