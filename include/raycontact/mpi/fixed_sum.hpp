// SPDX-License-Identifier: MIT OR Apache-2.0
/** Sums of numbers on any ranks that do not depend on their order. */
#ifndef RAYCONTACT_MPI_FIXED_SUM_HPP
#define RAYCONTACT_MPI_FIXED_SUM_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "raycontact/mpi/communicator.hpp"

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

/** Collective: the sum of all numbers of all ranks; NaN where one is not finite. */
inline double sum_of_all(const Communicator& comm, const std::vector<double>& numbers) {
  double largest = 0;
  for (double number : numbers)
    largest = std::max(largest, std::isfinite(number) ? std::fabs(number) : std::numeric_limits<double>::infinity());
  MPI_Allreduce(MPI_IN_PLACE, &largest, 1, MPI_DOUBLE, MPI_MAX, comm.get());
  FixedSum sum;
  if (std::isfinite(largest))
    for (double number : numbers) sum.add(number, largest);
  MPI_Allreduce(MPI_IN_PLACE, sum.digits, FixedSum::count, MPI_INT64_T, MPI_SUM, comm.get());
  return sum.value(largest);
}

}  // namespace raycontact::mpi_detail

#endif  // RAYCONTACT_MPI_FIXED_SUM_HPP
