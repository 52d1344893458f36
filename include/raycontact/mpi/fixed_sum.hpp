// SPDX-License-Identifier: MIT OR Apache-2.0
/** Sums of numbers on any ranks that do not depend on their order. */
#ifndef RAYCONTACT_MPI_FIXED_SUM_HPP
#define RAYCONTACT_MPI_FIXED_SUM_HPP

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace raycontact::mpi_detail {

/**
 * A sum of whole numbers: three digits of 31 bits below the largest number's first bit, so that what is left out is
 * less than 2^-93 of the largest. Whole numbers add up to the same in any order; 2^31 of them fit.
 */
struct FixedSum {
  static constexpr int bits = 31, count = 3;
  int64_t digits[count] = {};

  /** `largest`: no number is larger; it is the same for all. */
  void add(double number, double largest) {
    const int first = exponent(largest);
    for (int k = 0; k < count; ++k) {
      const int shift = bits * (k + 1) - first;
      const double digit = std::trunc(std::ldexp(number, shift));
      digits[k] += static_cast<int64_t>(digit);
      number -= std::ldexp(digit, -shift);
    }
  }

  double value(double largest) const {
    if (!std::isfinite(largest)) return std::numeric_limits<double>::quiet_NaN();
    double sum = 0;
    for (int k = count - 1; k >= 0; --k)
      sum += std::ldexp(static_cast<double>(digits[k]), exponent(largest) - bits * (k + 1));
    return sum;
  }

 private:
  static int exponent(double largest) {
    int exponent = 0;
    std::frexp(largest, &exponent);
    return exponent;
  }
};

}  // namespace raycontact::mpi_detail

#endif  // RAYCONTACT_MPI_FIXED_SUM_HPP
