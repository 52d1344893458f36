// SPDX-License-Identifier: MIT OR Apache-2.0
/** The stiffness of flexes in blocks of 3 x 3, as products want it. */
#ifndef RAYCONTACT_MUJOCO_STIFFNESS_BLOCKS_HPP
#define RAYCONTACT_MUJOCO_STIFFNESS_BLOCKS_HPP

#include <cstddef>
#include <vector>

#include "raycontact/mujoco/version.hpp"

namespace raycontact::mujoco {

/** One number for each degree of freedom, or three for each node. */
using Numbers = std::vector<double>;

/**
 * A step's h^2 K + h D of flexes, as mjData holds it in efm_K. Where all rows and columns come in threes, as of nodes
 * that slide three ways, it is copied in blocks, whose product takes half the time; elsewhere it is read where it is.
 */
class StiffnessBlocks {
 public:
  /** Takes the matrix of this step. */
  void renew(const mjModel* m, const mjData* d) {
    rows_.clear(), ends_.clear(), columns_.clear(), values_.clear();
    is_blocked_ = has_stiffness(d);
    for (int i = 0; is_blocked_ && i < m->nv;) {
      const int count = d->efm_K_rownnz[i];
      if (count == 0) {
        ++i;
        continue;
      }
      is_blocked_ = count % 3 == 0 && i + 2 < m->nv;
      for (int r = 1; is_blocked_ && r < 3; ++r) is_blocked_ = d->efm_K_rownnz[i + r] == count;
      for (int k = 0; is_blocked_ && k < count; k += 3) {
        const int column = d->efm_K_colind[d->efm_K_rowadr[i] + k];
        for (int r = 0; r < 3; ++r)
          for (int c = 0; c < 3; ++c) {
            const int place = d->efm_K_rowadr[i + r] + k + c;
            is_blocked_ = is_blocked_ && d->efm_K_colind[place] == column + c;
            values_.push_back(d->efm_K_val[place]);
          }
        columns_.push_back(column);
      }
      rows_.push_back(i);
      ends_.push_back(columns_.size());
      i += 3;
    }
  }

  /** result += the matrix times change. */
  void add_product(const mjModel* m, const mjData* d, const Numbers& change, Numbers& result) const {
    if (!is_blocked_) {
      if (has_stiffness(d)) add_by_rows(m, d, change, result);
      return;
    }
    std::size_t block = 0;
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      double x = 0, y = 0, z = 0;
      for (; block < ends_[r]; ++block) {
        const double* a = &values_[9 * block];
        const double* v = &change[static_cast<std::size_t>(columns_[block])];
        x += a[0] * v[0] + a[1] * v[1] + a[2] * v[2];
        y += a[3] * v[0] + a[4] * v[1] + a[5] * v[2];
        z += a[6] * v[0] + a[7] * v[1] + a[8] * v[2];
      }
      double* to = &result[static_cast<std::size_t>(rows_[r])];
      to[0] += x;
      to[1] += y;
      to[2] += z;
    }
  }

 private:
  static bool has_stiffness(const mjData* d) { return d->efm_active != 0 && d->nefmK != 0; }

  static void add_by_rows(const mjModel* m, const mjData* d, const Numbers& change, Numbers& result) {
    for (int i = 0; i < m->nv; ++i) {
      double sum = 0;
      for (int k = d->efm_K_rowadr[i]; k < d->efm_K_rowadr[i] + d->efm_K_rownnz[i]; ++k)
        sum += d->efm_K_val[k] * change[static_cast<std::size_t>(d->efm_K_colind[k])];
      result[static_cast<std::size_t>(i)] += sum;
    }
  }

  std::vector<int> rows_, columns_;  // of blocks, by their first degree of freedom
  std::vector<std::size_t> ends_;    // of each row's blocks
  Numbers values_;                   // nine for each
  bool is_blocked_ = false;
};

}  // namespace raycontact::mujoco

#endif  // RAYCONTACT_MUJOCO_STIFFNESS_BLOCKS_HPP
