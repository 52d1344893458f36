// SPDX-License-Identifier: MIT OR Apache-2.0
/** Tori by the hundred that drift through one another; every tenth has a small one in its tube that must escape. */
#ifndef RAYCONTACT_DEMOS_DRIFTERS_HPP
#define RAYCONTACT_DEMOS_DRIFTERS_HPP

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "../shapes.hpp"
#include "number_bits.hpp"

namespace demo {

constexpr double drift_step = 1.0 / 60;  // s

/** What the host knows of a body: it moves as a whole, and all of it goes where the body goes. */
struct Drifter {
  uint64_t key = 0;
  std::array<double, 3> place{}, velocity{};
};

inline bool is_small(uint64_t key) { return key % 10 == 9; }

/** In a block of space about as high as wide, every torus across its neighbours, `apart` times as far off as usual. */
inline Drifter drifter(uint64_t key, uint64_t count, double apart = 1) {
  const auto side = static_cast<uint64_t>(std::ceil(std::cbrt(static_cast<double>(count))));
  const uint64_t place = is_small(key) ? key - 1 : key;
  Drifter body;
  body.key = key;
  body.place = {1.9 * apart * static_cast<double>(place % side) + (is_small(key) ? 1 : 0),
                0.75 * apart * static_cast<double>(place / side % side),
                1.9 * apart * static_cast<double>(place / side / side)};
  for (std::size_t axis = 0; axis < 3 && !is_small(key); ++axis)
    body.velocity[axis] = 0.8 * std::sin(12.9898 * static_cast<double>(key) + 4.1 * static_cast<double>(axis));
  return body;
}

inline void drift(Drifter& body, const double* forces, std::size_t count) {
  std::array<double, 3> sum{};
  for (std::size_t i = 0; i < count; ++i) sum[i % 3] += forces[i];
  const double mass = is_small(body.key) ? 0.5 : 20;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    body.velocity[axis] += drift_step * sum[axis] / mass;
    body.place[axis] += drift_step * body.velocity[axis];
  }
}

/** The bits of a body's forces and place; sums over bodies do not depend on their order. */
inline uint64_t bits_of(const Drifter& body, const double* forces, std::size_t count) {
  NumberBits bits(body.key);
  bits.add(forces, count);
  bits.add(body.place.data(), body.place.size());
  return bits.hash();
}

}  // namespace demo

#endif  // RAYCONTACT_DEMOS_DRIFTERS_HPP
