// SPDX-License-Identifier: MIT OR Apache-2.0
#include <SofaRaycontact/RaycontactForceField.h>
#include <sofa/core/MechanicalParams.h>
#include <sofa/core/behavior/BaseLocalForceFieldMatrix.h>
#include <sofa/core/behavior/BaseMass.h>
#include <sofa/core/behavior/OdeSolver.h>
#include <sofa/core/visual/VisualParams.h>
#include <sofa/simulation/AnimateBeginEvent.h>
#include <sofa/simulation/CollisionEndEvent.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace sofaraycontact {

using sofa::core::behavior::OdeSolver;
using sofa::core::objectmodel::BaseContext;

namespace {

template <class Component>
Component* above(const BaseContext* context) {
  return context->get<Component>(BaseContext::SearchUp);
}

}  // namespace

/** The arrays that forces go to, for as long as it lives; NULL for models that nothing moves. */
class RaycontactForceField::Writing {
 public:
  Writing(RaycontactForceField& field, sofa::core::MultiVecDerivId id) : field_(field), id_(id) {
    field.f_.clear();
    for (std::size_t k = 0; k < field.carriers_.size(); ++k) {
      VecDeriv* forces = nullptr;
      if (field.carriers_[k].moves) {
        State& state = *field.carriers_[k].state;
        forces = state.write(id.getId(&state))->beginEdit();
        if (forces->size() < state.getSize()) forces->resize(state.getSize());
      }
      field.f_.push_back(forces);
    }
  }
  ~Writing() {
    for (std::size_t k = 0; k < field_.f_.size(); ++k)
      if (field_.f_[k] != nullptr)
        field_.carriers_[k].state->write(id_.getId(field_.carriers_[k].state.get()))->endEdit();
  }
  Writing(const Writing&) = delete;
  Writing& operator=(const Writing&) = delete;

 private:
  RaycontactForceField& field_;
  sofa::core::MultiVecDerivId id_;
};

RaycontactForceField::RaycontactForceField()
    : d_stiffness(
          initData(&d_stiffness, SReal(0), "stiffness",
                   "Pressure per depth, in N/m3 where lengths are metres and masses kg. 0: from the weights and "
                   "sizes of the models; the log says how much.")),
      d_dampingTime(initData(&d_dampingTime, SReal(0.05), "dampingTime", "Damping over stiffness, in s.")),
      d_friction(initData(&d_friction, SReal(0), "friction", "Coulomb's coefficient.")),
      d_depthCap(initData(&d_depthCap, SReal(0), "depthCap",
                          "The depth beyond which one step asks for no more force than there. 0: none.")),
      d_foldMappings(initData(&d_foldMappings, true, "foldMappings",
                              "Act on the cage of a skin itself where its mapping is linear, past the mapping.")),
      d_forceScale(initData(&d_forceScale, SReal(0.01), "forceScale", "Length drawn for a force of 1.")),
      d_wrongPart(initData(&d_wrongPart, SReal(0), "wrongPart",
                           "The part of all force, 0 to 1, that the last step's solve took wrongly for pushing.", true,
                           true)),
      l_narrowPhase(
          initLink("narrowPhase", "The RaycontactNarrowPhase whose models touch. Found by itself if there is one.")) {
  f_listening.setValue(true);
}

void RaycontactForceField::init() {
  BaseInteractionForceField::init();
  if (!l_narrowPhase) l_narrowPhase.set(getContext()->get<RaycontactNarrowPhase>(BaseContext::SearchRoot));
  if (!l_narrowPhase) {
    msg_error() << "narrowPhase links to nothing and the scene has no RaycontactNarrowPhase: there will be no forces.";
    d_componentState.setValue(sofa::core::objectmodel::ComponentState::Invalid);
    return;
  }
  if (!l_narrowPhase->d_publishContacts.isSet())
    l_narrowPhase->d_publishContacts.setValue(false);
  else if (l_narrowPhase->d_publishContacts.getValue())
    msg_warning() << l_narrowPhase->getPathName() << " publishes its contacts, so SOFA's own response pushes too: set "
                  << "publishContacts to 0, or take this force field out.";
  // Rays from vertices at edges are oblique, and hold on where they should slide.
  if (d_friction.getValue() > 0 && !l_narrowPhase->d_sampleSpacing.isSet()) l_narrowPhase->d_sampleSpacing.setValue(-1);
  // Matrix-based linear systems ask at the start which states a force field couples.
  for (Triangles* model : getContext()->getRootContext()->getObjects<Triangles>(BaseContext::SearchDown)) {
    if (!model->isSimulated() || model->getMechanicalState() == nullptr) continue;
    l_mechanicalStates.add(model->getMechanicalState());
    if (State* cage = d_foldMappings.getValue() ? cageOf(model->getMechanicalState()) : nullptr)
      l_mechanicalStates.add(cage);
  }
  d_componentState.setValue(sofa::core::objectmodel::ComponentState::Valid);
}

