// SPDX-License-Identifier: MIT OR Apache-2.0
/**
 * @file
 * A step's contact on the unknowns that a simulator solves for.
 */
#ifndef RAYCONTACT_CONTACT_SYSTEM_HPP
#define RAYCONTACT_CONTACT_SYSTEM_HPP

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include "contacts.hpp"
#include "distributed.h"
#include "result.hpp"
#include "scene.hpp"
#include "span.hpp"

namespace raycontact {

#ifdef RAYCONTACT_NO_EXCEPTIONS
inline namespace with_results {
#else
inline namespace with_exceptions {
#endif

/** rayc_default_contact_system_options(), which cannot fail for a header and library of one ABI. */
inline rayc_contact_system_options default_contact_system_options() {
  rayc_contact_system_options options{};
  rayc_default_contact_system_options(sizeof options, &options);
  return options;
}

/** A material that bears `pressure` (Pa) at `depth` (m) and no more in one step: rayc_bearing_material(). */
inline Outcome<rayc_material> bearing_material(double pressure, double depth) {
  rayc_material material{};
  const rayc_status status = rayc_bearing_material(pressure, depth, sizeof material, &material);
  return detail::outcome(status, material);
}

/** An elastic body's, by Young's modulus (Pa), Poisson's ratio and an element's edge (m): rayc_elastic_material(). */
inline Outcome<rayc_material> elastic_material(double youngs_modulus, double poissons_ratio, double element_edge) {
  rayc_material material{};
  const rayc_status status =
      rayc_elastic_material(youngs_modulus, poissons_ratio, element_edge, sizeof material, &material);
  return detail::outcome(status, material);
}

/// @cond internal
namespace detail {

/** For arrays of floats; those of doubles, and `{}`, go to the function of the same name before. */
template <class Numbers>
using IfFloats = std::enable_if_t<std::is_convertible<const Numbers&, Span<const float>>::value, int>;

}  // namespace detail
/// @endcond

/** How nodes carry a surface: rayc_contact_system_add_deformable() says what the arrays hold. */
struct Carriers {
  Span<const uint32_t> offsets;  ///< one more than the mesh has vertices
  Span<const uint32_t> nodes;    ///< counted from the body's first
  Span<const double> weights;    ///< those of a vertex sum to 1
};

/** The 3 x 3 blocks of a matrix; those of equal place are to be added. */
struct Blocks {
  std::vector<uint32_t> rows;     ///< in blocks of three unknowns
  std::vector<uint32_t> columns;  ///< the same
  std::vector<double> numbers;    ///< nine for each block, by rows
};

/** A matrix in compressed sparse rows, as rayc_csr: its arrays are those of the system that gave it. */
struct CompressedRows {
  Span<const int32_t> offsets;  ///< where each row begins, and where the last ends
  Span<const int32_t> columns;  ///< ascending within each row
  Span<const double> values;    ///< a number for each column
};

/** What each pair's rows do to each of its bodies: which unknowns, in blocks of three. */
struct Parts {
  std::vector<rayc_contact_part> parts;  ///< one for each pair and each of its bodies
  std::vector<uint32_t> blocks;          ///< of all parts, one after the other
};

/** The 3 x 3 blocks of a matrix, part by part. */
struct PartBlocks {
  std::vector<uint32_t> parts;    ///< to whose rows it adds: the place among Parts::parts
  std::vector<uint32_t> rows;     ///< in blocks of three unknowns
  std::vector<uint32_t> columns;  ///< the same
  std::vector<double> numbers;    ///< nine for each block, by rows
};

/** Owns an rayc_contact_system, whose text says what it does and what a step is. Moves, does not copy. */
class ContactSystem {
 public:
#ifndef RAYCONTACT_NO_EXCEPTIONS
  /** As create(). */
  explicit ContactSystem(const rayc_contact_system_options& options = default_contact_system_options())
      : ContactSystem(create(options)) {}
#endif

  /** A system without bodies: rayc_contact_system_create(). */
  static Outcome<ContactSystem> create(const rayc_contact_system_options& options = default_contact_system_options()) {
    rayc_contact_system* system = nullptr;
    rayc_status status = detail::check_abi();
    if (status == RAYC_STATUS_OK) status = rayc_contact_system_create(&options, &system);
    return detail::outcome(status, ContactSystem(system));
  }

  /** The masses of the host's nodes, kg: rayc_contact_system_set_node_masses(). */
  Outcome<void> set_node_masses(Span<const double> masses) {
    return check(rayc_contact_system_set_node_masses(get(), masses.size(), masses.data()));
  }

  /** Body `body` of the scene, whose surface vertices are these nodes. */
  Outcome<void> add_deformable(const Scene& scene, uint32_t body, uint32_t first_node, uint32_t node_count,
                               const rayc_material& material) {
    return check(rayc_contact_system_add_deformable(get(), scene.get(), body, first_node, node_count, nullptr, 0,
                                                    nullptr, nullptr, &material));
  }

  /** The same with a surface that these nodes carry by weights: a skin in a cage. */
  Outcome<void> add_deformable(const Scene& scene, uint32_t body, uint32_t first_node, uint32_t node_count,
                               const Carriers& carriers, const rayc_material& material) {
    return check(rayc_contact_system_add_deformable(get(), scene.get(), body, first_node, node_count,
                                                    carriers.offsets.data(), carriers.nodes.size(),
                                                    carriers.nodes.data(), carriers.weights.data(), &material));
  }

  /** A rigid body; its mesh was created in its own coordinates, about its centre of mass. */
  Outcome<void> add_rigid(const Scene& scene, uint32_t body, double mass, const std::array<double, 9>& inertia,
                          const rayc_material& material) {
    return check(rayc_contact_system_add_rigid(get(), scene.get(), body, mass, inertia.data(), &material));
  }

  /** A body that stands still or that the host moves. */
  Outcome<void> add_moved(const Scene& scene, uint32_t body, const rayc_material& material) {
    return check(rayc_contact_system_add_moved(get(), scene.get(), body, &material));
  }

  /** Solid where normal . x < offset. */
  Outcome<void> add_half_space(const std::array<double, 3>& normal, double offset, const rayc_material& material) {
    return check(rayc_contact_system_add_half_space(get(), normal.data(), offset, &material));
  }

  /** To be removed from the scene too. */
  Outcome<void> remove_body(uint32_t body) { return check(rayc_contact_system_remove_body(get(), body)); }

  /** A material of two bodies' own; NULL takes it back. */
  Outcome<void> set_pair_material(uint32_t a, uint32_t b, const rayc_material* material) {
    return check(rayc_contact_system_set_pair_material(get(), a, b, material));
  }

  /** A material of a body and a half-space, counted in the order they were added; NULL takes it back. */
  Outcome<void> set_half_space_material(uint32_t body, uint32_t half_space, const rayc_material* material) {
    return check(rayc_contact_system_set_half_space_material(get(), body, half_space, material));
  }

  /** Where a rigid or moved body is, and how it moves; before each step. */
  Outcome<void> set_motion(uint32_t body, const rayc_motion& motion) {
    return check(rayc_contact_system_set_motion(get(), body, &motion));
  }

  /** What joints add to a rigid body's mass and inertia: rayc_contact_system_set_added_inertia(). */
  Outcome<void> set_added_inertia(uint32_t body, const std::array<std::array<double, 6>, 6>& added) {
    return check(rayc_contact_system_set_added_inertia(get(), body, added[0].data()));
  }

  /** How many numbers a vector of unknowns has. */
  Outcome<std::size_t> unknown_count() const {
    std::size_t count = 0;
    const rayc_status status = rayc_contact_system_unknown_count(get(), &count);
    return detail::outcome(status, count);
  }

  /** Begins a step of dt seconds: rayc_contact_system_begin(). */
  Outcome<void> begin(Scene& scene, double dt, Span<const double> positions, Span<const double> velocities,
                      Span<const double> free_velocities) {
    if (velocities.size() != positions.size() || free_velocities.size() != positions.size())
      return detail::failure<void>(Error(RAYC_STATUS_WRONG_COUNT, "positions and velocities are not equally many"));
    return check(rayc_contact_system_begin(get(), scene.get(), dt, positions.size(), positions.data(),
                                           velocities.data(), free_velocities.data()));
  }

  /** The same with floats, as below: rayc_contact_system_begin_f32(). */
  template <class Numbers, detail::IfFloats<Numbers> = 0>
  Outcome<void> begin(Scene& scene, double dt, const Numbers& positions, Span<const float> velocities,
                      Span<const float> free_velocities) {
    const Span<const float> x = positions;
    if (velocities.size() != x.size() || free_velocities.size() != x.size()) return unequal();
    return check(rayc_contact_system_begin_f32(get(), scene.get(), dt, x.size(), x.data(), velocities.data(),
                                               free_velocities.data()));
  }

  /** Adds the forces at these velocities, as the rows are held. */
  Outcome<void> add_forces(Span<const double> velocities, Span<double> forces) {
    if (forces.size() != velocities.size()) return unequal();
    return check(rayc_contact_system_add_forces(get(), velocities.size(), velocities.data(), forces.data()));
  }

  /** The same with floats. */
  template <class Numbers, detail::IfFloats<Numbers> = 0>
  Outcome<void> add_forces(const Numbers& velocities, Span<float> forces) {
    const Span<const float> v = velocities;
    if (forces.size() != v.size()) return unequal();
    return check(rayc_contact_system_add_forces_f32(get(), v.size(), v.data(), forces.data()));
  }

  /** Adds factor * (-dforce/dvelocity) * change. */
  Outcome<void> add_product(double factor, Span<const double> change, Span<double> result) {
    if (result.size() != change.size()) return unequal();
    return check(rayc_contact_system_add_product(get(), factor, change.size(), change.data(), result.data()));
  }

  /** The same with floats. */
  template <class Numbers, detail::IfFloats<Numbers> = 0>
  Outcome<void> add_product(double factor, const Numbers& change, Span<float> result) {
    const Span<const float> by = change;
    if (result.size() != by.size()) return unequal();
    return check(rayc_contact_system_add_product_f32(get(), factor, by.size(), by.data(), result.data()));
  }

  /** The same matrix in compressed sparse rows, until this is called again or the system ends. */
  Outcome<CompressedRows> csr(double factor) {
    rayc_csr matrix{};
    const rayc_status status = rayc_contact_system_csr(get(), factor, &matrix);
    const std::size_t offsets = matrix.offsets == nullptr ? 0 : matrix.row_count + 1;
    return detail::outcome(status, CompressedRows{{matrix.offsets, offsets},
                                                  {matrix.columns, matrix.value_count},
                                                  {matrix.values, matrix.value_count}});
  }

  /** The same matrix as blocks; replaces what `blocks` held. */
  Outcome<void> copy_blocks_to(double factor, Blocks& blocks) const {
    std::size_t count = 0;
    rayc_status status = rayc_contact_system_block_count(get(), &count);
    blocks.rows.resize(count);
    blocks.columns.resize(count);
    blocks.numbers.resize(9 * count);
    if (status == RAYC_STATUS_OK)
      status = rayc_contact_system_copy_blocks(get(), factor, count, blocks.rows.data(), blocks.columns.data(),
                                               blocks.numbers.data());
    return check(status);
  }

  /** The potential of the rows, J. */
  Outcome<double> energy(Span<const double> velocities) {
    double joules = 0;
    const rayc_status status = rayc_contact_system_energy(get(), velocities.size(), velocities.data(), &joules);
    return detail::outcome(status, joules);
  }

  /** The same with floats. */
  template <class Numbers, detail::IfFloats<Numbers> = 0>
  Outcome<double> energy(const Numbers& velocities) {
    const Span<const float> v = velocities;
    double joules = 0;
    const rayc_status status = rayc_contact_system_energy_f32(get(), v.size(), v.data(), &joules);
    return detail::outcome(status, joules);
  }

  /** The energy stored after a part of the step, J, contacts looked for there: rayc_contact_system_potential(). */
  Outcome<double> potential(Scene& scene, Span<const double> velocities, double part = 1) {
    double joules = 0;
    const rayc_status status = rayc_contact_system_potential(get(), scene.get(), velocities.size(), velocities.data(),
                                                             part, &joules);
    return detail::outcome(status, joules);
  }

  /** Holds the rows anew, at these velocities; the part of the force that had been predicted wrongly. */
  Outcome<double> linearise(Span<const double> velocities) {
    double wrong = 0;
    const rayc_status status = rayc_contact_system_linearise(get(), velocities.size(), velocities.data(), &wrong);
    return detail::outcome(status, wrong);
  }

  /** The same with floats. */
  template <class Numbers, detail::IfFloats<Numbers> = 0>
  Outcome<double> linearise(const Numbers& velocities) {
    const Span<const float> v = velocities;
    double wrong = 0;
    const rayc_status status = rayc_contact_system_linearise_f32(get(), v.size(), v.data(), &wrong);
    return detail::outcome(status, wrong);
  }

  /** What linearise() would give, but the rows are held as before. */
  Outcome<double> misjudged(Span<const double> velocities) {
    double wrong = 0;
    const rayc_status status = rayc_contact_system_misjudged(get(), velocities.size(), velocities.data(), &wrong);
    return detail::outcome(status, wrong);
  }

  /** The same with floats. */
  template <class Numbers, detail::IfFloats<Numbers> = 0>
  Outcome<double> misjudged(const Numbers& velocities) {
    const Span<const float> v = velocities;
    double wrong = 0;
    const rayc_status status = rayc_contact_system_misjudged_f32(get(), v.size(), v.data(), &wrong);
    return detail::outcome(status, wrong);
  }

  /**
   * How far bodies end from where contacts were last looked for: the largest squares of a difference of velocities, of
   * nodes and of rigid bodies: rayc_contact_system_off_course().
   */
  Outcome<std::array<double, 2>> off_course(const Scene& scene, Span<const double> velocities) {
    std::array<double, 2> squares{};
    const rayc_status status = rayc_contact_system_off_course(get(), scene.get(), velocities.size(), velocities.data(),
                                                              &squares[0], &squares[1]);
    return detail::outcome(status, squares);
  }

  /** Looks for contacts where bodies end with these velocities; whether another solve is due. */
  Outcome<bool> detect_again(Scene& scene, Span<const double> velocities) {
    uint32_t is_more = 0;
    const rayc_status status =
        rayc_contact_system_detect_again(get(), scene.get(), velocities.size(), velocities.data(), &is_more);
    return detail::outcome(status, is_more != 0);
  }

  /** The same with floats. */
  template <class Numbers, detail::IfFloats<Numbers> = 0>
  Outcome<bool> detect_again(Scene& scene, const Numbers& velocities) {
    const Span<const float> v = velocities;
    uint32_t is_more = 0;
    const rayc_status status = rayc_contact_system_detect_again_f32(get(), scene.get(), v.size(), v.data(), &is_more);
    return detail::outcome(status, is_more != 0);
  }

  /** What the rows act on, pair by pair; replaces what `parts` held: rayc_contact_system_copy_parts(). */
  Outcome<void> copy_parts_to(Parts& parts) {
    std::size_t part_count = 0, block_count = 0;
    rayc_status status = rayc_contact_system_part_count(get(), &part_count, &block_count);
    parts.parts.resize(part_count);
    parts.blocks.resize(block_count);
    if (status == RAYC_STATUS_OK)
      status = rayc_contact_system_copy_parts(get(), part_count, parts.parts.data(), block_count, parts.blocks.data());
    return check(status);
  }

  /** The forces on these blocks, three numbers each: rayc_contact_system_part_forces(). */
  Outcome<void> part_forces(Span<const double> velocities, Span<double> forces) {
    return check(
        rayc_contact_system_part_forces(get(), velocities.size(), velocities.data(), forces.size() / 3, forces.data()));
  }

  /** The same with products: rayc_contact_system_part_products(). */
  Outcome<void> part_products(double factor, Span<const double> change, Span<double> result) {
    return check(rayc_contact_system_part_products(get(), factor, change.size(), change.data(), result.size() / 3,
                                                   result.data()));
  }

  /** The same matrix as copy_blocks_to(), pair by pair: rayc_contact_system_copy_part_blocks(). */
  Outcome<void> copy_part_blocks_to(double factor, PartBlocks& blocks) {
    std::size_t count = 0;
    rayc_status status = rayc_contact_system_part_block_count(get(), &count);
    blocks.parts.resize(count);
    blocks.rows.resize(count);
    blocks.columns.resize(count);
    blocks.numbers.resize(9 * count);
    if (status == RAYC_STATUS_OK)
      status = rayc_contact_system_copy_part_blocks(get(), factor, count, blocks.parts.data(), blocks.rows.data(),
                                                    blocks.columns.data(), blocks.numbers.data());
    return check(status);
  }

  /** The energy pair by pair, a number for each of Parts::parts: rayc_contact_system_part_energies(). */
  Outcome<void> part_energies(Span<const double> velocities, Span<double> joules) {
    return check(
        rayc_contact_system_part_energies(get(), velocities.size(), velocities.data(), joules.size(), joules.data()));
  }

  /** How strongly rows act on each of Parts::blocks: rayc_contact_system_part_couplings(). */
  Outcome<void> part_couplings(Span<double> couplings) {
    return check(rayc_contact_system_part_couplings(get(), couplings.size(), couplings.data()));
  }

  /** By their sums, one for each block of three unknowns: rayc_contact_system_largest_coupling(). */
  Outcome<std::array<double, 2>> largest_coupling(Span<const double> sums) const {
    std::array<double, 2> largest{};
    const rayc_status status =
        rayc_contact_system_largest_coupling(get(), sums.size(), sums.data(), &largest[0], &largest[1]);
    return detail::outcome(status, largest);
  }

  /** Begins a step of a host that integrates explicitly: rayc_contact_system_begin_explicit(). */
  Outcome<void> begin_explicit(Scene& scene, double dt, Span<const double> positions, Span<const double> velocities) {
    if (velocities.size() != positions.size()) return unequal();
    return check(rayc_contact_system_begin_explicit(get(), scene.get(), dt, positions.size(), positions.data(),
                                                    velocities.data()));
  }

  /** Ends a step whose velocities at the end are these. */
  Outcome<void> finish(Span<const double> velocities) {
    return check(rayc_contact_system_finish(get(), velocities.size(), velocities.data()));
  }

  /** The same with floats. */
  template <class Numbers, detail::IfFloats<Numbers> = 0>
  Outcome<void> finish(const Numbers& velocities) {
    const Span<const float> v = velocities;
    return check(rayc_contact_system_finish_f32(get(), v.size(), v.data()));
  }

  /** Ends a step as if it had not begun. */
  Outcome<void> cancel() { return check(rayc_contact_system_cancel(get())); }

  /** Linear and angular velocity of a rigid body at the end of the last finished step. */
  Outcome<std::array<double, 6>> rigid_velocity(uint32_t body) const {
    std::array<double, 6> velocity{};
    const rayc_status status = rayc_contact_system_rigid_velocity(get(), body, velocity.data());
    return detail::outcome(status, velocity);
  }

  /** The net force of another body on a body in the last finished step, N. */
  Outcome<std::array<double, 3>> pair_force(uint32_t body, uint32_t other) const {
    std::array<double, 3> force{};
    const rayc_status status = rayc_contact_system_pair_force(get(), body, other, 0, force.data());
    return detail::outcome(status, force);
  }

  /** The same of a half-space, counted in the order they were added. */
  Outcome<std::array<double, 3>> half_space_force(uint32_t body, uint32_t half_space) const {
    std::array<double, 3> force{};
    const rayc_status status = rayc_contact_system_pair_force(get(), body, half_space, 1, force.data());
    return detail::outcome(status, force);
  }

  /** The contacts of the last detection; replaces what `contacts` held. */
  Outcome<void> copy_contacts_to(Contacts& contacts) const {
    return check(rayc_contact_system_copy_contacts(get(), contacts.get()));
  }

  /** A whole step for a host that integrates explicitly; the longest stable step, s. */
  Outcome<double> explicit_step(Scene& scene, double dt, Span<const double> positions, Span<const double> velocities,
                                Span<double> forces) {
    if (velocities.size() != positions.size())
      return detail::failure<double>(Error(RAYC_STATUS_WRONG_COUNT, "positions and velocities are not equally many"));
    double longest = 0;
    const rayc_status status =
        rayc_contact_system_explicit_step(get(), scene.get(), dt, positions.size(), positions.data(), velocities.data(),
                                          forces.size(), forces.data(), &longest);
    return detail::outcome(status, longest);
  }

  /** The same with floats. */
  template <class Numbers, detail::IfFloats<Numbers> = 0>
  Outcome<double> explicit_step(Scene& scene, double dt, const Numbers& positions, Span<const float> velocities,
                                Span<float> forces) {
    const Span<const float> x = positions;
    if (velocities.size() != x.size())
      return detail::failure<double>(Error(RAYC_STATUS_WRONG_COUNT, "positions and velocities are not equally many"));
    double longest = 0;
    const rayc_status status = rayc_contact_system_explicit_step_f32(
        get(), scene.get(), dt, x.size(), x.data(), velocities.data(), forces.size(), forces.data(), &longest);
    return detail::outcome(status, longest);
  }

  /** For raycontact.h; stays this object's. NULL after a move. */
  rayc_contact_system* get() const noexcept { return handle_.get(); }

 private:
  explicit ContactSystem(rayc_contact_system* system) : handle_(system) {}
  static Outcome<void> unequal() {
    return detail::failure<void>(Error(RAYC_STATUS_WRONG_COUNT, "the two arrays are not equally long"));
  }
  detail::Owner<rayc_contact_system, rayc_contact_system_destroy> handle_;
};

/**
 * Many scenes at once, such as those of robot learning: one call for all, on the threads of the first scene. Each gets
 * the same bits as by itself. Scenes, contact systems and lists of contacts stay the caller's and outlive it. Where
 * some of the scenes have an error, the others are done nevertheless: the error is that of the first, and statuses()
 * has all.
 */
class Batch {
 public:
  /** `scenes` for query(), and as many `systems` for begin() and detect_again(). */
  explicit Batch(Span<const Scene> scenes, Span<const ContactSystem> systems = {}) : statuses_(scenes.size()) {
    for (const Scene& scene : scenes) scenes_.push_back(scene.get());
    for (const ContactSystem& system : systems) systems_.push_back(system.get());
  }

  /** Contacts of each scene, into one list for each: rayc_scenes_query(). */
  Outcome<void> query(Span<Contacts> contacts) {
    if (contacts.size() != scenes_.size()) return wrong_count("lists of contacts");
    lists_.clear();
    for (const Contacts& list : contacts) lists_.push_back(list.get());
    return check(rayc_scenes_query(scenes_.size(), scenes_.data(), lists_.data(), statuses_.data()));
  }

  /** ContactSystem::begin() of each system; the numbers of each follow one another: rayc_contact_systems_begin(). */
  Outcome<void> begin(double dt, Span<const double> positions, Span<const double> velocities,
                      Span<const double> free_velocities) {
    const std::size_t size = positions.size();
    if (systems_.size() != scenes_.size()) return wrong_count("systems");
    if (velocities.size() != size || free_velocities.size() != size || !is_shared(size)) return wrong_count("numbers");
    return check(rayc_contact_systems_begin(scenes_.size(), systems_.data(), scenes_.data(), dt, each(size),
                                            positions.data(), velocities.data(), free_velocities.data(),
                                            statuses_.data()));
  }

  /** ContactSystem::detect_again() of each; `is_more` gets 0 or 1 for each: rayc_contact_systems_detect_again(). */
  Outcome<void> detect_again(Span<const double> velocities, Span<uint32_t> is_more) {
    if (systems_.size() != scenes_.size() || is_more.size() != scenes_.size()) return wrong_count("systems");
    if (!is_shared(velocities.size())) return wrong_count("numbers");
    return check(rayc_contact_systems_detect_again(scenes_.size(), systems_.data(), scenes_.data(),
                                                   each(velocities.size()), velocities.data(), is_more.data(),
                                                   statuses_.data()));
  }

  /** A rayc_status of each scene in the last call. */
  Span<const uint32_t> statuses() const { return statuses_; }

 private:
  std::size_t each(std::size_t size) const { return scenes_.empty() ? 0 : size / scenes_.size(); }
  bool is_shared(std::size_t size) const { return each(size) * scenes_.size() == size; }
  Outcome<void> wrong_count(const std::string& what) const {
    return detail::failure<void>(Error(RAYC_STATUS_WRONG_COUNT, "give as many " + what + " for each of the scenes"));
  }
  std::vector<rayc_scene*> scenes_;
  std::vector<rayc_contact_system*> systems_;
  std::vector<rayc_contacts*> lists_;
  std::vector<uint32_t> statuses_;
};

}  // inline namespace
}  // namespace raycontact

#endif  // RAYCONTACT_CONTACT_SYSTEM_HPP
