// SPDX-License-Identifier: MIT OR Apache-2.0
/** How much of the push that a step predicts its solve leaves, for each pair of bodies: what friction must be told. */
#ifndef RAYCONTACT_BULLET_PAIR_LOADS_HPP
#define RAYCONTACT_BULLET_PAIR_LOADS_HPP

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "raycontact/bullet/precision.hpp"

namespace raycontact::bullet::detail {

/**
 * A stiff contact predicts far more than it will bear, because the solve lets the bodies give way. Pairs that have been
 * in contact keep the share of the step before; new ones give way like two rigid bodies.
 */
class PairLoads {
 public:
  /** Bullet asks for the forces more than once in a step; only the last prediction counts. */
  void start_prediction() { now_.clear(); }

  void finish_step() {
    std::swap(before_, now_);
    now_.clear();
  }

  void forget() {
    before_.clear();
    now_.clear();
  }

  void add_predicted(int first, int second, btScalar push, btScalar normal) {
    Load& load = find_or_add(first, second);
    load.predicted += double(push);
    load.normal += double(normal);
  }

  void add_solved(int first, int second, btScalar push) { find_or_add(first, second).solved += double(push); }

  /** Did the pair bear anything in the step before? */
  bool is_loaded(int first, int second) const {
    const Load* then = find(before_, first, second);
    return then != nullptr && then->solved > 0;
  }

  /**
   * What a row that predicts this push will bear: its part of the pair's, of stiffness `normal`. `inverse_masses`: of
   * each body; a second body of -1 does not give way.
   */
  btScalar normal_force(int first, int second, btScalar push, btScalar normal,
                        const std::vector<double>& inverse_masses, btScalar time_step) const {
    const Load* then = find(before_, first, second);
    const Load* now = find(now_, first, second);
    if (then != nullptr && now != nullptr && !(now->predicted > 0))
      return static_cast<btScalar>(then->solved * double(normal) / now->normal);
    if (then != nullptr && then->predicted > 0)
      return push * static_cast<btScalar>(std::clamp(then->solved / then->predicted, 0.0, 1.0));
    const double give = inverse_mass(first, second, inverse_masses);
    return push * static_cast<btScalar>(1 / (1 + double(time_step) * (now != nullptr ? now->normal : 0) * give));
  }

  /** By what two bodies would slow one another down in a step if their load acted along their motion, m/s. */
  btScalar speed_lost(int first, int second, const std::vector<double>& inverse_masses, btScalar time_step) const {
    const Load* then = find(before_, first, second);
    if (then == nullptr) return 0;
    return static_cast<btScalar>(then->solved * inverse_mass(first, second, inverse_masses)) * time_step;
  }

 private:
  struct Load {
    int first, second;
    double predicted, normal, solved;
  };

  static double inverse_mass(int first, int second, const std::vector<double>& of_bodies) {
    return of_bodies[static_cast<std::size_t>(first)] + (second >= 0 ? of_bodies[static_cast<std::size_t>(second)] : 0);
  }

  static const Load* find(const std::vector<Load>& loads, int first, int second) {
    const auto found =
        std::find_if(loads.begin(), loads.end(), [&](const Load& l) { return l.first == first && l.second == second; });
    return found == loads.end() ? nullptr : &*found;
  }

  // Rows of one pair come one after the other.
  Load& find_or_add(int first, int second) {
    if (latest_ < now_.size() && now_[latest_].first == first && now_[latest_].second == second) return now_[latest_];
    const Load* found = find(now_, first, second);
    if (found == nullptr) {
      now_.push_back({first, second, 0, 0, 0});
      found = &now_.back();
    }
    latest_ = static_cast<std::size_t>(found - now_.data());
    return now_[latest_];
  }

  std::vector<Load> before_, now_;
  std::size_t latest_ = 0;
};

}  // namespace raycontact::bullet::detail

#endif  // RAYCONTACT_BULLET_PAIR_LOADS_HPP
