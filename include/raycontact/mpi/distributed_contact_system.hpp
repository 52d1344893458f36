// SPDX-License-Identifier: MIT OR Apache-2.0
/** The contact system of a scene whose bodies are spread over the ranks of a communicator. */
#ifndef RAYCONTACT_MPI_DISTRIBUTED_CONTACT_SYSTEM_HPP
#define RAYCONTACT_MPI_DISTRIBUTED_CONTACT_SYSTEM_HPP

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <ctime>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "raycontact/mpi/distributed_scene.hpp"
#include "raycontact/mpi/fixed_sum.hpp"
#include "raycontact/mpi/part_sums.hpp"

namespace raycontact {

/**
 * A step's contact on the unknowns of a simulator whose bodies are spread over ranks: ContactSystem with rigid bodies'
 * unknowns kept, over a DistributedScene. Forces and products have the same bits for any number of ranks and wherever
 * bodies are: those of a ContactSystem whose parts (rayc_contact_system_part_count()) are added for each body in the
 * order of the other bodies' keys, and those of half-spaces last.
 *
 * Vectors hold this rank's bodies one after the other in the order of their keys: x, y, z of each node of a deformable
 * body, six numbers of a rigid one (velocity and angular velocity, force and torque), none of a moved one. They change
 * with the bodies of the rank.
 *
 * Calls of one rank and collective ones are as in DistributedScene. The scene is stepped by begin() and finish() from
 * now on, its step() is refused; rebalance() and migrate() take with a body what carries it and what friction holds on
 * to. The scene must outlive the system. Left to a single process: detect_again(), materials of single pairs, energy,
 * blocks, explicit steps.
 */
class DistributedContactSystem {
 public:
#ifndef RAYCONTACT_NO_EXCEPTIONS
  /** As create(). */
  explicit DistributedContactSystem(DistributedScene& scene) : DistributedContactSystem(create(scene)) {}
#endif

  /** Collective: a system without bodies. RAYC_STATUS_OUT_OF_ORDER where the scene has one. */
  static Outcome<DistributedContactSystem> create(DistributedScene& scene) {
    mpi_detail::Fault fault;
    rayc_contact_system_options options = default_contact_system_options();
    options.precision = scene.state_->options.scene.precision;
    options.keeps_rigid_unknowns = 1;
    rayc_contact_system* system = nullptr;
    if (scene.state_->bodies.attachment != nullptr)
      fault.note(RAYC_STATUS_OUT_OF_ORDER, "the scene has a contact system; use that, or end it first");
    else
      fault.check(rayc_contact_system_create(&options, &system), "contact system");
    std::unique_ptr<State> state(new State(*scene.state_, mpi_detail::SystemOwner(system)));
    // Ghosts of the scene's own steps are unknown to the system; their pairs remember all the same.
    std::vector<mpi_detail::KeyedMemory> memories;
    if (!fault) scene.state_->step.copy_memories(memories, fault);
    fault = scene.state_->comm.agree(fault);
    if (fault) return detail::failure<DistributedContactSystem>(error(fault));
    scene.state_->step.drop_ghosts();
    scene.state_->waiting.insert(scene.state_->waiting.end(), memories.begin(), memories.end());
    scene.state_->bodies.attachment = &state->bodies;
    return DistributedContactSystem(std::move(state));
  }

  /** Body `key` of this rank's, whose vertices are its nodes, with their masses in kg. Noted: the errors of
   * rayc_contact_system_add_deformable(). */
  void add_deformable(uint64_t key, Span<const double> masses, const rayc_material& material) {
    mpi_detail::Carried body;
    body.kind = mpi_detail::Carried::DEFORMABLE;
    body.masses.assign(masses.begin(), masses.end());
    add(key, std::move(body), material);
  }

  /** The same with a surface that the nodes carry by weights. */
  void add_deformable(uint64_t key, Span<const double> masses, const Carriers& carriers,
                      const rayc_material& material) {
    mpi_detail::Carried body;
    body.kind = mpi_detail::Carried::DEFORMABLE;
    body.masses.assign(masses.begin(), masses.end());
    body.offsets.assign(carriers.offsets.begin(), carriers.offsets.end());
    body.entries.assign(carriers.nodes.begin(), carriers.nodes.end());
    body.weights.assign(carriers.weights.begin(), carriers.weights.end());
    add(key, std::move(body), material);
  }

  /** A rigid body, as rayc_contact_system_add_rigid() says. */
  void add_rigid(uint64_t key, double mass, const std::array<double, 9>& inertia, const rayc_material& material) {
    mpi_detail::Carried body;
    body.kind = mpi_detail::Carried::RIGID;
    body.mass = mass;
    body.inertia = inertia;
    add(key, std::move(body), material);
  }

