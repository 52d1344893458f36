// SPDX-License-Identifier: MIT OR Apache-2.0
/** A scene whose bodies are spread over the ranks of a communicator. */
#ifndef RAYCONTACT_MPI_DISTRIBUTED_SCENE_HPP
#define RAYCONTACT_MPI_DISTRIBUTED_SCENE_HPP

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "raycontact/mpi/migration.hpp"
#include "raycontact/mpi/partition.hpp"
#include "raycontact/mpi/scene_state.hpp"

namespace raycontact {

class DistributedContactSystem;

/**
 * Contacts and forces of one scene whose bodies are spread over the ranks of a communicator: the same, to the bit, as a
 * Scene with the same keys that sums forces pair by pair (rayc_contacts_sum_pair_forces()), for any number of ranks
 * and wherever the bodies are.
 *
 * Keys are the host's, any numbers that differ from body to body; they stand for the bodies in all calls, and decide
 * every order. Calls are of two kinds. Those of one rank, about its own bodies, never fail: what is wrong is noted,
 * changes nothing, and is said by the next collective call. Collective calls, so marked, are made by all ranks in the
 * same order. What goes wrong on one rank they say on all, with the same status and message, which begins with the
 * rank. Moves, does not copy. The communicator is duplicated; the scene must end before MPI_Finalize.
 */
class DistributedScene {
 public:
#ifndef RAYCONTACT_NO_EXCEPTIONS
  /** As create(). */
  explicit DistributedScene(MPI_Comm comm, const DistributedOptions& options = DistributedOptions())
      : DistributedScene(create(comm, options)) {}
#endif

  /**
   * Collective: an empty scene. A communicator of one rank is fine, and costs what a Scene does.
   *
   * Errors: RAYC_STATUS_INVALID_COMMUNICATOR, on the ranks concerned; RAYC_STATUS_RANKS_DISAGREE where options differ;
   * those of rayc_scene_create(), rayc_scene_set_detection_options() and rayc_contacts_sum_pair_forces().
   */
  static Outcome<DistributedScene> create(MPI_Comm comm, const DistributedOptions& options = DistributedOptions()) {
    mpi_detail::Fault fault = mpi_detail::Communicator::refusal(comm);
    if (fault) return detail::failure<DistributedScene>(error(fault));
    std::unique_ptr<State> state(new State(comm, options));
    rayc_scene* scene = nullptr;
    rayc_contacts* contacts = nullptr;
    fault.check(detail::check_abi(), "headers");
    if (!fault) fault.check(rayc_scene_create(&options.scene, &scene), "scene options");
    state->bodies.scene.reset(scene);
    if (!fault) fault.check(rayc_contacts_create(&contacts), "contacts");
    state->bodies.contacts.reset(contacts);
    if (!fault) fault.check(rayc_scene_set_detection_options(scene, &options.detection), "detection options");
    std::size_t counts[2];
    if (!fault)
      fault.check(
          rayc_contacts_sum_pair_forces(contacts, &options.response, 0, nullptr, nullptr, &counts[0], &counts[1]),
          "response options");
    fault = state->comm.agree(fault);
    if (!fault) fault = mpi_detail::compare(state->comm, options);
    if (fault) return detail::failure<DistributedScene>(error(fault));
    return DistributedScene(std::move(state));
  }

  /**
   * Adds a body of this rank's at the mesh's present positions, without velocities. Noted: RAYC_STATUS_KEY_TAKEN, and
   * the errors of rayc_scene_add_mesh(). The next step() says RAYC_STATUS_BODY_ON_TWO_RANKS where another rank has the
   * key; such bodies are then as before they were added. RAYC_STATUS_OTHER_MESH where the key was another mesh's
   * until the step before.
   */
  void add(uint64_t key, const Mesh& mesh, bool collides_with_itself = false) {
    state_->bodies.add(key, mesh.get(), collides_with_itself);
  }

  /** Removes a body of this rank's, with what has been said of its pairs. Noted: RAYC_STATUS_UNKNOWN_BODY. */
  void remove(uint64_t key) { state_->bodies.remove(key); }

