// SPDX-License-Identifier: MIT OR Apache-2.0
/** What a distributed contact system is made of, and its step. */
#ifndef RAYCONTACT_MPI_SYSTEM_STATE_HPP
#define RAYCONTACT_MPI_SYSTEM_STATE_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <ctime>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "raycontact/mpi/fixed_sum.hpp"
#include "raycontact/mpi/part_sums.hpp"
#include "raycontact/mpi/scene_state.hpp"

namespace raycontact::mpi_detail {

struct SystemState {
  SystemState(SceneState& of_scene, SystemOwner system)
      : scene(of_scene),
        bodies(of_scene.bodies, std::move(system)),
        parts(of_scene.comm, of_scene.bodies, bodies, of_scene.step, of_scene.traffic) {}
  SystemState(const SystemState&) = delete;
  SystemState& operator=(const SystemState&) = delete;
  ~SystemState() {
    if (scene.bodies.attachment == &bodies) scene.bodies.attachment = nullptr;
  }

  const Communicator& comm() const { return scene.comm; }
  Fault& bodies_fault() const { return scene.bodies.fault; }
  rayc_contact_system* system() const { return bodies.system(); }
  rayc_scene* in_scene() const { return scene.bodies.scene.get(); }

  std::size_t own_count() const {
    std::size_t count = 0;
    for (const auto& [key, body] : bodies.bodies()) count += body.is_own ? body.unknown_count() : 0;
    return count;
  }

  /** Whether these are numbers for the rank's bodies. */
  bool check(Span<const double> numbers, const std::string& what, Fault& fault) const {
    const std::size_t expected = own_count();
    if (numbers.size() != expected) {
      fault.note(RAYC_STATUS_WRONG_COUNT, what + " has " + std::to_string(numbers.size()) + " numbers; give " +
                                              std::to_string(expected) + ", for the bodies of this rank");
      return false;
    }
    for (std::size_t i = 0; i < numbers.size(); ++i)
      if (!std::isfinite(numbers[i])) {
        fault.note(RAYC_STATUS_NOT_FINITE, what + "[" + std::to_string(i) + "] is " + std::to_string(numbers[i]) +
                                               "; check the simulation's last step");
        return false;
      }
    return true;
  }

  /** Notes what does not let a step begin: of so many seconds, and with these numbers, which go to the nodes. */
  void check_begin(double dt, const std::vector<std::pair<const char*, Span<const double>>>& given, Fault& noted) {
    if (!(std::isfinite(dt) && dt > 0))
      noted.note(RAYC_STATUS_INVALID_STEP,
                 "the step is " + std::to_string(dt) + " seconds long; give a finite number above 0");
    if (bodies.is_busy) noted.note(RAYC_STATUS_OUT_OF_ORDER, "a step is under way; finish it first");
    for (const auto& [key, body] : scene.bodies.own)
      if (bodies.bodies().count(key) == 0)
        noted.note(RAYC_STATUS_UNKNOWN_BODY, "body of key " + std::to_string(key) + ": say first what carries it");
    for (std::size_t k = 0; k < given.size() && !noted; ++k)
      if (check(given[k].second, given[k].first, noted)) copy_nodes(given[k].second, bodies.nodes[k]);
    seconds = dt;
    bodies.settle(noted);
  }

  /** Collective: the ghosts of the step, and what their pairs remember. False where all ranks know of a fault; one of
   * this rank alone is noted. */
  bool meet(Fault& fault) {
    fault = scene.step.meet(seconds, scene.waiting);
    if (fault) return false;
    bodies.settle(fault);
    bodies.grips().put(fault);
    return true;
  }

  /** Calls the library's detection, whose time counts for the division of bodies. */
  template <class Detect>
  void detect(Fault& fault, const char* what, Detect detect) {
    const std::clock_t processor = std::clock();
    if (!fault) fault.check(detect(), what);
    scene.step.count_query(std::clock() - processor);
  }

  /** Collective: the step has begun, unless there is a fault on any rank. */
  Fault have_begun(Fault fault) {
    parts.find(fault);
    fault = comm().agree(fault);
    bodies.is_busy = true;
    if (fault)
      cancel();
    else
      bodies.have_been_told();
    return fault;
  }

  void cancel() {
    static_cast<void>(rayc_contact_system_cancel(system()));
    parts.forget();
    bodies.is_busy = false;
  }

  /** All ranks do, where ranks may have other ghosts than they know of each other. */
  void give_up() {
    Fault unheard;
    cancel();
    bodies.keep_all_memories(unheard);
    scene.step.copy_memories(scene.waiting, unheard);
    scene.step.drop_ghosts();
  }

