// SPDX-License-Identifier: MIT OR Apache-2.0
/**
 * @file
 * Many bodies, one detection for all of them.
 */
#ifndef RAYCONTACT_SCENE_HPP
#define RAYCONTACT_SCENE_HPP

#include <cstddef>
#include <cstdint>
#include <exception>
#include <utility>
#include <vector>

#include "contacts.hpp"
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

/// @cond internal
namespace detail {

#ifndef RAYCONTACT_NO_EXCEPTIONS
/** What the host of lend_threads() has thrown in this thread's present query. */
inline thread_local std::exception_ptr thrown_by_host;
#endif

template <class Host>
void run_on(void* context, std::size_t count, rayc_task task, void* data) {
  (*static_cast<Host*>(context))(count, [task, data](std::size_t index) { task(data, index); });
}

/** No exception passes into the library. */
template <class Host>
void run_on_guarded(void* context, std::size_t count, rayc_task task, void* data) noexcept {
#ifdef RAYCONTACT_NO_EXCEPTIONS
  run_on<Host>(context, count, task, data);
#else
  try {
    run_on<Host>(context, count, task, data);
  } catch (...) {
    if (!thrown_by_host) thrown_by_host = std::current_exception();
  }
#endif
}

}  // namespace detail
/// @endcond

/**
 * Lends the host's threads to scenes made with these options. `host(count, task)` calls task(index) once for each index
 * below count and returns when all have returned, as rayc_parallel_for says; it must outlive the scenes. With oneTBB:
 *
 *     auto host = [](std::size_t count, auto task) { tbb::parallel_for(std::size_t{0}, count, task); };
 *
 * It may throw once all calls that it began have returned. The calling thread then does what is left, and
 * Scene::query() throws the first such exception at its end: the contacts are there, and the scene is as after a query
 * that threw nothing. Calls of a contact system throw none of them. With RAYCONTACT_NO_EXCEPTIONS an exception ends the process (std::terminate).
 */
template <class Host>
void lend_threads(rayc_scene_options& options, Host& host) {
  options.threads = 1;
  options.parallel_context = &host;
  options.parallel_for = detail::run_on_guarded<Host>;
}

/** Many bodies, one detection for all; owns an rayc_scene, which says what threads may do with it. Moves, does not
 * copy. */
class Scene {
 public:
#ifndef RAYCONTACT_NO_EXCEPTIONS
  /** `threads`: 1 = the caller's own, n = a pool of n, 0 = a pool of one for each core. */
  explicit Scene(uint32_t threads = 1) : Scene(create(threads)) {}
  /** As create(). */
  explicit Scene(const rayc_scene_options& options) : Scene(create(options)) {}
#endif

  /** An empty scene: rayc_scene_create(). */
  static Outcome<Scene> create(const rayc_scene_options& options) {
    rayc_scene* scene = nullptr;
    rayc_status status = detail::check_abi();
    if (status == RAYC_STATUS_OK) status = rayc_scene_create(&options, &scene);
    return detail::outcome(status, Scene(scene));
  }

  /** `threads`: 1 = the caller's own, n = a pool of n, 0 = a pool of one for each core. */
  static Outcome<Scene> create(uint32_t threads = 1) {
    rayc_scene_options options = default_scene_options();
    options.threads = threads;
    return create(options);
  }

  /** Copies the mesh; returns the body's number: rayc_scene_add_mesh() says which. */
  Outcome<uint32_t> add(const Mesh& mesh) {
    uint32_t body = 0;
    const rayc_status status = rayc_scene_add_mesh(get(), mesh.get(), &body);
    return detail::outcome(status, body);
  }

  /** The same with a key of the host's, by which orders go: rayc_scene_add_mesh_with_key(). */
  Outcome<uint32_t> add(const Mesh& mesh, uint64_t key) {
    uint32_t body = 0;
    const rayc_status status = rayc_scene_add_mesh_with_key(get(), mesh.get(), key, &body);
    return detail::outcome(status, body);
  }