  /**
   * Switches contacts between two bodies off or on again, as rayc_scene_set_pair_collision() does. Any rank may say it,
   * of any two bodies; it counts from the next step() on, and moves with the bodies. Several ranks may say the same.
   *
   * Noted: RAYC_STATUS_INVALID_OPTION for a body and itself, RAYC_STATUS_OUT_OF_ORDER within a contact system's step.
   * The next step() says RAYC_STATUS_UNKNOWN_BODY where no rank has one of the bodies, RAYC_STATUS_RANKS_DISAGREE where
   * ranks have said different things of a pair; then nothing counts that any rank has said of pairs since the step
   * before.
   */
  void set_pair_collision(uint64_t first, uint64_t second, bool is_on) {
    mpi_detail::PairSetting change;
    change.said = mpi_detail::PairSetting::COLLISION;
    change.is_ignored = is_on ? 0 : 1;
    state_->bodies.set_pair(first, second, change);
  }

  /** The same: lets two bodies escape from one another, as they may by default, or forbids it, as
   * rayc_scene_allow_escape() does. */
  void allow_escape(uint64_t first, uint64_t second, bool is_allowed) {
    mpi_detail::PairSetting change;
    change.said = mpi_detail::PairSetting::ESCAPE;
    change.is_bound = is_allowed ? 0 : 1;
    state_->bodies.set_pair(first, second, change);
  }

  /** Renews a body's positions. Noted: RAYC_STATUS_UNKNOWN_BODY, and the errors of rayc_scene_set_positions(). */
  void set_positions(uint64_t key, const rayc_vectors& positions) { state_->bodies.set_positions(key, positions); }

  /**
   * Renews a body's velocities in m/s, which count where the response has damping. Noted: RAYC_STATUS_UNKNOWN_BODY,
   * RAYC_STATUS_WRONG_COUNT, RAYC_STATUS_NULL_POINTER, RAYC_STATUS_NOT_FINITE.
   */
  void set_velocities(uint64_t key, const rayc_vectors& velocities) { state_->bodies.set_velocities(key, velocities); }

  /**
   * Collective: finds all contacts at the present positions, sums their forces, and ends a step of so many seconds, as
   * rayc_scene_query() and rayc_scene_advance() do.
   *
   * Errors: what any rank has noted; RAYC_STATUS_OUT_OF_ORDER where a DistributedContactSystem steps the scene;
   * RAYC_STATUS_INVALID_OPTION where seconds is negative or not finite,
   * RAYC_STATUS_RANKS_DISAGREE where ranks give different ones;
   * RAYC_STATUS_BODY_ON_TWO_RANKS, RAYC_STATUS_OTHER_MESH, RAYC_STATUS_MPI_FAILED, RAYC_STATUS_OUT_OF_MEMORY, and those
   * of set_pair_collision(). Forces and what pairs remember are then as before.
   */
  Outcome<void> step(double seconds) {
    mpi_detail::Fault& noted = state_->bodies.fault;
    if (state_->bodies.attachment != nullptr)
      noted.note(RAYC_STATUS_OUT_OF_ORDER, "the scene has a contact system; call that one's begin and finish");
    if (!(std::isfinite(seconds) && seconds >= 0))
      noted.note(RAYC_STATUS_INVALID_OPTION,
                 "the step is " + std::to_string(seconds) + " seconds long; give a finite number >= 0");
    mpi_detail::Fault fault = state_->step.run(seconds, state_->waiting);
    if (fault) return detail::failure<void>(error(fault));
    return check(rayc_scene_advance(state_->bodies.scene.get(), seconds));
  }

  /** The forces of the last step on an own body, in N: x, y, z of each vertex. Empty where this rank does not have it.
   */
  Span<const double> forces(uint64_t key) const { return vectors_of(key, &mpi_detail::Own::forces); }

  /** The positions of an own body: x, y, z of each vertex. Empty where this rank does not have it. */
  Span<const double> positions(uint64_t key) const { return vectors_of(key, &mpi_detail::Own::positions); }

  /** The keys of this rank's bodies, in ascending order. */
  std::vector<uint64_t> keys() const {
    std::vector<uint64_t> keys;
    for (const auto& [key, body] : state_->bodies.own) keys.push_back(key);
    return keys;
  }