  /** A body that stands still or that the host moves. */
  void add_moved(uint64_t key, const rayc_material& material) { add(key, mpi_detail::Carried(), material); }

  /** Solid where normal . x < offset. All ranks add the same in the same order; begin() says
   * RAYC_STATUS_RANKS_DISAGREE where they have not. */
  void add_half_space(const std::array<double, 3>& normal, double offset, const rayc_material& material) {
    State& state = *state_;
    if (state.bodies_fault().check(
            rayc_contact_system_add_half_space(state.bodies.system(), normal.data(), offset, &material), "half-space"))
      state.bodies.note_half_space(normal.data(), offset, material);
  }

  /** Where a rigid or moved body of this rank's is, and how it moves; before each step. */
  void set_motion(uint64_t key, const rayc_motion& motion) {
    state_->bodies.set_motion(key, motion, state_->bodies_fault());
  }

  /** How many numbers this rank's vectors have. */
  std::size_t unknown_count() const {
    std::size_t count = 0;
    for (const auto& [key, body] : state_->bodies.bodies()) count += body.is_own ? body.unknown_count() : 0;
    return count;
  }

  /**
   * Collective: begins a step of dt seconds, as rayc_contact_system_begin(). The numbers of rigid bodies in the three
   * vectors do not count; set_motion() has said them.
   *
   * Errors: what any rank has noted; RAYC_STATUS_UNKNOWN_BODY where it has not been said what carries a body,
   * RAYC_STATUS_OUT_OF_ORDER within a step, and those of DistributedScene::step() and rayc_contact_system_begin().
   */
  Outcome<void> begin(double dt, Span<const double> positions, Span<const double> velocities,
                      Span<const double> free_velocities) {
    State& state = *state_;
    mpi_detail::Bodies& scene = state.scene.bodies;
    mpi_detail::Fault& noted = scene.fault;
    if (!(std::isfinite(dt) && dt > 0))
      noted.note(RAYC_STATUS_INVALID_STEP,
                 "the step is " + std::to_string(dt) + " seconds long; give a finite number above 0");
    if (state.bodies.is_busy) noted.note(RAYC_STATUS_OUT_OF_ORDER, "a step is under way; finish it first");
    for (const auto& [key, body] : scene.own)
      if (state.bodies.bodies().count(key) == 0)
        noted.note(RAYC_STATUS_UNKNOWN_BODY, "body of key " + std::to_string(key) + ": say first what carries it");
    if (!noted) {
      const Span<const double> given[] = {positions, velocities, free_velocities};
      const char* const names[] = {"positions", "velocities", "free_velocities"};
      for (std::size_t k = 0; k < 3; ++k)
        if (state.check(given[k], names[k], noted)) state.copy_nodes(given[k], state.bodies.nodes[k]);
    }
    state.bodies.settle(noted);
    if (!noted)
      noted.check(rayc_contact_system_look_ahead(state.bodies.system(), scene.scene.get(), dt,
                                                 3 * state.bodies.node_count(), state.bodies.nodes[0].data(),
                                                 state.bodies.nodes[1].data(), state.bodies.nodes[2].data()),
                  "where bodies will be");
    mpi_detail::Fault fault = state.scene.step.meet(dt, state.scene.waiting);
    if (fault) return detail::failure<void>(error(fault));
    state.bodies.settle(fault);
    state.bodies.put_memories(fault);
    const std::clock_t processor = std::clock();
    if (!fault)
      fault.check(rayc_contact_system_begin(state.bodies.system(), scene.scene.get(), dt, 3 * state.bodies.node_count(),
                                            state.bodies.nodes[0].data(), state.bodies.nodes[1].data(),
                                            state.bodies.nodes[2].data()),
                  "begin");
    state.scene.step.count_query(std::clock() - processor);
    state.parts.find(fault);
    fault = state.comm().agree(fault);
    state.bodies.is_busy = true;
    if (fault) {
      cancel();
      return detail::failure<void>(error(fault));
    }
    state.bodies.have_been_told();
    return Outcome<void>();
  }

  /** Collective: adds the forces on this rank's unknowns at these velocities, as rayc_contact_system_add_forces(). */
  Outcome<void> add_forces(Span<const double> velocities, Span<double> forces) {
    return add_parts(velocities, "velocities", forces, [this](const std::vector<double>& unknowns) {
      mpi_detail::PartSums& parts = state_->parts;
      return rayc_contact_system_part_forces(state_->bodies.system(), unknowns.size(), unknowns.data(),
                                             parts.block_count(), parts.values.data());
    });
  }

  /** Collective: adds factor * (-dforce/dvelocity) * change, as rayc_contact_system_add_product(). */
  Outcome<void> add_product(double factor, Span<const double> change, Span<double> result) {
    return add_parts(change, "change", result, [this, factor](const std::vector<double>& unknowns) {
      mpi_detail::PartSums& parts = state_->parts;
      return rayc_contact_system_part_products(state_->bodies.system(), factor, unknowns.size(), unknowns.data(),
                                               parts.block_count(), parts.values.data());
    });
  }

