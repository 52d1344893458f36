// SPDX-License-Identifier: MIT OR Apache-2.0
#ifndef RAYCONTACT_DEMOS_ENGINE_TEAM_HPP
#define RAYCONTACT_DEMOS_ENGINE_TEAM_HPP

#include <cstddef>

namespace caged {

/** The threads of an engine, OpenMP's, which it lends to the library too. Without OpenMP there is one. */
struct Team {
  int threads = 1;

  /** Calls work(index) for each index below `count`. */
  template <class Work>
  void operator()(std::size_t count, const Work& work) const {
#ifdef _OPENMP
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads) if (count > 1)
#endif
    for (std::size_t index = 0; index < count; ++index) work(index);
  }

  /** Calls work(begin, end) for ranges that together are all below `count`. */
  template <class Work>
  void for_ranges(std::size_t count, const Work& work) const {
    const std::size_t ranges = threads == 1 ? 1 : 8 * static_cast<std::size_t>(threads);
    (*this)(ranges, [&](std::size_t range) { work(count * range / ranges, count * (range + 1) / ranges); });
  }
};

}  // namespace caged

#endif  // RAYCONTACT_DEMOS_ENGINE_TEAM_HPP
