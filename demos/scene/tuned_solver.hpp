// SPDX-License-Identifier: MIT OR Apache-2.0
/** What Bullet's virtual functions and protected members allow to speed up its implicit solve. */
#ifndef RAYCONTACT_DEMOS_SCENE_TUNED_SOLVER_HPP
#define RAYCONTACT_DEMOS_SCENE_TUNED_SOLVER_HPP

#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableLinearElasticityForce.h>

#include <array>
#include <cstddef>
#include <vector>

namespace demo {

/** Bullet's solver with another limit of iterations; 0 keeps its own 300. */
class TunedSolver : public btDeformableBodySolver {
 public:
  explicit TunedSolver(int iterations) {
    if (iterations > 0) m_cg.m_maxIterations = m_cr.m_maxIterations = iterations;
  }
};

/**
 * Bullet's corotated elasticity with its matrix product in a third of the time or less: elastic and damping part in one
 * pass, over gradients that are rotated once for each solve instead of in each of its iterations.
 */
class MergedElasticity : public btDeformableLinearElasticityForce {
 public:
  void addScaledForces(btScalar scale, TVStack& force) override {
    btDeformableLinearElasticityForce::addScaledForces(scale, force);
    collect_elements();
  }

  // scale = -dt^2, always, and the damping part's own would be -dt.
  void addScaledElasticForceDifferential(btScalar scale, const TVStack& dx, TVStack& df) override {
    const btScalar factor = scale - btSqrt(-scale) * m_damping_beta;
    const btScalar mu = m_mu, lambda = m_lambda;
    for (const Element& e : elements_) {
      const btVector3& x0 = dx[e.nodes[0]];
      const btVector3 d[3] = {dx[e.nodes[1]] - x0, dx[e.nodes[2]] - x0, dx[e.nodes[3]] - x0};
      // The gradient of the displacement is h = sum of d_k n_k^T; stress = mu (h + h^T) + lambda trace(h).
      const btScalar trace = d[0].dot(e.gradients[0]) + d[1].dot(e.gradients[1]) + d[2].dot(e.gradients[2]);
      btVector3 row[3];
      for (int i = 0; i < 3; ++i)
        row[i] = d[0][i] * e.gradients[0] + d[1][i] * e.gradients[1] + d[2][i] * e.gradients[2];
      const btVector3 column[3] = {
          {row[0][0], row[1][0], row[2][0]}, {row[0][1], row[1][1], row[2][1]}, {row[0][2], row[1][2], row[2][2]}};
      const btScalar weight = factor * e.volume;
      btVector3 sum(0, 0, 0);
      for (std::size_t k = 0; k < 3; ++k) {
        const btVector3& n = e.gradients[k];
        btVector3 force = (lambda * trace) * n;
        for (int i = 0; i < 3; ++i) force += (mu * n[i]) * (row[i] + column[i]);
        force *= weight;
        sum += force;
        df[e.nodes[k + 1]] -= force;
      }
      df[e.nodes[0]] += sum;
    }
  }

  void addScaledDampingForceDifferential(btScalar scale, const TVStack& dv, TVStack& df) override {
    for (const Mass& m : masses_) df[m.node] -= (scale * m_damping_alpha * m.mass) * dv[m.node];
  }

 private:
  struct Element {
    btVector3 gradients[3];  // of the last three corners' shape functions, turned with the element
    std::array<int, 4> nodes;
    btScalar volume;
  };

  struct Mass {
    int node;
    btScalar mass;
  };

  void collect_elements() {
    elements_.clear();
    masses_.clear();
    for (int b = 0; b < m_softBodies.size(); ++b) {
      const btSoftBody& body = *m_softBodies[b];
      for (int t = 0; t < body.m_tetras.size(); ++t) {
        const btSoftBody::Tetra& tetra = body.m_tetras[t];
        Element e;
        for (std::size_t k = 0; k < 4; ++k) e.nodes[k] = tetra.m_n[k]->index;
        for (int k = 0; k < 3; ++k) e.gradients[k] = body.m_tetraScratches[t].m_corotation * tetra.m_Dm_inverse[k];
        e.volume = tetra.m_element_measure;
        elements_.push_back(e);
      }
      for (int n = 0; n < body.m_nodes.size(); ++n)
        if (body.m_nodes[n].m_im > 0) masses_.push_back({body.m_nodes[n].index, 1 / body.m_nodes[n].m_im});
    }
  }

  std::vector<Element> elements_;
  std::vector<Mass> masses_;
};

}  // namespace demo

#endif  // RAYCONTACT_DEMOS_SCENE_TUNED_SOLVER_HPP
