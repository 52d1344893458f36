// SPDX-License-Identifier: MIT OR Apache-2.0
/** Corotational linear elasticity of tetrahedra, as a sparse matrix of 3 x 3 blocks over their nodes. */
#ifndef RAYCONTACT_DEMOS_ENGINE_ELASTICITY_HPP
#define RAYCONTACT_DEMOS_ENGINE_ELASTICITY_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "team.hpp"

namespace caged {

using Vector = std::array<double, 3>;
using Matrix = std::array<Vector, 3>;  // rows
using Numbers = std::vector<double>;

inline Vector cross(const Vector& a, const Vector& b) {
  return {{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}};
}
inline double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline double length(const Vector& a) { return std::hypot(a[0], a[1], a[2]); }
inline Vector product(const Matrix& m, const Vector& v) { return {{dot(m[0], v), dot(m[1], v), dot(m[2], v)}}; }
inline Matrix product(const Matrix& a, const Matrix& b) {
  Matrix c{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) c[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
  return c;
}

/** Turns by |angle| about it. */
inline Matrix rotation(const Vector& angle) {
  const double turn = length(angle), sine = turn > 0 ? std::sin(turn) / turn : 1;
  const double rest = turn > 0 ? (1 - std::cos(turn)) / (turn * turn) : 0.5;
  Matrix r{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) r[i][j] = rest * angle[i] * angle[j] + (i == j ? std::cos(turn) : 0);
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    r[j][i] += sine * angle[k];
    r[i][j] -= sine * angle[k];
  }
  return r;
}

class Elasticity {
 public:
  /** Nodes at rest, four node numbers for each element, Pa. */
  void add(const Numbers& rest, const std::array<std::size_t, 4>& nodes, double youngs_modulus, double poisson_ratio) {
    Element e{nodes, {}, {}, {}, 0, 0, 0};
    const auto at = [&](std::size_t k) { return Vector{{rest[3 * k], rest[3 * k + 1], rest[3 * k + 2]}}; };
    for (std::size_t i = 0; i < 4; ++i) e.rest[i] = at(nodes[i]);
    Matrix edges{};
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 3; ++k) edges[i][k] = e.rest[i + 1][k] - e.rest[0][k];
    const double six = dot(edges[0], cross(edges[1], edges[2]));
    e.volume = six / 6;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector n = cross(edges[(i + 1) % 3], edges[(i + 2) % 3]);
      for (std::size_t k = 0; k < 3; ++k) {
        e.gradients[i + 1][k] = n[k] / six;
        e.gradients[0][k] -= n[k] / six;
      }
    }
    e.turned = {{{{1, 0, 0}}, {{0, 1, 0}}, {{0, 0, 1}}}};
    e.shear = youngs_modulus / (2 * (1 + poisson_ratio));
    e.bulk = youngs_modulus * poisson_ratio / ((1 + poisson_ratio) * (1 - 2 * poisson_ratio));
    elements_.push_back(e);
  }

  /** All elements of a body have been added. */
  void end_body() { bodies_.push_back(elements_.size()); }

  /** Forces at positions, and the matrix for products, with the elements' rotations there. */
  void linearise(const Numbers& x, Numbers& forces, const Team& team) {
    if (starts_.size() != x.size() / 3 + 1) find_places(x.size() / 3);
    std::fill(values_.begin(), values_.end(), Matrix{});
    // Bodies share no nodes.
    team(bodies_.size(), [&](std::size_t body) {
      const std::size_t begin = body == 0 ? 0 : bodies_[body - 1];
      for (std::size_t number = begin; number < bodies_[body]; ++number) add_element(number, x, forces);
    });
  }

  /** result += factor * K * change. */
  void add_product(double factor, const Numbers& change, Numbers& result, const Team& team) const {
    team.for_ranges(result.size() / 3, [&](std::size_t begin, std::size_t end) {
      for (std::size_t row = begin; row < end; ++row) {
        Vector sum{};
        for (std::size_t b = starts_[row]; b < starts_[row + 1]; ++b) {
          const double* v = &change[3 * columns_[b]];
          for (std::size_t k = 0; k < 3; ++k)
            sum[k] += values_[b][k][0] * v[0] + values_[b][k][1] * v[1] + values_[b][k][2] * v[2];
        }
        for (std::size_t k = 0; k < 3; ++k) result[3 * row + k] += factor * sum[k];
      }
    });
  }

  /** The matrix's own numbers on its diagonal. */
  double diagonal(std::size_t unknown) const {
    const std::size_t row = unknown / 3;
    for (std::size_t b = starts_[row]; b < starts_[row + 1]; ++b)
      if (columns_[b] == row) return values_[b][unknown % 3][unknown % 3];
    return 0;
  }

 private:
  struct Element {
    std::array<std::size_t, 4> nodes;
    std::array<Vector, 4> rest, gradients;  // of the shape functions
    Matrix turned;
    double volume, shear, bulk;
  };

  void add_element(std::size_t number, const Numbers& x, Numbers& forces) {
    Element& e = elements_[number];
    turn(e, x);
    std::array<Vector, 4> n, way;
    for (std::size_t i = 0; i < 4; ++i) {
      n[i] = product(e.turned, e.gradients[i]);
      const Vector from = product(e.turned, e.rest[i]);
      for (std::size_t k = 0; k < 3; ++k) way[i][k] = x[3 * e.nodes[i] + k] - from[k];
    }
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j < 4; ++j) {
        Matrix& block = values_[places_[16 * number + 4 * i + j]];
        const double straight = e.volume * e.shear * dot(n[i], n[j]);
        for (std::size_t r = 0; r < 3; ++r)
          for (std::size_t c = 0; c < 3; ++c) {
            const double value =
                e.volume * (e.bulk * n[i][r] * n[j][c] + e.shear * n[j][r] * n[i][c]) + (r == c ? straight : 0);
            block[r][c] += value;
            forces[3 * e.nodes[i] + r] -= value * way[j][c];
          }
      }
  }

  // The rotation nearest to the deformation: from the last one, by the axis about which they differ. Inverted elements
  // have one too.
  static void turn(Element& e, const Numbers& x) {
    Matrix f{};
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 3; ++c) f[r][c] += x[3 * e.nodes[i] + r] * e.gradients[i][c];
    for (int round = 0; round < 50; ++round) {
      Vector torque{};
      double along = 0;
      for (std::size_t c = 0; c < 3; ++c) {
        const Vector is{{e.turned[0][c], e.turned[1][c], e.turned[2][c]}}, should{{f[0][c], f[1][c], f[2][c]}};
        const Vector turning = cross(is, should);
        for (std::size_t k = 0; k < 3; ++k) torque[k] += turning[k];
        along += dot(is, should);
      }
      if (length(torque) <= 1e-12 * std::fabs(along)) break;
      for (double& t : torque) t /= std::max(std::fabs(along), length(torque));
      e.turned = product(rotation(torque), e.turned);
    }
  }

  void find_places(std::size_t nodes) {
    std::vector<std::vector<std::size_t>> rows(nodes);
    for (const Element& e : elements_)
      for (const std::size_t i : e.nodes) rows[i].insert(rows[i].end(), e.nodes.begin(), e.nodes.end());
    starts_.assign(1, 0);
    columns_.clear();
    for (auto& row : rows) {
      std::sort(row.begin(), row.end());
      columns_.insert(columns_.end(), row.begin(), std::unique(row.begin(), row.end()));
      starts_.push_back(columns_.size());
    }
    values_.resize(columns_.size());
    places_.clear();
    const auto at = [&](std::size_t place) { return columns_.begin() + static_cast<std::ptrdiff_t>(place); };
    for (const Element& e : elements_)
      for (const std::size_t i : e.nodes)
        for (const std::size_t j : e.nodes) {
          const auto found = std::lower_bound(at(starts_[i]), at(starts_[i + 1]), j);
          places_.push_back(static_cast<std::size_t>(found - columns_.begin()));
        }
  }

  std::vector<Element> elements_;
  std::vector<std::size_t> bodies_;  // where the elements of each end
  std::vector<std::size_t> starts_, columns_, places_;
  std::vector<Matrix> values_;
};

}  // namespace caged

#endif  // RAYCONTACT_DEMOS_ENGINE_ELASTICITY_HPP
