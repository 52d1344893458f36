// SPDX-License-Identifier: MIT OR Apache-2.0
/** Boxes of bodies and of ranks, and which of them overlap: decided as the library's broad phase decides it. */
#ifndef RAYCONTACT_MPI_BOXES_HPP
#define RAYCONTACT_MPI_BOXES_HPP

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

namespace raycontact::mpi_detail {

/** No point lies in it until something is included. */
struct Box {
  double lower[3] = {infinity(), infinity(), infinity()};
  double upper[3] = {-infinity(), -infinity(), -infinity()};

  static constexpr double infinity() { return std::numeric_limits<double>::infinity(); }

  void include(const Box& other) {
    for (int axis = 0; axis < 3; ++axis) {
      lower[axis] = std::min(lower[axis], other.lower[axis]);
      upper[axis] = std::max(upper[axis], other.upper[axis]);
    }
  }

  /** Whether they share a point, be it of their faces. */
  bool overlaps(const Box& other) const {
    for (int axis = 0; axis < 3; ++axis)
      if (std::max(lower[axis], other.lower[axis]) > std::min(upper[axis], other.upper[axis])) return false;
    return true;
  }
};

/** Calls `found(i, j)` once for each two boxes that overlap. */
template <class Found>
void for_each_overlap(const std::vector<Box>& boxes, Found found) {
  Box all;
  for (const Box& box : boxes) all.include(box);
  int axis = 0;
  for (int other = 1; other < 3; ++other)
    if (all.upper[other] - all.lower[other] > all.upper[axis] - all.lower[axis]) axis = other;
  std::vector<std::size_t> order(boxes.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(),
            [&](std::size_t i, std::size_t j) { return boxes[i].lower[axis] < boxes[j].lower[axis]; });
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Box& box = boxes[order[i]];
    for (std::size_t j = i + 1; j < order.size() && boxes[order[j]].lower[axis] <= box.upper[axis]; ++j)
      if (box.overlaps(boxes[order[j]])) found(order[i], order[j]);
  }
}

}  // namespace raycontact::mpi_detail

#endif  // RAYCONTACT_MPI_BOXES_HPP
