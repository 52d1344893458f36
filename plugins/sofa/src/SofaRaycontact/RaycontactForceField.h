// SPDX-License-Identifier: MIT OR Apache-2.0
// The response: contact forces and friction.
#pragma once

#include <SofaRaycontact/Carriers.h>
#include <SofaRaycontact/RaycontactNarrowPhase.h>
#include <sofa/core/behavior/BaseInteractionForceField.h>

#include <raycontact/sofa_response.hpp>

namespace sofaraycontact {

class SOFARAYCONTACT_API RaycontactForceField : public sofa::core::behavior::BaseInteractionForceField {
 public:
  SOFA_CLASS(RaycontactForceField, sofa::core::behavior::BaseInteractionForceField);

  using MechanicalParams = sofa::core::MechanicalParams;
  using VecCoord = DataTypes::VecCoord;
  using VecDeriv = DataTypes::VecDeriv;

  sofa::Data<SReal> d_stiffness;
  sofa::Data<SReal> d_dampingTime;
  sofa::Data<SReal> d_friction;
  sofa::Data<SReal> d_depthCap;
  sofa::Data<bool> d_foldMappings;
  sofa::Data<SReal> d_forceScale;
  sofa::Data<SReal> d_wrongPart;
  sofa::SingleLink<RaycontactForceField, RaycontactNarrowPhase,
                   sofa::core::objectmodel::BaseLink::FLAG_STOREPATH |
                       sofa::core::objectmodel::BaseLink::FLAG_STRONGLINK>
      l_narrowPhase;

  void init() override;
  void reset() override;
  void handleEvent(sofa::core::objectmodel::Event* event) override;

  void addForce(const MechanicalParams* params, sofa::core::MultiVecDerivId f) override;
  void addDForce(const MechanicalParams* params, sofa::core::MultiVecDerivId df) override;
  void addMBKdx(const MechanicalParams* params, sofa::core::MultiVecDerivId df) override;
  void addKToMatrix(const MechanicalParams*, const sofa::core::behavior::MultiMatrixAccessor*) override {}
  void buildStiffnessMatrix(sofa::core::behavior::StiffnessMatrix*) override {}
  void buildDampingMatrix(sofa::core::behavior::DampingMatrix* matrix) override;
  SReal getPotentialEnergy(const MechanicalParams* params) const override;
  void draw(const sofa::core::visual::VisualParams* params) override;

 protected:
  RaycontactForceField();
  ~RaycontactForceField() override;

 private:
  class Writing;

  bool begin(const MechanicalParams* params, bool is_implicit);
  void takeNewSurfaces();
  void warnOfSolvers(bool is_implicit);
  bool moves(const Triangles& model) const;
  double totalMass(const Triangles& model) const;
  double nodeMass(const Surface& surface, std::size_t nodes) const;
  std::vector<double> cageMasses(const Surface& surface, const State& cage) const;
  void addSurface(const Surface& surface);
  void forget();
  double step() const;
  double automaticStiffness() const;
  void read(sofa::core::ConstMultiVecDerivId v);
  template <class Call>
  void guarded(const char* what, Call call);

  raycontact::ContactResponse<DataTypes> response_;
  /** What carries the surfaces that the response knows. */
  std::vector<Carrier> carriers_;
  /** By the surfaces' numbers, kept from step to step. */
  std::vector<const VecCoord*> x_;
  std::vector<const VecDeriv*> v_;
  std::vector<VecDeriv*> f_;
  unsigned generation_ = 0;
  double dt_ = 0;
  double stiffness_ = 0;
  bool is_step_new_ = false;
  bool is_ill_ = false;
  bool has_warned_of_solvers_ = false;
};

}  // namespace sofaraycontact
