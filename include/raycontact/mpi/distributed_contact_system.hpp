// SPDX-License-Identifier: MIT OR Apache-2.0
/** The contact system of a scene whose bodies are spread over the ranks of a communicator. */
#ifndef RAYCONTACT_MPI_DISTRIBUTED_CONTACT_SYSTEM_HPP
#define RAYCONTACT_MPI_DISTRIBUTED_CONTACT_SYSTEM_HPP

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "raycontact/mpi/distributed_scene.hpp"
#include "raycontact/mpi/explicit_step.hpp"
#include "raycontact/mpi/matrix_blocks.hpp"
#include "raycontact/mpi/second_look.hpp"
#include "raycontact/mpi/system_state.hpp"

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
 * to. The scene must outlive the system.
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
    if (fault) return detail::failure<DistributedContactSystem>(mpi_detail::error(fault));
    scene.state_->step.drop_ghosts();
    scene.state_->bodies.settings.drop_materials();
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

  /**
   * Gives two bodies, or a body with itself, a material of their own in place of the combined one; NULL takes it back.
   * Any rank may say it, of any bodies, as DistributedScene::set_pair_collision() says, with the same errors at the
   * next begin(). Noted: RAYC_STATUS_INVALID_MATERIAL, RAYC_STATUS_INVALID_STRUCT_SIZE, RAYC_STATUS_OUT_OF_ORDER within
   * a step.
   */
  void set_pair_material(uint64_t first, uint64_t second, const rayc_material* material) {
    mpi_detail::PairSetting change;
    change.said = mpi_detail::PairSetting::MATERIAL;
    change.has_material = material != nullptr ? 1 : 0;
    if (material != nullptr) change.material = *material;
    if (material == nullptr || mpi_detail::is_material(*material, state_->bodies_fault()))
      state_->scene.bodies.set_pair(first, second, change);
  }

  /** The same for a body of this rank's and a half-space, counted in the order they were added. Noted: the errors of
   * rayc_contact_system_set_half_space_material(). */
  void set_half_space_material(uint64_t key, uint32_t half_space, const rayc_material* material) {
    state_->bodies.set_half_space_material(key, half_space, material, state_->bodies_fault());
  }

  /** Where a rigid or moved body of this rank's is, and how it moves; before each step. */
  void set_motion(uint64_t key, const rayc_motion& motion) {
    state_->bodies.set_motion(key, motion, state_->bodies_fault());
  }

  /** How many numbers this rank's vectors have. */
  std::size_t unknown_count() const { return state_->own_count(); }

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
    const auto& nodes = state.bodies.nodes;
    mpi_detail::Fault& noted = state.bodies_fault();
    state.check_begin(dt, {{"positions", positions}, {"velocities", velocities}, {"free_velocities", free_velocities}},
                      noted);
    if (!noted)
      noted.check(rayc_contact_system_look_ahead(state.system(), state.in_scene(), dt, nodes[0].size(), nodes[0].data(),
                                                 nodes[1].data(), nodes[2].data()),
                  "where bodies will be");
    mpi_detail::Fault fault;
    if (!state.meet(fault)) return outcome(fault);
    state.detect(fault, "begin", [&] {
      return rayc_contact_system_begin(state.system(), state.in_scene(), dt, nodes[0].size(), nodes[0].data(),
                                       nodes[1].data(), nodes[2].data());
    });
    return outcome(state.have_begun(fault));
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
    if (fault) return detail::failure<double>(mpi_detail::error(fault));
    MPI_Allreduce(MPI_IN_PLACE, &wrong, 1, MPI_DOUBLE, MPI_MAX, state.comm().get());
    return wrong;
  }

  /**
   * Collective: looks for contacts where bodies end with these velocities, as rayc_contact_system_detect_again() says;
   * true where another solve is due. Ghosts that are needed there join the step.
   *
   * Errors: what any rank has noted, RAYC_STATUS_OUT_OF_ORDER without a step, RAYC_STATUS_WRONG_COUNT,
   * RAYC_STATUS_NOT_FINITE; the step is then as it was. RAYC_STATUS_MPI_FAILED, RAYC_STATUS_OUT_OF_MEMORY, and
   * RAYC_STATUS_NOT_FINITE where a position is beyond the scene's precision, cancel the step.
   */
  Outcome<bool> detect_again(Span<const double> velocities) {
    bool is_more = false;
    const mpi_detail::Fault fault = mpi_detail::detect_again(*state_, velocities, &is_more);
    if (fault) return detail::failure<bool>(mpi_detail::error(fault));
    return is_more;
  }

  /** Collective: the potential of the rows of all ranks in J, as rayc_contact_system_energy() says; without that of
   * pairs that cannot move. The same bits wherever bodies are. */
  Outcome<double> energy(Span<const double> velocities) {
    State& state = *state_;
    mpi_detail::Fault fault = state.spread(velocities, "velocities");
    std::vector<double> joules(state.parts.parts().size());
    if (!fault)
      fault.check(rayc_contact_system_part_energies(state.system(), state.unknowns.size(), state.unknowns.data(),
                                                    joules.size(), joules.data()),
                  "energy");
    fault = state.comm().agree(fault);
    if (fault) return detail::failure<double>(mpi_detail::error(fault));
    return mpi_detail::sum_of_all(state.comm(), joules);
  }

  /** Collective: the matrix of add_product() as 3 x 3 blocks, the rows of this rank's unknowns; replaces what `blocks`
   * held. Errors: those of rayc_contact_system_copy_blocks(). */
  Outcome<void> copy_blocks_to(double factor, DistributedBlocks& blocks) const {
    return outcome(mpi_detail::copy_blocks(*state_, factor, blocks));
  }

  /** Collective: ends a step whose velocities at the end are these. */
  Outcome<void> finish(Span<const double> velocities) {
    State& state = *state_;
    mpi_detail::Fault fault = state.take(velocities, "velocities");
    if (state.bodies.is_busy) state.spread_all(fault);
    return outcome(state.finish(fault));
  }

  /**
   * Collective: a whole step for a host that integrates explicitly, as rayc_contact_system_explicit_step(): adds to
   * `forces` those on this rank's unknowns, and gives the longest stable step of all ranks, s. The numbers of rigid
   * bodies in `positions` and `velocities` do not count; set_motion() has said them. Errors: those of begin().
   */
  Outcome<double> explicit_step(double dt, Span<const double> positions, Span<const double> velocities,
                                Span<double> forces) {
    double longest = 0;
    const mpi_detail::Fault fault = mpi_detail::explicit_step(*state_, dt, positions, velocities, forces, &longest);
    if (fault) return detail::failure<double>(mpi_detail::error(fault));
    return longest;
  }

  /** Ends a step as if it had not begun; all ranks do. */
  void cancel() { state_->cancel(); }

  /**
   * Collective: the scalar product of two vectors over all ranks, with the same bits wherever bodies are: what
   * conjugate gradients need besides products. NaN where a body's part is not finite.
   */
  Outcome<double> dot(Span<const double> a, Span<const double> b) const {
    const State& state = *state_;
    std::vector<double> of_bodies;
    mpi_detail::Fault fault;
    if (a.size() != unknown_count() || b.size() != a.size())
      fault.note(RAYC_STATUS_WRONG_COUNT, "a vector has not one number for each unknown");
    fault = state.comm().agree(fault);
    if (fault) return detail::failure<double>(mpi_detail::error(fault));
    std::size_t at = 0;
    for (const auto& [key, body] : state.bodies.bodies()) {
      if (!body.is_own) continue;
      double sum = 0;
      for (const std::size_t end = at + body.unknown_count(); at < end; ++at) sum += a[at] * b[at];
      of_bodies.push_back(sum);
    }
    return mpi_detail::sum_of_all(state.comm(), of_bodies);
  }

 private:
  using State = mpi_detail::SystemState;

  explicit DistributedContactSystem(std::unique_ptr<State> state) : state_(std::move(state)) {}

  static Outcome<void> outcome(const mpi_detail::Fault& fault) {
    if (fault) return detail::failure<void>(mpi_detail::error(fault));
    return Outcome<void>();
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
    if (!fault) state.add_to(sums);
    return outcome(fault);
  }

  std::unique_ptr<State> state_;
};

}  // namespace raycontact

#endif  // RAYCONTACT_MPI_DISTRIBUTED_CONTACT_SYSTEM_HPP
