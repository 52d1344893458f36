// SPDX-License-Identifier: MIT OR Apache-2.0
/** A whole step of a host that integrates explicitly. */
#ifndef RAYCONTACT_MPI_EXPLICIT_STEP_HPP
#define RAYCONTACT_MPI_EXPLICIT_STEP_HPP

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "raycontact/mpi/system_state.hpp"

namespace raycontact::mpi_detail {

/** Symplectic Euler is stable up to this: `largest` and `damping_time` as rayc_contact_system_largest_coupling() has
 * them. */
inline double longest_step(double largest, double damping_time) {
  if (!(largest > 0)) return std::numeric_limits<double>::infinity();
  return std::sqrt(damping_time * damping_time + 4 / largest) - damping_time;
}

/** Collective, once rows are held and parts found. */
inline double longest_step(SystemState& state, Fault& fault) {
  PartSums& parts = state.parts;
  fault.check(rayc_contact_system_part_couplings(state.system(), parts.block_count(), parts.values.data()),
              "couplings");
  parts.collect(fault, 1);
  // Only the sums of own bodies are whole; those of ghosts come from their owners.
  std::vector<double> sums(state.bodies.unknown_count() / 3);
  parts.add([&sums](uint64_t, std::size_t block) -> double& { return sums[block]; }, 1);
  parts.spread(sums, fault, 1);
  double numbers[2] = {0, 0};
  fault.check(rayc_contact_system_largest_coupling(state.system(), sums.size(), sums.data(), &numbers[0], &numbers[1]),
              "couplings");
  MPI_Allreduce(MPI_IN_PLACE, numbers, 2, MPI_DOUBLE, MPI_MAX, state.comm().get());
  return longest_step(numbers[0], numbers[1]);
}

/** Collective: as rayc_contact_system_explicit_step() over all ranks. */
inline Fault explicit_step(SystemState& state, double dt, Span<const double> positions, Span<const double> velocities,
                           Span<double> forces, double* longest) {
  Fault& noted = state.bodies_fault();
  state.check_begin(dt, {{"positions", positions}, {"velocities", velocities}, {"velocities", velocities}}, noted);
  if (forces.size() != velocities.size())
    noted.note(RAYC_STATUS_WRONG_COUNT, "forces and velocities are not equally many");
  const auto& nodes = state.bodies.nodes;
  if (!noted)
    noted.check(rayc_contact_system_look_explicit(state.system(), state.in_scene(), dt, nodes[0].size(),
                                                  nodes[0].data(), nodes[1].data()),
                "where bodies are");
  Fault fault;
  if (!state.meet(fault)) return fault;
  state.detect(fault, "begin", [&] {
    return rayc_contact_system_begin_explicit(state.system(), state.in_scene(), dt, nodes[0].size(), nodes[0].data(),
                                              nodes[1].data());
  });
  fault = state.have_begun(fault);
  if (fault) return fault;
  state.fill_unknowns(nodes[1], [](const Carried& body) { return body.motion.velocity; });
  PartSums& parts = state.parts;
  *longest = longest_step(state, fault);
  fault.check(rayc_contact_system_part_forces(state.system(), state.unknowns.size(), state.unknowns.data(),
                                              parts.block_count(), parts.values.data()),
              "forces");
  parts.collect(fault);
  fault = state.comm().agree(fault);
  if (!fault) {
    state.add_to(forces);
    fault = state.finish(fault);
  }
  if (fault) state.cancel();
  return fault;
}

}  // namespace raycontact::mpi_detail

#endif  // RAYCONTACT_MPI_EXPLICIT_STEP_HPP
