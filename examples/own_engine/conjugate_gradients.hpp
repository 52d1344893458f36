// SPDX-License-Identifier: MIT OR Apache-2.0
/** The linear solver of the engine beside it. */
#ifndef RAYCONTACT_DEMOS_ENGINE_CONJUGATE_GRADIENTS_HPP
#define RAYCONTACT_DEMOS_ENGINE_CONJUGATE_GRADIENTS_HPP

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace demo {

/**
 * Adds to `v` the solution of A x = `residual`, A symmetric and positive definite; `residual` becomes what is left.
 * `add_product(direction, product)` adds A direction to a product of zeros. `inverse` is that of A's diagonal, or about
 * so. Ends when the square of the scaled residual is `part` of what it was. `for_each(count, work)` calls work(index)
 * for each index below `count`, on any threads; the result does not depend on them.
 */
template <class AddProduct, class ForEach>
void solve_by_conjugate_gradients(const AddProduct& add_product, const std::vector<double>& inverse, double part,
                                  int most_iterations, std::vector<double>& residual, std::vector<double>& v,
                                  const ForEach& for_each) {
  constexpr std::size_t block = 4096;
  std::vector<double> scaled(v.size()), direction(v.size()), product(v.size()), sums((v.size() + block - 1) / block);
  // The sum of term(k) for all unknowns.
  const auto sum = [&](const auto& term) {
    for_each(sums.size(), [&](std::size_t index) {
      double own = 0;
      for (std::size_t k = block * index; k < std::min(block * (index + 1), v.size()); ++k) own += term(k);
      sums[index] = own;
    });
    return std::accumulate(sums.begin(), sums.end(), 0.0);
  };
  double square = sum([&](std::size_t k) {
    scaled[k] = direction[k] = inverse[k] * residual[k];
    return residual[k] * scaled[k];
  });
  const double goal = part * square;
  for (int iteration = 0; iteration < most_iterations && square > goal; ++iteration) {
    add_product(direction, product);
    const double alpha = square / sum([&](std::size_t k) { return direction[k] * product[k]; });
    const double next = sum([&](std::size_t k) {
      v[k] += alpha * direction[k];
      residual[k] -= alpha * product[k];
      scaled[k] = inverse[k] * residual[k];
      return residual[k] * scaled[k];
    });
    sum([&](std::size_t k) {
      direction[k] = scaled[k] + next / square * direction[k];
      return product[k] = 0;
    });
    square = next;
  }
}

}  // namespace demo

#endif  // RAYCONTACT_DEMOS_ENGINE_CONJUGATE_GRADIENTS_HPP
