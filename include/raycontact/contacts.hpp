// SPDX-License-Identifier: MIT OR Apache-2.0
/**
 * @file
 * The contacts of one detection, and the forces they make.
 */
#ifndef RAYCONTACT_CONTACTS_HPP
#define RAYCONTACT_CONTACTS_HPP

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "distributed.h"
#include "mesh.hpp"
#include "result.hpp"
#include "span.hpp"

namespace raycontact {

#ifdef RAYCONTACT_NO_EXCEPTIONS
inline namespace with_results {
#else
inline namespace with_exceptions {
#endif

/** The contacts of one detection; owns an rayc_contacts, which says what threads may do with it. Moves, does not copy.
 */
class Contacts {
 public:
#ifndef RAYCONTACT_NO_EXCEPTIONS
  /** As create(). */
  Contacts() : Contacts(create()) {}
#endif

  /** None yet. */
  static Outcome<Contacts> create() {
    rayc_contacts* contacts = nullptr;
    rayc_status status = detail::check_abi();
    if (status == RAYC_STATUS_OK) status = rayc_contacts_create(&contacts);
    return detail::outcome(status, Contacts(contacts));
  }

  /** How many there are. */
  Outcome<std::size_t> size() const {
    std::size_t count = 0;
    const rayc_status status = rayc_contacts_count(get(), &count);
    return detail::outcome(status, count);
  }

  /** Replaces what `contacts` held; its memory is used again. */
  Outcome<void> copy_to(std::vector<rayc_contact>& contacts) const {
    std::size_t count = 0;
    rayc_status status = rayc_contacts_count(get(), &count);
    contacts.resize(count);
    if (status == RAYC_STATUS_OK) status = rayc_contacts_copy(get(), 0, count, contacts.data());
    return check(status);
  }

  /** The spring coefficient of each contact in N/m, by the library's own law: rayc_contacts_copy_coefficients(). */
  Outcome<void> copy_coefficients_to(const rayc_response_options& options, std::vector<double>& coefficients) const {
    std::size_t count = 0;
    rayc_status status = rayc_contacts_count(get(), &count);
    coefficients.resize(count);
    if (status == RAYC_STATUS_OK)
      status = rayc_contacts_copy_coefficients(get(), &options, 0, count, coefficients.data());
    return check(status);
  }

  /** How each escaping pair is pushed as a whole; replaces what `pushes` held. */
  Outcome<void> copy_escape_pushes_to(std::vector<rayc_escape_push>& pushes) const {
    std::size_t count = 0;
    rayc_status status = rayc_contacts_escape_push_count(get(), &count);
    pushes.resize(count);
    if (status == RAYC_STATUS_OK)
      status = rayc_contacts_copy_escape_pushes(get(), 0, count, sizeof(rayc_escape_push), pushes.data());
    return check(status);
  }

  /** What the detection did. */
  Outcome<rayc_statistics> statistics() const {
    rayc_statistics statistics{};
    const rayc_status status = rayc_contacts_statistics(get(), sizeof statistics, &statistics);
    return detail::outcome(status, statistics);
  }

  /**
   * Adds the forces at the positions of detection, without damping or friction: rayc_contacts_add_forces(). One array for
   * each body, in the order of their numbers. The options' damping_time and friction must be 0.
   */
  Outcome<void> add_forces(const rayc_response_options& options, Span<const rayc_vectors_mut> forces) const {
    return check(rayc_contacts_add_forces(get(), &options, forces.size(), nullptr, nullptr, forces.data()));
  }

  /** The same at other positions and with velocities; an empty span stands for none. */
  Outcome<void> add_forces(const rayc_response_options& options, Span<const rayc_vectors> positions,
                           Span<const rayc_vectors> velocities, Span<const rayc_vectors_mut> forces) const {
    for (const Span<const rayc_vectors>& given : {positions, velocities})
      if (given.size() != 0 && given.size() != forces.size()) return wrong_count(given.size(), forces.size());
    return check(
        rayc_contacts_add_forces(get(), &options, forces.size(), given(positions), given(velocities), forces.data()));
  }

  /**
   * Adds force and torque on each rigid body, six numbers for each in the order of their numbers:
   * rayc_contacts_add_wrenches(). `points`: three numbers for each; `velocities`: six, linear and angular.
   */
  Outcome<void> add_wrenches(const rayc_response_options& options, Span<const double> points,
                             Span<const double> velocities, Span<double> wrenches) const {
    const std::size_t bodies = points.size() / 3;
    for (const std::size_t given : {2 * points.size(), velocities.size(), wrenches.size()})
      if (given != 6 * bodies) return wrong_count(given, bodies);
    return check(rayc_contacts_add_wrenches(get(), &options, bodies, points.data(), velocities.data(), wrenches.data()));
  }

  /**
   * The forces summed pair by pair, at the positions of detection: rayc_contacts_sum_pair_forces(). Replaces what
   * `pairs` and `forces` held. `velocities`: one array for each body; an empty span stands for none.
   */
  Outcome<void> sum_pair_forces_to(const rayc_response_options& options, std::vector<rayc_pair_forces>& pairs,
                                   std::vector<rayc_vertex_force>& forces, Span<const rayc_vectors> velocities = {}) {
    std::size_t pair_count = 0, force_count = 0;
    rayc_status status = rayc_contacts_sum_pair_forces(get(), &options, velocities.size(), nullptr, given(velocities),
                                                       &pair_count, &force_count);
    pairs.resize(pair_count);
    forces.resize(force_count);
    if (status == RAYC_STATUS_OK)
      status = rayc_contacts_copy_pair_forces(get(), pair_count, pairs.data(), force_count, forces.data());
    return check(status);
  }

  /**
   * Adds stiffness_factor * (df/dx) d + damping_factor * (df/dv) d for the displacements d:
   * rayc_contacts_add_differential().
   */
  Outcome<void> add_differential(const rayc_response_options& options, double stiffness_factor, double damping_factor,
                                 Span<const rayc_vectors> displacements, Span<const rayc_vectors_mut> forces) const {
    if (displacements.size() != forces.size()) return wrong_count(displacements.size(), forces.size());
    return check(rayc_contacts_add_differential(get(), &options, stiffness_factor, damping_factor, forces.size(),
                                                displacements.data(), forces.data()));
  }

  /** The energy in J, at these positions or, where the span is empty, at those of detection: rayc_contacts_energy(). */
  Outcome<double> energy(const rayc_response_options& options, std::size_t body_count,
                         Span<const rayc_vectors> positions = {}) const {
    double joules = 0;
    if (positions.size() != 0 && positions.size() != body_count)
      return detail::failure<double>(count_error(positions.size(), body_count));
    const rayc_status status = rayc_contacts_energy(get(), &options, body_count, given(positions), &joules);
    return detail::outcome(status, joules);
  }

  /** For raycontact.h; stays this object's. NULL after a move. */
  rayc_contacts* get() const noexcept { return handle_.get(); }

 private:
  explicit Contacts(rayc_contacts* contacts) : handle_(contacts) {}

  friend class Scene;

  static const rayc_vectors* given(Span<const rayc_vectors> arrays) {
    return arrays.size() == 0 ? nullptr : arrays.data();
  }
  static Error count_error(std::size_t given, std::size_t bodies) {
    return Error(RAYC_STATUS_WRONG_COUNT, std::to_string(given) + " arrays were given for " + std::to_string(bodies) +
                                              " bodies; give one for each");
  }
  static Outcome<void> wrong_count(std::size_t given, std::size_t bodies) {
    return detail::failure<void>(count_error(given, bodies));
  }

  detail::Owner<rayc_contacts, rayc_contacts_destroy> handle_;
};

/** Finds the contacts between two meshes, bodies 0 and 1: rayc_query_pair(). Octrees must be up to date. */
inline Outcome<void> query_pair(const Mesh& a, const Octree& octree_a, const Mesh& b, const Octree& octree_b,
                                Contacts& contacts,
                                const rayc_detection_options& options = default_detection_options()) {
  return check(rayc_query_pair(&options, a.get(), octree_a.get(), b.get(), octree_b.get(), contacts.get()));
}

/** Finds the contacts of a mesh with itself: rayc_query_self(). The octree must be up to date. */
inline Outcome<void> query_self(const Mesh& mesh, const Octree& octree, Contacts& contacts,
                                const rayc_detection_options& options = default_detection_options()) {
  return check(rayc_query_self(&options, mesh.get(), octree.get(), contacts.get()));
}

}  // inline namespace
}  // namespace raycontact

#endif  // RAYCONTACT_CONTACTS_HPP
