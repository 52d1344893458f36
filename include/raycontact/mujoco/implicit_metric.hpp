// SPDX-License-Identifier: MIT OR Apache-2.0
/** What MuJoCo's implicit step weighs changes of velocity with, and a solver for it. */
#ifndef RAYCONTACT_MUJOCO_IMPLICIT_METRIC_HPP
#define RAYCONTACT_MUJOCO_IMPLICIT_METRIC_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "raycontact/mujoco/stiffness_blocks.hpp"
#include "raycontact/mujoco/version.hpp"

namespace raycontact::mujoco {

/**
 * M + h D + h^2 K: mass, damping and stiffness of flexes and joints, as mjData holds them while passive forces are
 * asked for. Without the discrete integrator M alone.
 */
class ImplicitMetric {
 public:
  /** The degrees of freedom and their blocks: of three where a body slides three ways, of one elsewhere. */
  explicit ImplicitMetric(const mjModel* m) {
    const auto count = static_cast<std::size_t>(m->nv);
    block_of_.resize(count);
    for (int dof = 0; dof < m->nv;) {
      const int body = m->dof_bodyid[dof], number = m->body_dofnum[body];
      bool slides = number == 3;
      for (int k = 0; k < number; ++k) slides = slides && m->jnt_type[m->dof_jntid[dof + k]] == mjJNT_SLIDE;
      for (int k = 0; k < number; ++k) {
        if (k == 0 || !slides) firsts_.push_back(dof + k), sizes_.push_back(slides ? 3 : 1);
        block_of_[static_cast<std::size_t>(dof + k)] = static_cast<uint32_t>(firsts_.size() - 1);
      }
      dof += number;
    }
    blocks_.resize(9 * firsts_.size());
    // MuJoCo's matrix has h^2 K + h D = (h^2 + h c) K for a flex with the damping time c.
    damping_time_.assign(count, 0);
    for (int flex = 0; flex < m->nflex; ++flex) {
      const bool has_cells = m->flex_interp[flex] != 0;
      const int* bodies =
          has_cells ? m->flex_nodebodyid + m->flex_nodeadr[flex] : m->flex_vertbodyid + m->flex_vertadr[flex];
      for (int n = 0; n < (has_cells ? m->flex_nodenum[flex] : m->flex_vertnum[flex]); ++n)
        for (int body = bodies[n]; body > 0; body = m->body_parentid[body])
          for (int k = m->body_dofadr[body]; k < m->body_dofadr[body] + m->body_dofnum[body]; ++k)
            damping_time_[static_cast<std::size_t>(k)] = m->flex_damping[flex];
    }
  }

  /** Takes the matrix of this step; before all that follows. */
  void renew(const mjModel* m, const mjData* d) {
    stiffness_.renew(m, d);
    gather_blocks(m, d);
    invert_blocks();
  }

  /** result = (M + h D + h^2 K) change. */
  void product(const mjModel* m, const mjData* d, const Numbers& change, Numbers& result) const {
    mj_mulM(m, d, result.data(), change.data());
    stiffness_.add_product(m, d, change, result);
    if (d->efm_active != 0 && d->efm_diag != nullptr)
      for (std::size_t k = 0; k < result.size(); ++k) result[k] += d->efm_diag[k] * change[k];
  }

  /** The shift of force -h K v by which MuJoCo's step looks ahead: of a flex's stiffness, at velocity v. */
  void subtract_shift(const mjModel* m, const mjData* d, const Numbers& velocity, Numbers& force,
                      Numbers& buffer) const {
    std::fill(buffer.begin(), buffer.end(), 0.0);
    stiffness_.add_product(m, d, velocity, buffer);
    const double h = m->opt.timestep;
    for (std::size_t k = 0; k < force.size(); ++k) force[k] -= buffer[k] / (h + damping_time_[k]);
  }

  /** The length of a force as the preconditioner measures it. */
  double norm(const Numbers& force, Numbers& buffer) const {
    precondition(force, buffer);
    double sum = 0;
    for (std::size_t k = 0; k < force.size(); ++k) sum += force[k] * buffer[k];
    return std::sqrt(sum);
  }

  /** to = the inverse of the blocks times from. */
  void precondition(const Numbers& from, Numbers& to) const {
    for (std::size_t b = 0; b < firsts_.size(); ++b) {
      const double* a = &blocks_[9 * b];
      const double* x = &from[static_cast<std::size_t>(firsts_[b])];
      double* y = &to[static_cast<std::size_t>(firsts_[b])];
      if (sizes_[b] == 1) {
        y[0] = a[0] * x[0];
      } else {
        for (std::size_t k = 0; k < 3; ++k) y[k] = a[3 * k] * x[0] + a[3 * k + 1] * x[1] + a[3 * k + 2] * x[2];
      }
    }
  }

