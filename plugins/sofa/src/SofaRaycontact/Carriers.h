// SPDX-License-Identifier: MIT OR Apache-2.0
// The nodes that carry a surface: those of the state itself, or of the cage that a linear mapping leads to.
#pragma once

#include <SofaRaycontact/RaycontactNarrowPhase.h>
#include <sofa/core/BaseMapping.h>

#include <raycontact/sofa_response.hpp>
#include <vector>

namespace sofaraycontact {

/** The state that a surface's contact forces go to. */
struct Carrier {
  State::SPtr state;
  /** From the surface's own state to `state`, where these differ. */
  sofa::core::BaseMapping::SPtr mapping;
  /** How the nodes of `state` carry the surface; without their masses. */
  raycontact::SurfaceCarriers carriers;
  /** Whether a solver moves it. */
  bool moves = false;
  /** Whether the mapping has been told that no force comes from below. */
  bool is_cut = false;
};

/** The state behind the linear mapping that leads to a skin, or NULL. */
State* cageOf(State* skin);

/** The surface's own state, as a plain carrier. */
Carrier plainCarrier(const Surface& surface);

/** The cage of a skin where its mapping is linear and its matrix can be read, else the surface's own state. */
Carrier carrierOf(const Surface& surface);

/**
 * Spares SOFA the way through the mappings, in each product with a matrix, where nothing but contact acts behind them;
 * and opens them again where something does, such as a spring of the mouse. `surfaces` may have more than `carriers`.
 */
void cutOrOpen(const std::vector<Surface>& surfaces, std::vector<Carrier>& carriers);

/** Leaves the mapping as it was found. */
void open(Carrier& carrier);

}  // namespace sofaraycontact
