// SPDX-License-Identifier: MIT OR Apache-2.0
/** Contacts looked for again within a step, where bodies end by the velocities found so far. */
#ifndef RAYCONTACT_MPI_SECOND_LOOK_HPP
#define RAYCONTACT_MPI_SECOND_LOOK_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "raycontact/mpi/system_state.hpp"

namespace raycontact::mpi_detail {

/** Collective: whether bodies of any rank end farther from where contacts were sought than the smallest depth cap. */
inline bool end_elsewhere(SystemState& state, Fault& fault) {
  // The largest squares of nodes and rigid bodies, the smallest cap turned around, and whether any node can move.
  double numbers[4] = {0, 0, -std::numeric_limits<double>::infinity(), 0};
  if (!fault)
    fault.check(rayc_contact_system_off_course(state.system(), state.in_scene(), state.unknowns.size(),
                                               state.unknowns.data(), &numbers[0], &numbers[1]),
                "velocities");
  for (const auto& [key, body] : state.bodies.bodies()) {
    if (!body.is_own) continue;
    numbers[2] = std::max(numbers[2], -body.material.depth_cap);
    for (double mass : body.masses) numbers[3] = std::max(numbers[3], std::isfinite(mass) ? 1.0 : 0.0);
  }
  fault = state.comm().agree(fault);
  if (fault) return false;
  MPI_Allreduce(MPI_IN_PLACE, numbers, 4, MPI_DOUBLE, MPI_MAX, state.comm().get());
  const double cap = -numbers[2] / state.seconds, square = cap * cap;
  return (numbers[3] != 0 && numbers[0] > square) || numbers[1] > square;
}

/** Collective: as rayc_contact_system_detect_again() over all ranks. Faults before anything has changed leave the step
 * as it is; later ones cancel it. */
inline Fault detect_again(SystemState& state, Span<const double> velocities, bool* is_more) {
  *is_more = false;
  Fault fault = state.take(velocities, "velocities");
  fault.take(state.bodies_fault());
  if (!end_elsewhere(state, fault)) return fault;
  state.copy_nodes(velocities, state.bodies.nodes[2]);
  state.bodies.keep_ends(state.unknowns);
  state.bodies_fault().check(
      rayc_contact_system_look_again(state.system(), state.in_scene(), state.unknowns.size(), state.unknowns.data()),
      "where bodies end");
  fault = state.scene.step.meet_again(state.seconds);
  if (fault) {
    state.give_up();
    return fault;
  }
  state.bodies.settle(fault);
  state.bodies.grips().put(fault);
  state.fill_unknowns(state.bodies.nodes[2], [](const Carried& body) { return body.end.data(); });
  const auto& nodes = state.bodies.nodes;
  uint32_t has_more = 0;
  state.detect(fault, "detection", [&] {
    return rayc_contact_system_detect_among(state.system(), state.in_scene(), nodes[0].size(), nodes[0].data(),
                                            nodes[1].data(), state.unknowns.size(), state.unknowns.data(), &has_more);
  });
  state.parts.find(fault);
  // A fault counts as more, and is told once all ranks have seen that there is something to tell.
  int news = fault ? 2 : has_more != 0 ? 1 : 0;
  MPI_Allreduce(MPI_IN_PLACE, &news, 1, MPI_INT, MPI_MAX, state.comm().get());
  if (news == 0) return fault;
  double wrong = 0;
  if (!fault)
    fault.check(rayc_contact_system_linearise(state.system(), state.unknowns.size(), state.unknowns.data(), &wrong),
                "rows");
  fault = state.comm().agree(fault);
  if (fault) state.give_up();
  *is_more = !fault;
  return fault;
}

}  // namespace raycontact::mpi_detail

#endif  // RAYCONTACT_MPI_SECOND_LOOK_HPP