  /**
   * Collective: holds the rows anew, at these velocities. Gives the part of the force that had been predicted wrongly
   * on the rank where it is largest. That depends on where bodies are: where bits count, solve a fixed number of times.
   */
  Outcome<double> linearise(Span<const double> velocities) {
    State& state = *state_;
    double wrong = 0;
    mpi_detail::Fault fault = state.spread(velocities, "velocities");
    if (!fault)
      fault.check(
          rayc_contact_system_linearise(state.bodies.system(), state.unknowns.size(), state.unknowns.data(), &wrong),
          "linearise");
    fault = state.comm().agree(fault);
    if (fault) return detail::failure<double>(error(fault));
    MPI_Allreduce(MPI_IN_PLACE, &wrong, 1, MPI_DOUBLE, MPI_MAX, state.comm().get());
    return wrong;
  }

  /** Collective: ends a step whose velocities at the end are these. */
  Outcome<void> finish(Span<const double> velocities) {
    State& state = *state_;
    mpi_detail::Fault fault = state.take(velocities, "velocities");
    if (state.bodies.is_busy) state.spread_all(fault);
    fault = state.comm().agree(fault);
    if (!fault) {
      fault.check(rayc_contact_system_finish(state.bodies.system(), state.unknowns.size(), state.unknowns.data()),
                  "finish");
      fault = state.comm().agree(fault);
    }
    if (fault) return detail::failure<void>(error(fault));
    state.bodies.is_busy = false;
    state.parts.forget();
    return Outcome<void>();
  }

  /** Ends a step as if it had not begun; all ranks do. */
  void cancel() {
    static_cast<void>(rayc_contact_system_cancel(state_->bodies.system()));
    state_->parts.forget();
    state_->bodies.is_busy = false;
  }

  /**
   * Collective: the scalar product of two vectors over all ranks, with the same bits wherever bodies are: what
   * conjugate gradients need besides products. NaN where a body's part is not finite.
   */
  Outcome<double> dot(Span<const double> a, Span<const double> b) const {
    const State& state = *state_;
    std::vector<double> of_bodies;
    double numbers[2] = {0, a.size() == unknown_count() && b.size() == a.size() ? 0.0 : 1.0};
    if (numbers[1] == 0) {
      std::size_t at = 0;
      for (const auto& [key, body] : state.bodies.bodies()) {
        if (!body.is_own) continue;
        double sum = 0;
        for (const std::size_t end = at + body.unknown_count(); at < end; ++at) sum += a[at] * b[at];
        of_bodies.push_back(sum);
        numbers[0] = std::max(numbers[0], std::isfinite(sum) ? std::fabs(sum) : infinity());
      }
    }
    MPI_Allreduce(MPI_IN_PLACE, numbers, 2, MPI_DOUBLE, MPI_MAX, state.comm().get());
    if (numbers[1] != 0)
      return detail::failure<double>(Error(RAYC_STATUS_WRONG_COUNT, "a vector has not one number for each unknown"));
    mpi_detail::FixedSum sum;
    if (std::isfinite(numbers[0]))
      for (double number : of_bodies) sum.add(number, numbers[0]);
    MPI_Allreduce(MPI_IN_PLACE, sum.digits, mpi_detail::FixedSum::count, MPI_INT64_T, MPI_SUM, state.comm().get());
    return sum.value(numbers[0]);
  }

 private:
  struct State {
    State(DistributedScene::State& of_scene, mpi_detail::SystemOwner system)
        : scene(of_scene),
          bodies(of_scene.bodies, std::move(system)),
          parts(of_scene.comm, of_scene.bodies, bodies, of_scene.step, of_scene.traffic) {}
    State(const State&) = delete;
    State& operator=(const State&) = delete;
    ~State() {
      if (scene.bodies.attachment == &bodies) scene.bodies.attachment = nullptr;
    }

    const mpi_detail::Communicator& comm() const { return scene.comm; }
    mpi_detail::Fault& bodies_fault() const { return scene.bodies.fault; }

    /** Whether these are numbers for the rank's bodies. */
    bool check(Span<const double> numbers, const std::string& what, mpi_detail::Fault& fault) const {
      std::size_t expected = 0;
      for (const auto& [key, body] : bodies.bodies()) expected += body.is_own ? body.unknown_count() : 0;
      if (numbers.size() != expected) {
        fault.note(RAYC_STATUS_WRONG_COUNT, what + " has " + std::to_string(numbers.size()) + " numbers; give " +
                                                std::to_string(expected) + " for this rank's bodies");
        return false;
      }
      for (std::size_t i = 0; i < expected; ++i)
        if (!std::isfinite(numbers[i])) {
          fault.note(RAYC_STATUS_NOT_FINITE, what + "[" + std::to_string(i) + "] is NaN or infinite");
          return false;
        }
      return true;
    }

