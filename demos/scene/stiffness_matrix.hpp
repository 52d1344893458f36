// SPDX-License-Identifier: MIT OR Apache-2.0
/** A sparse matrix of 3 x 3 blocks over the nodes of tetrahedra: the same places every step, new values. */
#ifndef RAYCONTACT_DEMOS_SCENE_STIFFNESS_MATRIX_HPP
#define RAYCONTACT_DEMOS_SCENE_STIFFNESS_MATRIX_HPP

#include <LinearMath/btAlignedObjectArray.h>
#include <LinearMath/btVector3.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace demo {

class StiffnessMatrix {
 public:
  using Vectors = btAlignedObjectArray<btVector3>;
  using Element = std::array<int, 4>;  // node numbers

  /** Room for these elements; all values are 0 afterwards. */
  void start(const std::vector<Element>& elements) {
    if (elements != elements_) find_places(elements);
    std::fill(values_.begin(), values_.end(), Block{});
  }

  /**
   * Adds volume * (lambda n_i n_j^T + mu (n_j n_i^T + n_i . n_j)) for all pairs of an element's corners: isotropic
   * linear elasticity, n_i the gradient of corner i's shape function.
   */
  void add_element(std::size_t number, const std::array<btVector3, 4>& gradients, btScalar volume, btScalar mu,
                   btScalar lambda) {
    const std::size_t* place = &places_[16 * number];
    for (const btVector3& row : gradients) {
      const btScalar* n = row.m_floats;
      for (const btVector3& column : gradients) {
        const btScalar* m = column.m_floats;
        const btScalar diagonal = volume * mu * (n[0] * m[0] + n[1] * m[1] + n[2] * m[2]);
        const btScalar unit[3][4] = {{diagonal, 0, 0, 0}, {0, diagonal, 0, 0}, {0, 0, diagonal, 0}};
        btScalar* values = values_[*place++].columns[0];
        for (int c = 0; c < 3; ++c) {
          const btScalar direct = volume * lambda * m[c], crossed = volume * mu * n[c];
          for (int k = 0; k < 4; ++k) values[4 * c + k] += direct * n[k] + crossed * m[k] + unit[c][k];
        }
      }
    }
  }

  /** result += factor * matrix * x. */
  void add_product(btScalar factor, const Vectors& x, Vectors& result) const {
    for (std::size_t row = 0; row + 1 < starts_.size(); ++row) {
      btScalar sum[4] = {0, 0, 0, 0};
      for (std::size_t b = starts_[row]; b < starts_[row + 1]; ++b) {
        const btScalar* v = x[columns_[b]].m_floats;
        const Block& block = values_[b];
        for (int k = 0; k < 4; ++k)
          sum[k] += block.columns[0][k] * v[0] + block.columns[1][k] * v[1] + block.columns[2][k] * v[2];
      }
      btScalar* out = result[static_cast<int>(row)].m_floats;
      for (int k = 0; k < 4; ++k) out[k] += factor * sum[k];
    }
  }

 private:
  // Columns of four numbers, the last one padding, so that compilers make one instruction of them.
  struct Block {
    btScalar columns[3][4] = {};
  };

  void find_places(const std::vector<Element>& elements) {
    elements_ = elements;
    std::vector<std::vector<int>> rows;
    for (const Element& e : elements)
      for (int row : e) {
        if (rows.size() <= static_cast<std::size_t>(row)) rows.resize(static_cast<std::size_t>(row) + 1);
        rows[static_cast<std::size_t>(row)].insert(rows[static_cast<std::size_t>(row)].end(), e.begin(), e.end());
      }
    starts_.assign(1, 0);
    columns_.clear();
    for (std::vector<int>& row : rows) {
      std::sort(row.begin(), row.end());
      columns_.insert(columns_.end(), row.begin(), std::unique(row.begin(), row.end()));
      starts_.push_back(columns_.size());
    }
    values_.resize(columns_.size());
    places_.clear();
    for (const Element& e : elements)
      for (int row : e)
        for (int column : e) {
          const auto first = columns_.begin() + static_cast<std::ptrdiff_t>(starts_[static_cast<std::size_t>(row)]);
          const auto last = columns_.begin() + static_cast<std::ptrdiff_t>(starts_[static_cast<std::size_t>(row) + 1]);
          places_.push_back(static_cast<std::size_t>(std::lower_bound(first, last, column) - columns_.begin()));
        }
  }

  std::vector<Element> elements_;
  std::vector<std::size_t> places_;  // of the sixteen blocks of each element
  std::vector<std::size_t> starts_;  // of the rows
  std::vector<int> columns_;
  std::vector<Block> values_;
};

}  // namespace demo

#endif  // RAYCONTACT_DEMOS_SCENE_STIFFNESS_MATRIX_HPP