RaycontactForceField::~RaycontactForceField() {
  for (Carrier& carrier : carriers_) open(carrier);
}

void RaycontactForceField::forget() {
  response_.clear();
  for (Carrier& carrier : carriers_) open(carrier);
  carriers_.clear();
  generation_ = 0;
}

void RaycontactForceField::reset() {
  forget();
  stiffness_ = 0;
  is_step_new_ = is_ill_ = has_warned_of_solvers_ = false;
}

void RaycontactForceField::handleEvent(sofa::core::objectmodel::Event* event) {
  // Before the solvers run, and after the last that may add to the scene.
  if (sofa::simulation::CollisionEndEvent::checkEventType(event) && l_narrowPhase)
    cutOrOpen(l_narrowPhase->surfaces(), carriers_);
  if (!sofa::simulation::AnimateBeginEvent::checkEventType(event)) return;
  is_step_new_ = true;
  dt_ = static_cast<sofa::simulation::AnimateBeginEvent*>(event)->getDt();
}

/** A wrong state or option is told once, until all is well again; there are no forces meanwhile. */
template <class Call>
void RaycontactForceField::guarded(const char* what, Call call) {
  try {
    call();
    is_ill_ = false;
  } catch (const raycontact::Error& error) {
    if (!is_ill_) {
      msg_error() << what << ": " << error.what();
      for (std::size_t k = 0; k < l_narrowPhase->surfaces().size(); ++k)
        msg_error() << "Model " << k << " is " << l_narrowPhase->surfaces()[k].model->getPathName();
    }
    is_ill_ = true;
    response_.clear();
    generation_ = 0;
  }
}

bool RaycontactForceField::moves(const Triangles& model) const {
  return model.isSimulated() && above<OdeSolver>(model.getContext()) != nullptr;
}

void RaycontactForceField::read(sofa::core::ConstMultiVecDerivId id) {
  v_.clear();
  for (const Carrier& carrier : carriers_) {
    const auto* vectors = carrier.state->read(id.getId(carrier.state.get()));
    const bool has_one_each = vectors != nullptr && vectors->getValue().size() == carrier.state->getSize();
    v_.push_back(has_one_each ? &vectors->getValue() : nullptr);
  }
}

/** Of the body that the model is on; 0 where nothing says. */
double RaycontactForceField::totalMass(const Triangles& model) const {
  double sum = 0;
  if (const auto* mass = above<sofa::core::behavior::BaseMass>(model.getContext()))
    for (sofa::Index k = 0; k < mass->getContext()->getMechanicalState()->getSize(); ++k)
      sum += mass->getElementMass(k);
  return sum;
}

/** What a node bears of its body's mass: an even share. */
double RaycontactForceField::nodeMass(const Surface& surface, std::size_t nodes) const {
  if (!moves(*surface.model)) return std::numeric_limits<double>::infinity();
  const double sum = totalMass(*surface.model);
  if (sum > 0) return sum / double(nodes);
  msg_warning() << surface.model->getPathName() << " has no mass above it; each of its nodes is taken for 1 kg.";
  return 1;
}

/** The same for the nodes of a cage: their own masses where these are known. */
std::vector<double> RaycontactForceField::cageMasses(const Surface& surface, const State& cage) const {
  std::vector<double> masses(cage.getSize(), nodeMass(surface, cage.getSize()));
  const auto* mass = above<sofa::core::behavior::BaseMass>(surface.state->getContext());
  if (mass == nullptr || dynamic_cast<State*>(mass->getContext()->getMechanicalState()) != &cage) return masses;
  for (std::size_t k = 0; k < masses.size(); ++k)
    if (const double own = mass->getElementMass(static_cast<sofa::Index>(k)); own > 0) masses[k] = own;
  return masses;
}

