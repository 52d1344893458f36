// SPDX-License-Identifier: MIT OR Apache-2.0
/** The linear solver of the engine beside it. */
#ifndef RAYCONTACT_DEMOS_ENGINE_CONJUGATE_GRADIENTS_HPP
#define RAYCONTACT_DEMOS_ENGINE_CONJUGATE_GRADIENTS_HPP

#include <cstddef>
#include <vector>

namespace demo {

inline double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
  return sum;
}

/**
 * Adds to `v` the solution of A x = `residual`, A symmetric and positive definite; `residual` becomes what is left.
 * `add_product(direction, product)` adds A direction to a product of zeros. `inverse` is that of A's diagonal, or about
 * so. Ends when the square of the scaled residual is `part` of what it was.
 */
template <class AddProduct>
void solve_by_conjugate_gradients(const AddProduct& add_product, const std::vector<double>& inverse, double part,
                                  int most_iterations, std::vector<double>& residual, std::vector<double>& v) {
  std::vector<double> scaled(v.size());
  for (std::size_t k = 0; k < v.size(); ++k) scaled[k] = inverse[k] * residual[k];
  std::vector<double> direction = scaled;
  double square = dot(residual, scaled);
  const double goal = part * square;
  for (int iteration = 0; iteration < most_iterations && square > goal; ++iteration) {
    std::vector<double> product(v.size());
    add_product(direction, product);
    const double alpha = square / dot(direction, product);
    for (std::size_t k = 0; k < v.size(); ++k) {
      v[k] += alpha * direction[k];
      residual[k] -= alpha * product[k];
      scaled[k] = inverse[k] * residual[k];
    }
    const double next = dot(residual, scaled);
    for (std::size_t k = 0; k < v.size(); ++k) direction[k] = scaled[k] + next / square * direction[k];
    square = next;
  }
}

}  // namespace demo

#endif  // RAYCONTACT_DEMOS_ENGINE_CONJUGATE_GRADIENTS_HPP