    void copy_nodes(Span<const double> numbers, std::vector<double>& field) const {
      std::size_t at = 0;
      for (const auto& [key, body] : bodies.bodies()) {
        if (!body.is_own) continue;
        if (body.kind == mpi_detail::Carried::DEFORMABLE)
          std::copy_n(numbers.begin() + at, body.unknown_count(), field.begin() + std::ptrdiff_t(3 * body.first_node));
        at += body.unknown_count();
      }
    }

    /** Into the rank's unknowns. */
    mpi_detail::Fault take(Span<const double> numbers, const char* what) {
      mpi_detail::Fault fault;
      if (!bodies.is_busy) fault.note(RAYC_STATUS_OUT_OF_ORDER, "no step is under way; begin one first");
      unknowns.resize(bodies.unknown_count());
      if (fault || !check(numbers, what, fault)) return fault;
      std::size_t at = 0;
      starts.clear();
      for (const auto& [key, body] : bodies.bodies()) {
        if (!body.is_own) continue;
        const std::size_t start = bodies.start(key);
        starts[key] = std::ptrdiff_t(at) - std::ptrdiff_t(start);
        std::copy_n(numbers.begin() + at, body.unknown_count(), unknowns.begin() + std::ptrdiff_t(start));
        at += body.unknown_count();
      }
      return fault;
    }

    mpi_detail::Fault spread(Span<const double> numbers, const char* what) {
      mpi_detail::Fault fault = take(numbers, what);
      parts.spread(unknowns, fault);
      return fault;
    }

    /** All of each ghost: friction holds on to points that no row need have moved. */
    void spread_all(mpi_detail::Fault& fault) {
      const mpi_detail::Step& step = scene.step;
      std::vector<mpi_detail::Bytes> messages;
      for (const auto& [rank, keys] : step.lent()) {
        mpi_detail::Bytes message;
        for (uint64_t key : keys)
          mpi_detail::write(message, unknowns.data() + bodies.start(key), bodies.bodies().at(key).unknown_count());
        scene.traffic.product_bytes += message.size();
        messages.push_back(std::move(message));
      }
      const std::vector<int> from = mpi_detail::ranks(step.borrowed());
      const std::vector<mpi_detail::Bytes> received =
          comm().swap(mpi_detail::ranks(step.lent()), messages, from, mpi_detail::TAG_PARTS, fault);
      for (std::size_t i = 0; i < from.size(); ++i) {
        mpi_detail::Reader reader(received[i]);
        for (uint64_t key : step.borrowed().at(from[i]))
          reader.read(unknowns.data() + bodies.start(key), bodies.bodies().at(key).unknown_count());
      }
    }

    DistributedScene::State& scene;
    mpi_detail::CarriedBodies bodies;
    mpi_detail::PartSums parts;
    std::vector<double> unknowns;               // of own bodies and ghosts, as the rank's system has them
    std::map<uint64_t, std::ptrdiff_t> starts;  // from there to the host's vectors
  };

  explicit DistributedContactSystem(std::unique_ptr<State> state) : state_(std::move(state)) {}

  static double infinity() { return std::numeric_limits<double>::infinity(); }

  static Error error(const mpi_detail::Fault& fault) {
    return Error(static_cast<rayc_status>(fault.status), fault.message);
  }

  void add(uint64_t key, mpi_detail::Carried body, const rayc_material& material) {
    mpi_detail::Bodies& scene = state_->scene.bodies;
    mpi_detail::Own* own = scene.find(key);
    if (own == nullptr) return;
    body.number = own->number;
    body.material = material;
    state_->bodies.add(key, std::move(body), scene.fault);
  }

  template <class Compute>
  Outcome<void> add_parts(Span<const double> numbers, const char* what, Span<double> sums, Compute compute) {
    State& state = *state_;
    mpi_detail::Fault fault = state.spread(numbers, what);
    if (sums.size() != numbers.size())
      fault.note(RAYC_STATUS_WRONG_COUNT, "the vector to be added to and the other are not equally long");
    if (!fault) fault.check(compute(state.unknowns), what);
    state.parts.collect(fault);
    fault = state.comm().agree(fault);
    if (fault) return detail::failure<void>(error(fault));
    state.parts.add([&](uint64_t key, std::size_t unknown) -> double& {
      return sums[static_cast<std::size_t>(std::ptrdiff_t(unknown) + state.starts.at(key))];
    });
    return Outcome<void>();
  }

  std::unique_ptr<State> state_;
};

}  // namespace raycontact

#endif  // RAYCONTACT_MPI_DISTRIBUTED_CONTACT_SYSTEM_HPP