  /** Collective: ends a step by the rank's unknowns. */
  Fault finish(Fault fault) {
    fault = comm().agree(fault);
    if (!fault) {
      fault.check(rayc_contact_system_finish(system(), unknowns.size(), unknowns.data()), "finish");
      fault = comm().agree(fault);
    }
    if (fault) return fault;
    bodies.is_busy = false;
    bodies.grips().forget();
    parts.forget();
    return fault;
  }

  /** Into the rank's unknowns. */
  Fault take(Span<const double> numbers, const char* what) {
    Fault fault;
    if (!bodies.is_busy) fault.note(RAYC_STATUS_OUT_OF_ORDER, "no step is under way; begin one first");
    unknowns.resize(bodies.unknown_count());
    if (fault || !check(numbers, what, fault)) return fault;
    find_starts();
    std::size_t at = 0;
    for (const auto& [key, body] : bodies.bodies()) {
      if (!body.is_own) continue;
      std::copy_n(numbers.begin() + at, body.unknown_count(), unknowns.begin() + std::ptrdiff_t(bodies.start(key)));
      at += body.unknown_count();
    }
    return fault;
  }

  /** The same, and the unknowns of ghosts that rows need. */
  Fault spread(Span<const double> numbers, const char* what) {
    Fault fault = take(numbers, what);
    parts.spread(unknowns, fault);
    return fault;
  }

  /** All of each ghost: friction holds on to points that no row need have moved. */
  void spread_all(Fault& fault) {
    std::vector<Bytes> messages;
    for (const auto& [rank, keys] : scene.step.lent()) {
      Bytes message;
      for (uint64_t key : keys)
        write(message, unknowns.data() + bodies.start(key), bodies.bodies().at(key).unknown_count());
      scene.traffic.product_bytes += message.size();
      messages.push_back(std::move(message));
    }
    const std::vector<int> from = ranks(scene.step.borrowed());
    const std::vector<Bytes> received = comm().swap(ranks(scene.step.lent()), messages, from, TAG_PARTS, fault);
    for (std::size_t i = 0; i < from.size(); ++i) {
      Reader reader(received[i]);
      for (uint64_t key : scene.step.borrowed().at(from[i]))
        reader.read(unknowns.data() + bodies.start(key), bodies.bodies().at(key).unknown_count());
    }
  }

  /** Into the unknowns of all bodies: a field of the nodes, and what `of_rigid` says of each rigid body. */
  template <class OfRigid>
  void fill_unknowns(const std::vector<double>& field, OfRigid of_rigid) {
    unknowns.resize(bodies.unknown_count());
    for (const auto& [key, body] : bodies.bodies()) {
      const double* from = field.data() + 3 * body.first_node;
      if (body.kind == Carried::RIGID) from = of_rigid(body);
      std::copy_n(from, body.unknown_count(), unknowns.begin() + std::ptrdiff_t(bodies.start(key)));
    }
    find_starts();
  }

  /** From numbers of nodes in the host's order to those of the rank's. */
  void copy_nodes(Span<const double> numbers, std::vector<double>& field) const {
    std::size_t at = 0;
    for (const auto& [key, body] : bodies.bodies()) {
      if (!body.is_own) continue;
      if (body.kind == Carried::DEFORMABLE)
        std::copy_n(numbers.begin() + at, body.unknown_count(), field.begin() + std::ptrdiff_t(3 * body.first_node));
      at += body.unknown_count();
    }
  }

  /** Adds what parts have collected to the host's vector. */
  void add_to(Span<double> sums) const {
    parts.add([&](uint64_t key, std::size_t unknown) -> double& {
      return sums[static_cast<std::size_t>(std::ptrdiff_t(unknown) + starts.at(key))];
    });
  }

  SceneState& scene;
  CarriedBodies bodies;
  PartSums parts;
  double seconds = 0;                         // of the step
  std::vector<double> unknowns;               // of own bodies and ghosts, as the rank's system has them
  std::map<uint64_t, std::ptrdiff_t> starts;  // from there to the host's vectors

 private:
  void find_starts() {
    starts.clear();
    std::size_t at = 0;
    for (const auto& [key, body] : bodies.bodies()) {
      if (!body.is_own) continue;
      starts[key] = std::ptrdiff_t(at) - std::ptrdiff_t(bodies.start(key));
      at += body.unknown_count();
    }
  }
};

}  // namespace raycontact::mpi_detail

#endif  // RAYCONTACT_MPI_SYSTEM_STATE_HPP