  /**
   * Collective: lets bodies change ranks so that each has about as much to do, in boxes of space (Zoltan's recursive
   * coordinate bisection). A body weighs what its rays of the last step took, at the processor time that a ray has
   * taken on its rank since the last division. So bodies are not divided alike in two runs, and forces have the same
   * bits all the same. Not each step: it moves all that a body is.
   *
   * `pack(key)` gives the host's own state of a body that leaves, as std::vector<unsigned char>; `unpack(key, bytes)`
   * is given it on the new rank. Neither may throw or call the scene.
   *
   * Errors: what any rank has noted, and RAYC_STATUS_MPI_FAILED; then no body has moved. RAYC_STATUS_OUT_OF_MEMORY.
   */
  template <class Pack, class Unpack>
  Outcome<void> rebalance(Pack pack, Unpack unpack) {
    mpi_detail::Bodies& bodies = state_->bodies;
    std::vector<mpi_detail::Weighed> weighed;
    double last_cost = 0;
    for (auto& [key, body] : bodies.own) {
      rayc_body_state state{};
      bodies.fault.check(rayc_scene_body_state(bodies.scene.get(), body.number, sizeof state, &state),
                         "cost of a body");
      // A body that came after the last step has cost nothing here yet.
      if (state.cost > 0) body.cost = state.cost;
      last_cost += state.cost;
      mpi_detail::Weighed of_body;
      for (std::size_t axis = 0; axis < 3; ++axis) of_body.centre[axis] = (state.lower[axis] + state.upper[axis]) / 2;
      of_body.cost = body.cost > 0 ? body.cost : 1;
      weighed.push_back(of_body);
    }
    const double rate = state_->step.seconds_per_cost(last_cost);
    for (mpi_detail::Weighed& of_body : weighed) of_body.cost *= rate;
    const std::vector<int> owners = mpi_detail::Partition::of(state_->comm, weighed, bodies.fault);
    return migrate(owners, std::move(pack), std::move(unpack));
  }

  /**
   * Collective: the same to ranks of the host's choice, one for each of this rank's keys() in their order.
   *
   * Errors: as there; RAYC_STATUS_WRONG_COUNT, and RAYC_STATUS_UNKNOWN_RANK for a rank that there is not.
   */
  template <class Pack, class Unpack>
  Outcome<void> migrate(const std::vector<int>& owners, Pack pack, Unpack unpack) {
    mpi_detail::Migration migration(state_->comm, state_->bodies, state_->step, state_->waiting);
    const mpi_detail::Fault fault = migration.run(owners, pack, unpack);
    if (fault) return detail::failure<void>(error(fault));
    return Outcome<void>();
  }

  /** What the last step's detection did on this rank. */
  Outcome<rayc_statistics> own_statistics() const {
    rayc_statistics statistics{};
    const rayc_status status = rayc_contacts_statistics(state_->bodies.contacts.get(), sizeof statistics, &statistics);
    return detail::outcome(status, statistics);
  }

  /** Collective: the same of all ranks together, of the two errors the largest. */
  Outcome<rayc_statistics> statistics() const {
    rayc_statistics statistics{};
    mpi_detail::Fault fault;
    fault.check(rayc_contacts_statistics(state_->bodies.contacts.get(), sizeof statistics, &statistics), "statistics");
    fault = state_->comm.agree(fault);
    if (fault) return detail::failure<rayc_statistics>(error(fault));
    constexpr size_t counts = offsetof(rayc_statistics, error_asked);
    static_assert(sizeof statistics == counts + 2 * sizeof(double), "two errors follow the counts");
    MPI_Allreduce(MPI_IN_PLACE, &statistics, counts / sizeof(uint64_t), MPI_UINT64_T, MPI_SUM, state_->comm.get());
    MPI_Allreduce(MPI_IN_PLACE, &statistics.error_asked, 2, MPI_DOUBLE, MPI_MAX, state_->comm.get());
    return statistics;
  }

  /** What the exchange has taken on this rank. */
  const Traffic& traffic() const { return state_->traffic; }

 private:
  friend class DistributedContactSystem;

  using State = mpi_detail::SceneState;

  explicit DistributedScene(std::unique_ptr<State> state) : state_(std::move(state)) {}

  static Error error(const mpi_detail::Fault& fault) { return mpi_detail::error(fault); }

  Span<const double> vectors_of(uint64_t key, std::vector<double> mpi_detail::Own::*of_body) const {
    const auto found = state_->bodies.own.find(key);
    if (found == state_->bodies.own.end()) return Span<const double>();
    return Span<const double>((found->second.*of_body).data(), (found->second.*of_body).size());
  }

  std::unique_ptr<State> state_;
};

}  // namespace raycontact

#endif  // RAYCONTACT_MPI_DISTRIBUTED_SCENE_HPP