  /** Says how a body is shared between scenes of several processes: rayc_scene_share_body(). */
  Outcome<void> share(uint32_t body, bool is_ghost, uint32_t neighbours = RAYC_NEIGHBOURS_COUNTED,
                      bool overlaps_itself = false) {
    return check(rayc_scene_share_body(get(), body, is_ghost, neighbours, overlaps_itself));
  }

  /** Finds contacts of bodies with themselves ahead of the query: rayc_scene_find_self_contacts(). */
  Outcome<void> find_self_contacts() { return check(rayc_scene_find_self_contacts(get())); }

  /** A body's box, what it cost, and whether it overlaps itself. */
  Outcome<rayc_body_state> body_state(uint32_t body) const {
    rayc_body_state state{};
    const rayc_status status = rayc_scene_body_state(get(), body, sizeof state, &state);
    return detail::outcome(status, state);
  }

  /** Removes a body. Its number is refused from here on, and no other body gets it before release_body_numbers(). */
  Outcome<void> remove(uint32_t body) { return check(rayc_scene_remove_body(get(), body)); }

  /** Lets the numbers of removed bodies be given to new ones: rayc_scene_release_body_numbers(). */
  Outcome<void> release_body_numbers() { return check(rayc_scene_release_body_numbers(get())); }

  /** Renews the positions of a body's vertices. */
  Outcome<void> set_positions(uint32_t body, const rayc_vectors& positions) {
    return check(rayc_scene_set_positions(get(), body, &positions));
  }

  /** Moves a body that keeps its shape, by a pose from its mesh's first positions: rayc_scene_set_pose(). */
  Outcome<void> set_pose(uint32_t body, const rayc_pose& pose) {
    return check(rayc_scene_set_pose(get(), body, &pose));
  }

  /** Switches contacts of a body with itself on or off; they have colliding = collided. Off for a new body. */
  Outcome<void> set_self_collision(uint32_t body, bool is_on) {
    return check(rayc_scene_set_self_collision(get(), body, is_on));
  }

  /** How far apart the unknowns are that move a body's vertices, m: rayc_scene_set_carrier_spacing(). */
  Outcome<void> set_carrier_spacing(uint32_t body, double spacing) {
    return check(rayc_scene_set_carrier_spacing(get(), body, spacing));
  }

  /** Switches contacts between two bodies off, or on again: rayc_scene_set_pair_collision(). */
  Outcome<void> set_pair_collision(uint32_t a, uint32_t b, bool is_on) {
    return check(rayc_scene_set_pair_collision(get(), a, b, is_on));
  }

  /** How contacts are found from the next query on. */
  Outcome<void> set_detection_options(const rayc_detection_options& options) {
    return check(rayc_scene_set_detection_options(get(), &options));
  }

  /** Where rays start, from the next query on: see `rayc_sampling`. The other options become the defaults. */
  Outcome<void> set_sampling(rayc_sampling sampling, double value = 0) {
    rayc_detection_options options = default_detection_options();
    options.sampling = sampling;
    options.sampling_value = value;
    return set_detection_options(options);
  }

  /** Finds all contacts at the present positions. Replaces what `contacts` held. Throws what lend_threads() was thrown.
   */
  Outcome<void> query(Contacts& contacts) {
#ifdef RAYCONTACT_NO_EXCEPTIONS
    return check(rayc_scene_query(get(), contacts.get()));
#else
    // A host's thread that waits may take up another query meanwhile.
    const std::exception_ptr outer = std::exchange(detail::thrown_by_host, nullptr);
    const rayc_status status = rayc_scene_query(get(), contacts.get());
    const std::exception_ptr thrown = std::exchange(detail::thrown_by_host, outer);
    check(status);
    if (thrown) std::rethrow_exception(thrown);
#endif
  }