/**
 * The heaviest model's weight over its smallest shadow, borne three times over at a tenth of the smallest extent of any
 * model that moves, whether it has come near another yet or not.
 */
double RaycontactForceField::automaticStiffness() const {
  double pressure = 0, depth = std::numeric_limits<double>::infinity();
  const double gravity = std::max(1e-3, double(getContext()->getGravity().norm()));
  for (const Triangles* model : getContext()->getRootContext()->getObjects<Triangles>(BaseContext::SearchDown)) {
    if (model->getMechanicalState() == nullptr || !moves(*model)) continue;
    sofa::type::BoundingBox box;
    for (const auto& point : model->getX()) box.include(point);
    const auto size = box.maxBBox() - box.minBBox();
    const double least = std::min({size[0], size[1], size[2]});
    const double shadow = size[0] * size[1] * size[2] / std::max({size[0], size[1], size[2]});
    if (!(shadow > 0)) continue;
    pressure = std::max(pressure, totalMass(*model) * gravity / shadow);
    depth = std::min(depth, least / 10);
  }
  return pressure > 0 ? 3 * pressure / depth : 1;
}

void RaycontactForceField::takeNewSurfaces() {
  const auto& surfaces = l_narrowPhase->surfaces();
  if (generation_ != l_narrowPhase->generation()) {
    forget();
    response_ = raycontact::ContactResponse<DataTypes>(l_narrowPhase->precision());
    generation_ = l_narrowPhase->generation();
    if (d_stiffness.getValue() > 0) stiffness_ = d_stiffness.getValue();
  }
  // Once, not of bodies that have changed on the way.
  if (stiffness_ <= 0 && !surfaces.empty()) {
    stiffness_ = automaticStiffness();
    msg_info() << "stiffness: " << stiffness_;
  }
  if (carriers_.size() == surfaces.size()) return;
  while (carriers_.size() < surfaces.size()) addSurface(surfaces[carriers_.size()]);
  cutOrOpen(surfaces, carriers_);
}

void RaycontactForceField::addSurface(const Surface& surface) {
  raycontact::ContactLaw law;
  law.stiffness = stiffness_;
  law.damping_time = d_dampingTime.getValue();
  law.friction = d_friction.getValue();
  if (d_depthCap.getValue() > 0) law.depth_cap = d_depthCap.getValue();
  const bool is_moved = moves(*surface.model);
  Carrier carrier = is_moved && d_foldMappings.getValue() ? carrierOf(surface) : plainCarrier(surface);
  carrier.moves = is_moved;
  if (carrier.mapping == nullptr) {
    response_.addSurface(l_narrowPhase->stage(), nodeMass(surface, carrier.state->getSize()), law);
  } else {
    carrier.carriers.node_masses = cageMasses(surface, *carrier.state);
    response_.addSurface(l_narrowPhase->stage(), carrier.carriers, law);
  }
  carriers_.push_back(std::move(carrier));
}

void RaycontactForceField::warnOfSolvers(bool is_implicit) {
  if (has_warned_of_solvers_) return;
  has_warned_of_solvers_ = true;
  const auto* own = above<OdeSolver>(getContext());
  if (own == nullptr) {
    msg_warning()
        << "No solver at this force field's node or above it: the response is explicit, as if vertices were loose "
        << "points. Put the bodies and this force field under one solver for a better one.";
    return;
  }
  if (!is_implicit) msg_warning() << own->getPathName() << " is explicit, and so is the response.";
  for (const Surface& surface : l_narrowPhase->surfaces())
    if (moves(*surface.model) && above<OdeSolver>(surface.state->getContext()) != own)
      msg_warning() << surface.model->getPathName() << " is not under " << own->getPathName()
                    << ", the solver of this force field: it is pushed a step late or not at all.";
}

double RaycontactForceField::step() const { return dt_ > 0 ? dt_ : double(getContext()->getDt()); }