 private:
  void gather_blocks(const mjModel* m, const mjData* d) {
    std::fill(blocks_.begin(), blocks_.end(), 0.0);
    for (int i = 0; i < m->nv; ++i) {
      for (int k = m->M_rowadr[i]; k < m->M_rowadr[i] + m->M_rownnz[i]; ++k) {
        add_to_block(i, m->M_colind[k], d->M[k]);
        if (m->M_colind[k] != i) add_to_block(m->M_colind[k], i, d->M[k]);
      }
      if (d->efm_active == 0) continue;
      if (d->nefmK != 0)
        for (int k = d->efm_K_rowadr[i]; k < d->efm_K_rowadr[i] + d->efm_K_rownnz[i]; ++k)
          add_to_block(i, d->efm_K_colind[k], d->efm_K_val[k]);
      if (d->efm_diag != nullptr) add_to_block(i, i, d->efm_diag[i]);
    }
  }

  // Where row and column, degrees of freedom, are of one block.
  void add_to_block(int row, int column, double value) {
    const uint32_t block = block_of_[static_cast<std::size_t>(row)];
    if (block_of_[static_cast<std::size_t>(column)] != block) return;
    const int first = firsts_[block];
    blocks_[9 * block + static_cast<std::size_t>(3 * (row - first) + column - first)] += value;
  }

  void invert_blocks() {
    for (std::size_t b = 0; b < firsts_.size(); ++b) {
      double* a = &blocks_[9 * b];
      if (sizes_[b] == 1) {
        a[0] = 1 / a[0];
        continue;
      }
      const double xx = a[4] * a[8] - a[5] * a[7], xy = a[2] * a[7] - a[1] * a[8], xz = a[1] * a[5] - a[2] * a[4];
      const double yy = a[0] * a[8] - a[2] * a[6], yz = a[2] * a[3] - a[0] * a[5], zz = a[0] * a[4] - a[1] * a[3];
      const double scale = 1 / (a[0] * xx + a[3] * xy + a[6] * xz);
      const std::array<double, 9> inverse{{xx, xy, xz, xy, yy, yz, xz, yz, zz}};
      for (std::size_t k = 0; k < 9; ++k) a[k] = scale * inverse[k];
    }
  }

  StiffnessBlocks stiffness_;
  Numbers damping_time_;            // of the flex that each degree of freedom belongs to
  std::vector<uint32_t> block_of_;  // by degree of freedom
  std::vector<int> firsts_, sizes_;
  Numbers blocks_;  // nine numbers for each
};

/** Conjugate gradients with room for their vectors. */
class ConjugateGradients {
 public:
  /**
   * Adds to x the solution of A y = residual, by `product(p, Ap)` and `precondition(r, z)`; true where the residual, as
   * the preconditioner measures it, has fallen to `tolerance` times `reference`.
   */
  template <class Product, class Precondition>
  bool solve(Numbers& x, Numbers& residual, double tolerance, double reference, int iterations, Product&& product,
             Precondition&& precondition) {
    const std::size_t count = x.size();
    preconditioned_.resize(count), direction_.resize(count), product_.resize(count);
    precondition(residual, preconditioned_);
    direction_ = preconditioned_;
    double square = dot(residual, preconditioned_);
    const double goal = tolerance * tolerance * reference * reference;
    for (last_ = 0; square > goal && last_ < iterations; ++last_) {
      product(direction_, product_);
      const double curvature = dot(direction_, product_);
      if (!(curvature > 0)) return false;
      const double step = square / curvature;
      for (std::size_t k = 0; k < count; ++k) {
        x[k] += step * direction_[k];
        residual[k] -= step * product_[k];
      }
      precondition(residual, preconditioned_);
      const double next = dot(residual, preconditioned_), turn = next / square;
      for (std::size_t k = 0; k < count; ++k) direction_[k] = preconditioned_[k] + turn * direction_[k];
      square = next;
    }
    return square <= goal;
  }

  /** How many iterations the last solve took. */
  int iterations() const { return last_; }

 private:
  static double dot(const Numbers& a, const Numbers& b) {
    std::array<double, 4> sums{};
    std::size_t k = 0;
    for (; k + 4 <= a.size(); k += 4)
      for (std::size_t j = 0; j < 4; ++j) sums[j] += a[k + j] * b[k + j];
    double sum = (sums[0] + sums[1]) + (sums[2] + sums[3]);
    for (; k < a.size(); ++k) sum += a[k] * b[k];
    return sum;
  }

  Numbers preconditioned_, direction_, product_;
  int last_ = 0;
};

}  // namespace raycontact::mujoco

#endif  // RAYCONTACT_MUJOCO_IMPLICIT_METRIC_HPP
