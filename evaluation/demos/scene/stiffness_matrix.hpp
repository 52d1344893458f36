// SPDX-License-Identifier: MIT OR Apache-2.0
/** A sparse matrix of 3 x 3 blocks over the nodes of tetrahedra: the same places every step, new values. */
#ifndef RAYCONTACT_DEMOS_SCENE_STIFFNESS_MATRIX_HPP
#define RAYCONTACT_DEMOS_SCENE_STIFFNESS_MATRIX_HPP

#include <LinearMath/btAlignedObjectArray.h>
#include <LinearMath/btVector3.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
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
   * linear elasticity, n_i the gradient of corner i's shape function. To be called for each element, then finish().
   */
  void add_element(std::size_t number, const std::array<btVector3, 4>& gradients, btScalar volume, btScalar mu,
                   btScalar lambda) {
    const Places& places = places_[number];
    std::size_t pair = 0;
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i; j < 4; ++j) {
        const btScalar *n = gradients[places.order[i]].m_floats, *m = gradients[places.order[j]].m_floats;
        const btScalar diagonal = volume * mu * (n[0] * m[0] + n[1] * m[1] + n[2] * m[2]);
        const btScalar unit[3][4] = {{diagonal, 0, 0, 0}, {0, diagonal, 0, 0}, {0, 0, diagonal, 0}};
        btScalar* values = values_[places.blocks[pair++]].columns[0];
        for (int c = 0; c < 3; ++c) {
          const btScalar direct = volume * lambda * m[c], crossed = volume * mu * n[c];
          for (int k = 0; k < 4; ++k) values[4 * c + k] += direct * n[k] + crossed * m[k] + unit[c][k];
        }
      }
  }

  /** The blocks below the diagonal, from those above. */
  void finish() {
    for (const auto& [above, below] : mirrored_)
      for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
          values_[below].columns[row][column] = values_[above].columns[column][row];
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

  struct Places {
    std::array<std::size_t, 4> order;    // of the corners, by rising node number
    std::array<std::size_t, 10> blocks;  // of their pairs in that order, row before column
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
    mirrored_.clear();
    for (std::size_t row = 0; row < rows.size(); ++row)
      for (std::size_t b = starts_[row]; b < starts_[row + 1]; ++b)
        if (columns_[b] > static_cast<int>(row)) mirrored_.push_back({b, place(columns_[b], static_cast<int>(row))});
    places_.clear();
    for (const Element& e : elements) {
      Places places{{{0, 1, 2, 3}}, {}};
      std::sort(places.order.begin(), places.order.end(), [&](std::size_t a, std::size_t b) { return e[a] < e[b]; });
      std::size_t pair = 0;
      for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = i; j < 4; ++j) places.blocks[pair++] = place(e[places.order[i]], e[places.order[j]]);
      places_.push_back(places);
    }
  }

  std::size_t place(int row, int column) const {
    const auto first = columns_.begin() + static_cast<std::ptrdiff_t>(starts_[static_cast<std::size_t>(row)]);
    const auto last = columns_.begin() + static_cast<std::ptrdiff_t>(starts_[static_cast<std::size_t>(row) + 1]);
    return static_cast<std::size_t>(std::lower_bound(first, last, column) - columns_.begin());
  }

  std::vector<Element> elements_;
  std::vector<Places> places_;       // of each element
  std::vector<std::size_t> starts_;  // of the rows
  std::vector<int> columns_;
  std::vector<std::pair<std::size_t, std::size_t>> mirrored_;  // blocks above the diagonal, and below
  std::vector<Block> values_;
};

}  // namespace demo

#endif  // RAYCONTACT_DEMOS_SCENE_STIFFNESS_MATRIX_HPP