  /** Queries, and the energy in J that bodies store where they are: rayc_scene_potential(). */
  Outcome<double> potential(const rayc_response_options& options, Contacts& contacts) {
    double joules = 0;
    const rayc_status status = rayc_scene_potential(get(), &options, contacts.get(), &joules);
    return detail::outcome(status, joules);
  }

  /** Adds what Contacts::add_differential() does, of contacts found anew: rayc_scene_add_differential(). */
  Outcome<void> add_differential(const Contacts& contacts, const rayc_response_options& options,
                                 double stiffness_factor, double damping_factor, Span<const rayc_vectors> displacements,
                                 Span<const rayc_vectors_mut> forces) const {
    if (displacements.size() != forces.size()) return Contacts::wrong_count(displacements.size(), forces.size());
    return check(rayc_scene_add_differential(get(), contacts.get(), &options, stiffness_factor, damping_factor,
                                             forces.size(), displacements.data(), forces.data()));
  }

  /** Ends a step of so many seconds, after its last query: rayc_scene_advance(). */
  Outcome<void> advance(double seconds) { return check(rayc_scene_advance(get(), seconds)); }

  /** Lets two bodies escape from one another, as they may by default, or forbids it: rayc_scene_allow_escape(). */
  Outcome<void> allow_escape(uint32_t a, uint32_t b, bool allowed) {
    return check(rayc_scene_allow_escape(get(), a, b, allowed));
  }

  /** Whether two bodies may escape from one another. */
  Outcome<bool> may_escape(uint32_t a, uint32_t b) const {
    uint32_t allowed = 0;
    const rayc_status status = rayc_scene_may_escape(get(), a, b, &allowed);
    return detail::outcome(status, allowed != 0);
  }

  /** What each pair remembers from step to step; replaces what `memories` held. */
  Outcome<void> copy_pair_memories_to(std::vector<rayc_pair_memory>& memories) const {
    std::size_t count = 0;
    rayc_status status = rayc_scene_pair_memory_count(get(), &count);
    memories.resize(count);
    if (status == RAYC_STATUS_OK)
      status = rayc_scene_copy_pair_memories(get(), 0, count, sizeof(rayc_pair_memory), memories.data());
    return check(status);
  }

  /** What the newest query took for each pair; replaces what `costs` held. */
  Outcome<void> copy_pair_costs_to(std::vector<rayc_pair_cost>& costs) const {
    std::size_t count = 0;
    rayc_status status = rayc_scene_pair_cost_count(get(), &count);
    costs.resize(count);
    if (status == RAYC_STATUS_OK)
      status = rayc_scene_copy_pair_costs(get(), 0, count, sizeof(rayc_pair_cost), costs.data());
    return check(status);
  }

  /** Replaces what one pair remembers: rayc_scene_set_pair_memory(). */
  Outcome<void> set_pair_memory(const rayc_pair_memory& memory) {
    return check(rayc_scene_set_pair_memory(get(), sizeof memory, &memory));
  }

  /** What all pairs remember as bytes, for the host's own save files: rayc_scene_save_pair_memories(). */
  Outcome<void> save_pair_memories_to(std::vector<uint8_t>& bytes) const {
    std::size_t length = 0;
    rayc_status status = rayc_scene_saved_length(get(), &length);
    bytes.resize(length);
    if (status == RAYC_STATUS_OK) status = rayc_scene_save_pair_memories(get(), length, bytes.data());
    return check(status);
  }

  /** Goes on from saved bytes: rayc_scene_restore_pair_memories(). */
  Outcome<void> restore_pair_memories(Span<const uint8_t> bytes) {
    return check(rayc_scene_restore_pair_memories(get(), bytes.size(), bytes.data()));
  }

  /** For raycontact.h; stays this object's. NULL after a move. */
  rayc_scene* get() const noexcept { return handle_.get(); }

 private:
  explicit Scene(rayc_scene* scene) : handle_(scene) {}
  detail::Owner<rayc_scene, rayc_scene_destroy> handle_;
};

}  // inline namespace
}  // namespace raycontact

#endif  // RAYCONTACT_SCENE_HPP