/** The positions and velocities of a new step; false where there is nothing to do. */
bool RaycontactForceField::begin(const MechanicalParams* params, bool is_implicit) {
  if (!isComponentStateValid() || !l_narrowPhase->hasRun()) return false;
  const bool begins = is_step_new_ || !is_implicit;
  if (begins) {
    is_step_new_ = false;
    read(params->v());
    if (generation_ == l_narrowPhase->generation()) d_wrongPart.setValue(response_.finish(v_));
    takeNewSurfaces();
  }
  read(params->v());
  if (v_.empty()) return false;
  if (begins) {
    x_.clear();
    for (const Carrier& carrier : carriers_)
      x_.push_back(&carrier.state->read(params->x().getId(carrier.state.get()))->getValue());
    warnOfSolvers(is_implicit);
    if (is_implicit) response_.begin(l_narrowPhase->stage(), step(), x_, v_, getContext()->getGravity().data());
  }
  return true;
}

void RaycontactForceField::addForce(const MechanicalParams* params, sofa::core::MultiVecDerivId f) {
  const bool is_implicit = params->implicit();
  guarded("No contact forces", [&] {
    if (!begin(params, is_implicit)) return;
    const Writing writing(*this, f);
    if (is_implicit) {
      if (response_.isUnderWay()) response_.addForce(f_, v_);
      return;
    }
    const int iterations =
        response_.addSeparateForce(l_narrowPhase->stage(), step(), f_, x_, v_, getContext()->getGravity().data());
    if (iterations == response_.most_iterations)
      msg_warning() << "The explicit response did not come to its end in " << iterations << " iterations: stiffness "
                    << stiffness_ << " is too much for steps of " << step() << " s.";
  });
}

void RaycontactForceField::addMBKdx(const MechanicalParams* params, sofa::core::MultiVecDerivId df) {
  if (sofa::core::mechanicalparams::bFactor(params) != 0) addDForce(params, df);
}

void RaycontactForceField::addDForce(const MechanicalParams* params, sofa::core::MultiVecDerivId df) {
  if (!response_.isUnderWay()) return;
  guarded("No derivative of the contact forces", [&] {
    read(params->dx());
    const Writing writing(*this, df);
    response_.addDForce(f_, v_, sofa::core::mechanicalparams::bFactor(params));
  });
}

void RaycontactForceField::buildDampingMatrix(sofa::core::behavior::DampingMatrix* matrix) {
  if (!response_.isUnderWay()) return;
  const raycontact::Blocks& blocks = response_.blocks();
  for (std::size_t k = 0; k < blocks.rows.size(); ++k) {
    const auto [row_model, row] = response_.place(blocks.rows[k]);
    const auto [column_model, column] = response_.place(blocks.columns[k]);
    if (!carriers_[row_model].moves || !carriers_[column_model].moves) continue;
    sofa::type::Mat<3, 3, SReal> block;
    for (int i = 0; i < 9; ++i) block[i / 3][i % 3] = static_cast<SReal>(blocks.numbers[9 * k + i]);
    matrix->getForceDerivativeIn(carriers_[row_model].state.get())
        .withRespectToVelocityIn(carriers_[column_model].state.get())(3 * row, 3 * column) += block;
  }
}

SReal RaycontactForceField::getPotentialEnergy(const MechanicalParams*) const {
  return static_cast<SReal>(response_.getPotentialEnergy());
}

void RaycontactForceField::draw(const sofa::core::visual::VisualParams* params) {
  if (!isComponentStateValid() || !params->displayFlags().getShowInteractionForceFields()) return;
  std::vector<sofa::type::Vec3> ends;
  for (std::size_t model = 0; model < std::min(carriers_.size(), response_.surfaceCount()); ++model) {
    if (!carriers_[model].moves) continue;
    const VecCoord& x = carriers_[model].state->read(sofa::core::vec_id::read_access::position)->getValue();
    for (std::size_t node = 0; node < x.size(); ++node) {
      const auto force = response_.lastForce(static_cast<raycontact::ModelId>(model), node);
      const sofa::type::Vec3 arrow(force[0], force[1], force[2]);
      if (arrow.norm2() == 0) continue;
      ends.push_back(x[node]);
      ends.push_back(x[node] + arrow * d_forceScale.getValue());
    }
  }
  params->drawTool()->drawLines(ends, 2, sofa::type::RGBAColor::yellow());
}

}  // namespace sofaraycontact
