// A closed surface whose contacts are many.
#ifndef TORUS_HPP
#define TORUS_HPP

#include <cmath>
#include <cstdint>
#include <vector>

struct Torus {
  std::vector<double> positions;
  std::vector<uint32_t> triangles;
};

inline Torus torus(uint32_t around, uint32_t across) {
  Torus torus;
  const double turn = 2 * std::acos(-1.0);
  for (uint32_t i = 0; i < around; ++i) {
    for (uint32_t j = 0; j < across; ++j) {
      const double u = turn * i / around, v = turn * j / across, radius = 1 + 0.4 * std::cos(v);
      torus.positions.insert(torus.positions.end(), {radius * std::cos(u), radius * std::sin(u), 0.4 * std::sin(v)});
      const uint32_t next_i = (i + 1) % around * across, next_j = (j + 1) % across;
      const uint32_t a = i * across + j, b = next_i + j, c = next_i + next_j, d = i * across + next_j;
      torus.triangles.insert(torus.triangles.end(), {a, b, c, a, c, d});
    }
  }
  return torus;
}

/** The k-th of a row, each of which overlaps its neighbours. */
inline Torus in_row(Torus torus, uint32_t k) {
  for (std::size_t i = 0; i < torus.positions.size(); ++i) torus.positions[i] += k * (i % 3 == 2 ? 0.6 : 0.1);
  return torus;
}

#endif
