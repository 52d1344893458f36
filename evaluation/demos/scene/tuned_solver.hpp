// SPDX-License-Identifier: MIT OR Apache-2.0
/** What Bullet's virtual functions and protected members allow to speed up its implicit solve. */
#ifndef RAYCONTACT_DEMOS_SCENE_TUNED_SOLVER_HPP
#define RAYCONTACT_DEMOS_SCENE_TUNED_SOLVER_HPP

#include <BulletSoftBody/btDeformableBodySolver.h>

#include <array>
#include <cstddef>
#include <vector>

#include "raycontact/bullet/contact_force.hpp"
#include "raycontact/bullet/corotated_elasticity.hpp"
#include "stiffness_matrix.hpp"

namespace demo {

/** Bullet's solver with another limit of iterations (0 keeps its own 300), and contacts sought again within a step. */
class TunedSolver : public btDeformableBodySolver {
 public:
  explicit TunedSolver(int iterations) {
    if (iterations > 0) m_cg.m_maxIterations = m_cr.m_maxIterations = iterations;
  }

  /** At most so many detections and solves in a step. */
  void detect_again(raycontact::bullet::ContactForce& contact, int passes) {
    contact_ = &contact;
    passes_ = passes;
  }

  // As in the class below, but for the question after each Newton step whether there is more in the way.
  void solveDeformableConstraints(btScalar time_step) override {
    if (contact_ == nullptr || !m_implicit || m_lineSearch) {
      btDeformableBodySolver::solveDeformableConstraints(time_step);
      return;
    }
    for (int pass = 1;; ++pass) {
      updateState();
      for (int n = 0; n < m_residual.size(); ++n) {
        const btSoftBody::Node& node = *m_objective->m_nodes[n];
        m_residual[n] = node.m_im > 0 ? m_dv[n] / -node.m_im : btVector3(0, 0, 0);
      }
      m_objective->computeResidual(time_step, m_residual);
      m_objective->applyDynamicFriction(m_residual);
      computeStep(m_ddv, m_residual);
      updateDv();
      for (int n = 0; n < m_ddv.size(); ++n) {
        m_ddv[n].setZero();
        m_residual[n].setZero();
      }
      updateVelocity();
      if (pass >= passes_ || !contact_->detect_again()) return;
    }
  }

 private:
  raycontact::bullet::ContactForce* contact_ = nullptr;
  int passes_ = 1;
};

/**
 * Bullet's corotated elasticity with its matrix assembled once a solve: elastic and damping part in one product, where
 * Bullet goes through all elements twice in each iteration and turns each of them.
 */
class MergedElasticity : public raycontact::bullet::CorotatedElasticity {
 public:
  void addScaledForces(btScalar scale, TVStack& force) override {
    find_rotations();
    assemble();
    addScaledDampingForce(scale, force);
    addScaledElasticForce(scale, force);
  }

  void addScaledDampingForce(btScalar scale, TVStack& force) override {
    velocities_.resize(force.size());
    for (int b = 0; b < m_softBodies.size(); ++b)
      for (int n = 0; n < m_softBodies[b]->m_nodes.size(); ++n)
        velocities_[m_softBodies[b]->m_nodes[n].index] = m_softBodies[b]->m_nodes[n].m_v;
    matrix_.add_product(-scale * m_damping_beta, velocities_, force);
    addScaledDampingForceDifferential(scale, velocities_, force);
  }

  // scale = -dt^2, always, and the damping part's own would be -dt.
  void addScaledElasticForceDifferential(btScalar scale, const TVStack& dx, TVStack& df) override {
    matrix_.add_product(btSqrt(-scale) * m_damping_beta - scale, dx, df);
  }

  void addScaledDampingForceDifferential(btScalar scale, const TVStack& dv, TVStack& df) override {
    for (const Mass& m : masses_) df[m.node] -= (scale * m_damping_alpha * m.mass) * dv[m.node];
  }

 private:
  struct Mass {
    int node;
    btScalar mass;
  };

  void assemble() {
    elements_.clear();
    masses_.clear();
    for (int b = 0; b < m_softBodies.size(); ++b) {
      const btSoftBody& body = *m_softBodies[b];
      for (int t = 0; t < body.m_tetras.size(); ++t) {
        StiffnessMatrix::Element e;
        for (std::size_t k = 0; k < 4; ++k) e[k] = body.m_tetras[t].m_n[k]->index;
        elements_.push_back(e);
      }
      for (int n = 0; n < body.m_nodes.size(); ++n)
        if (body.m_nodes[n].m_im > 0) masses_.push_back({body.m_nodes[n].index, 1 / body.m_nodes[n].m_im});
    }
    matrix_.start(elements_);
    std::size_t number = 0;
    for (int b = 0; b < m_softBodies.size(); ++b) {
      const btSoftBody& body = *m_softBodies[b];
      for (int t = 0; t < body.m_tetras.size(); ++t) {
        const btSoftBody::Tetra& tetra = body.m_tetras[t];
        std::array<btVector3, 4> gradients;  // turned with the element
        gradients[0].setZero();
        for (int k = 0; k < 3; ++k) {
          gradients[static_cast<std::size_t>(k) + 1] = body.m_tetraScratches[t].m_corotation * tetra.m_Dm_inverse[k];
          gradients[0] -= gradients[static_cast<std::size_t>(k) + 1];
        }
        matrix_.add_element(number++, gradients, tetra.m_element_measure, m_mu, m_lambda);
      }
    }
    matrix_.finish();
  }

  StiffnessMatrix matrix_;
  std::vector<StiffnessMatrix::Element> elements_;
  std::vector<Mass> masses_;
  TVStack velocities_;
};

}  // namespace demo

#endif  // RAYCONTACT_DEMOS_SCENE_TUNED_SOLVER_HPP
