// SPDX-License-Identifier: MIT OR Apache-2.0
/** Bullet's corotated elasticity with the rotation that belongs to each element. */
#ifndef RAYCONTACT_BULLET_COROTATED_ELASTICITY_HPP
#define RAYCONTACT_BULLET_COROTATED_ELASTICITY_HPP

#include <BulletSoftBody/btDeformableLinearElasticityForce.h>
#include <BulletSoftBody/btSoftBody.h>

#include <limits>

#include "raycontact/bullet/precision.hpp"

namespace raycontact::bullet {

/**
 * To be used like btDeformableLinearElasticityForce, and in its place. Corotated elasticity measures an element's
 * strain against the rotation nearest to its deformation. In a body that has rolled over, Bullet's rotation of an
 * element is at times wrong by half a turn. The forces are then those of an element turned inside out, and its nodes
 * jump.
 */
class CorotatedElasticity : public btDeformableLinearElasticityForce {
 public:
  using btDeformableLinearElasticityForce::btDeformableLinearElasticityForce;

  /** @cond What Bullet calls, as it describes it. */

  void addScaledForces(btScalar scale, TVStack& force) override {
    find_rotations();
    btDeformableLinearElasticityForce::addScaledForces(scale, force);
  }

  void addScaledExplicitForce(btScalar scale, TVStack& force) override {
    find_rotations();
    btDeformableLinearElasticityForce::addScaledExplicitForce(scale, force);
  }

  /** @endcond */

 protected:
  /** The rotations of all elements, where Bullet keeps them; the derivatives of the forces read them there too. */
  void find_rotations() {
    for (int b = 0; b < m_softBodies.size(); ++b)
      for (int t = 0; t < m_softBodies[b]->m_tetraScratches.size(); ++t) {
        btSoftBody::TetraScratch& element = m_softBodies[b]->m_tetraScratches[t];
        btMatrix3x3 rotation = element.m_F;
        if (to_rotation(rotation)) element.m_corotation = rotation;
      }
  }

 private:
  // The mean of a matrix and its inverse transposed has singular values nearer to 1 and the same nearest rotation.
  // False where the matrix turns inside out: what comes out would be a mirror.
  static bool to_rotation(btMatrix3x3& matrix) {
    // Each round at least halves singular values far above 1 and then squares the error.
    constexpr int most_rounds = 2 * std::numeric_limits<btScalar>::digits;
    constexpr btScalar rounding = 16 * std::numeric_limits<btScalar>::epsilon();
    for (int round = 0; round < most_rounds; ++round) {
      const btScalar determinant = matrix.determinant();
      if (!(determinant > 0)) return false;
      const btMatrix3x3 other = matrix.adjoint().transpose() * (1 / determinant);
      btScalar change = 0;
      for (int row = 0; row < 3; ++row) {
        const btVector3 half = (other[row] - matrix[row]) / 2;
        change += half.length2();
        matrix[row] += half;
      }
      if (change < rounding * rounding) return true;
    }
    return false;
  }
};

}  // namespace raycontact::bullet

#endif  // RAYCONTACT_BULLET_COROTATED_ELASTICITY_HPP
