// SPDX-License-Identifier: MIT OR Apache-2.0
#include <SofaRaycontact/Carriers.h>
#include <SofaRaycontact/RaycontactForceField.h>
#include <sofa/linearalgebra/CompressedRowSparseMatrix.h>
#include <sofa/simulation/Node.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace sofaraycontact {

using sofa::core::behavior::BaseMechanicalState;
using sofa::simulation::Node;
using Jacobian = sofa::linearalgebra::CompressedRowSparseMatrix<sofa::type::Mat<3, 3, SReal>>;

namespace {

/** The only one that a state is the target of, from one other state of points. */
sofa::core::BaseMapping* mappingTo(State* skin, State*& cage) {
  const auto* node = dynamic_cast<const Node*>(skin->getContext());
  auto* mapping = node != nullptr ? node->mechanicalMapping.get() : nullptr;
  if (mapping == nullptr || !mapping->isLinear() || !mapping->areForcesMapped()) return nullptr;
  const auto from = mapping->getFrom(), to = mapping->getTo();
  if (from.size() != 1 || to.size() != 1 || to[0] != static_cast<sofa::core::BaseState*>(skin)) return nullptr;
  cage = dynamic_cast<State*>(from[0]);
  return cage != nullptr ? mapping : nullptr;
}

/** False where a block is not a weight times the unit matrix, or a vertex has no node. */
bool read(Jacobian& matrix, std::size_t vertices, raycontact::SurfaceCarriers& carriers) {
  matrix.compress();
  const auto& rows = matrix.getRowIndex();
  const auto& begins = matrix.getRowBegin();
  const auto& columns = matrix.getColsIndex();
  const auto& blocks = matrix.getColsValue();
  if (rows.size() != vertices) return false;
  carriers.offsets.assign(1, 0);
  for (std::size_t row = 0; row < rows.size(); ++row) {
    if (static_cast<std::size_t>(rows[row]) != row) return false;
    double sum = 0;
    for (auto entry = begins[row]; entry < begins[row + 1]; ++entry) {
      const double weight = blocks[entry][0][0];
      for (int k = 0; k < 9; ++k)
        if (blocks[entry][k / 3][k % 3] != (k % 4 == 0 ? blocks[entry][0][0] : SReal(0))) return false;
      if (weight == 0) continue;
      carriers.nodes.push_back(static_cast<uint32_t>(columns[entry]));
      carriers.weights.push_back(weight);
      sum += weight;
    }
    if (!(std::abs(sum - 1) < 1e-9)) return false;
    carriers.offsets.push_back(static_cast<uint32_t>(carriers.nodes.size()));
  }
  return true;
}

using States = std::set<const BaseMechanicalState*>;

/** Adds the states at and below a node that force fields other than contact act on. In every step, so without casts. */
void addPushed(const Node* node, States& pushed) {
  for (const auto* field : node->forceField)
    for (const auto* state : field->getMechanicalStates()) pushed.insert(state);
  for (const auto* field : node->interactionForceField)
    if (dynamic_cast<const RaycontactForceField*>(field) == nullptr)
      for (const auto* state : field->getMechanicalStates()) pushed.insert(state);
  for (const auto& child : node->child) addPushed(child.get(), pushed);
}

/** What is mapped from a skin may be pushed too. */
bool hasStatesBelow(const Node* node) {
  return std::any_of(node->child.begin(), node->child.end(), [](const auto& child) {
    return child->mechanicalState.get() != nullptr || hasStatesBelow(child.get());
  });
}

}  // namespace

State* cageOf(State* skin) {
  State* cage = nullptr;
  return mappingTo(skin, cage) != nullptr ? cage : nullptr;
}

Carrier plainCarrier(const Surface& surface) { return {surface.state, nullptr, {}}; }

Carrier carrierOf(const Surface& surface) {
  State* cage = nullptr;
  auto* mapping = mappingTo(surface.state.get(), cage);
  if (mapping == nullptr) return plainCarrier(surface);
  const auto* matrix = dynamic_cast<const Jacobian*>(mapping->getJ());
  Carrier carrier{cage, mapping, {}};
  // Compressing changes how the matrix is kept, not what it is.
  if (matrix == nullptr || !read(const_cast<Jacobian&>(*matrix), surface.state->getSize(), carrier.carriers))
    return plainCarrier(surface);
  const auto& nodes = carrier.carriers.nodes;
  if (nodes.empty() || *std::max_element(nodes.begin(), nodes.end()) >= cage->getSize()) return plainCarrier(surface);
  return carrier;
}

void cutOrOpen(const std::vector<Surface>& surfaces, std::vector<Carrier>& carriers) {
  States pushed;
  const Node* root = nullptr;
  for (std::size_t k = 0; k < carriers.size() && k < surfaces.size(); ++k) {
    if (carriers[k].mapping == nullptr) continue;
    const State* skin = surfaces[k].state.get();
    const auto* node = dynamic_cast<const Node*>(skin->getContext());
    if (root == nullptr) addPushed(root = dynamic_cast<const Node*>(node->getRootContext()), pushed);
    const bool cuts = pushed.count(skin) == 0 && node->mass.get() == nullptr && !hasStatesBelow(node);
    if (cuts != carriers[k].is_cut) carriers[k].mapping->setForcesMapped(!cuts);
    carriers[k].is_cut = cuts;
  }
}

void open(Carrier& carrier) {
  if (carrier.is_cut) carrier.mapping->setForcesMapped(true);
  carrier.is_cut = false;
}

}  // namespace sofaraycontact
