// SPDX-License-Identifier: MIT OR Apache-2.0
/** A rank's contact system: what carries its own bodies, and the ghosts of others. */
#ifndef RAYCONTACT_MPI_CARRIED_HPP
#define RAYCONTACT_MPI_CARRIED_HPP

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "raycontact/contact_system.hpp"
#include "raycontact/mpi/attachment.hpp"
#include "raycontact/mpi/bodies.hpp"
#include "raycontact/mpi/grips.hpp"

namespace raycontact::mpi_detail {

/** How a body's surface is carried, and where that stands on this rank. */
struct Carried {
  enum Kind : uint32_t { DEFORMABLE, RIGID, MOVED };

  Kind kind = MOVED;
  rayc_material material{};
  std::vector<double> masses;              // of its nodes
  std::vector<uint32_t> offsets, entries;  // a table of weights; empty where each vertex is a node
  std::vector<double> weights;             //
  double mass = 0;                         // of a rigid body
  std::array<double, 9> inertia{};         //
  rayc_motion motion{{0, 0, 0}, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0}, {0}};
  std::map<uint32_t, rayc_material> half_space_materials;
  std::array<double, 6> end{};        // of a rigid body: its velocities where contacts were last looked for
  uint32_t number = 0;                // in the rank's scene
  std::size_t first_node = 0;         // in the rank's system
  bool is_own = true, is_new = true;  // new: ranks that know the body do not know this of it

  std::size_t unknown_count() const { return kind == DEFORMABLE ? 3 * masses.size() : kind == RIGID ? 6 : 0; }

  void write_to(Bytes& message) const {
    write(message, kind);
    write(message, material);
    write_all(message, masses);
    write_all(message, offsets);
    write_all(message, entries);
    write_all(message, weights);
    write(message, mass);
    write(message, inertia);
    write(message, motion);
    write(message, uint64_t{half_space_materials.size()});
    for (const auto& [half_space, own] : half_space_materials) {
      write(message, half_space);
      write(message, own);
    }
  }

  static Carried read_from(Reader& message) {
    Carried body;
    body.kind = message.read<Kind>();
    body.material = message.read<rayc_material>();
    body.masses = read_all<double>(message);
    body.offsets = read_all<uint32_t>(message);
    body.entries = read_all<uint32_t>(message);
    body.weights = read_all<double>(message);
    body.mass = message.read<double>();
    body.inertia = message.read<std::array<double, 9>>();
    body.motion = message.read<rayc_motion>();
    for (auto count = message.read<uint64_t>(); count > 0; --count) {
      const auto half_space = message.read<uint32_t>();
      body.half_space_materials[half_space] = message.read<rayc_material>();
    }
    return body;
  }

 private:
  template <class Value>
  static void write_all(Bytes& message, const std::vector<Value>& values) {
    write(message, uint64_t{values.size()});
    write(message, values.data(), values.size());
  }

  template <class Value>
  static std::vector<Value> read_all(Reader& message) {
    return message.read_all<Value>(static_cast<std::size_t>(message.read<uint64_t>()));
  }
};

class CarriedBodies final : public Attachment {
 public:
  CarriedBodies(Bodies& bodies, SystemOwner system)
      : system_(std::move(system)), scene_bodies_(bodies), grips_(bodies, system_.get()) {}

  rayc_contact_system* system() const { return system_.get(); }
  const std::map<uint64_t, Carried>& bodies() const { return bodies_; }
  std::size_t node_count() const { return masses_.size(); }
  std::size_t unknown_count() const { return 3 * masses_.size() + 6 * rigid_.size(); }

  /** Positions, velocities and velocities without contact of all nodes. */
  std::array<std::vector<double>, 3> nodes;

  /** The first of a body's unknowns among the rank's. */
  std::size_t start(uint64_t key) const {
    const Carried& body = bodies_.at(key);
    if (body.kind != Carried::RIGID) return 3 * body.first_node;
    const auto place = std::find(rigid_.begin(), rigid_.end(), key) - rigid_.begin();
    return 3 * masses_.size() + 6 * static_cast<std::size_t>(place);
  }

  /** Adds a body that the scene has; notes in `fault` what is wrong with it, and leaves all as it was. */
  void add(uint64_t key, Carried body, Fault& fault) {
    const std::string what = "body of key " + std::to_string(key);
    rayc_scene* scene = scene_bodies_.scene.get();
    if (bodies_.count(key) != 0) {
      fault.note(RAYC_STATUS_BODY_TWICE, what + ": it is known already what carries it; remove the body first");
      return;
    }
    bool is_added = false;
    if (body.kind == Carried::DEFORMABLE) {
      for (double mass : body.masses)
        if (!(mass > 0)) {
          fault.note(RAYC_STATUS_INVALID_MASS, what + ": a node's mass is " + std::to_string(mass) +
                                                   "; give kilograms above 0, infinity for a node held fast");
          return;
        }
      if (!take_nodes(body, fault)) return;
      const bool has_table = !body.offsets.empty();
      is_added = fault.check(
          rayc_contact_system_add_deformable(
              system(), scene, body.number, static_cast<uint32_t>(body.first_node),
              static_cast<uint32_t>(body.masses.size()), has_table ? body.offsets.data() : nullptr, body.entries.size(),
              has_table ? body.entries.data() : nullptr, has_table ? body.weights.data() : nullptr, &body.material),
          what);
      if (!is_added) free_nodes_[body.masses.size()].push_back(body.first_node);
    } else if (body.kind == Carried::RIGID) {
      is_added = fault.check(
          rayc_contact_system_add_rigid(system(), scene, body.number, body.mass, body.inertia.data(), &body.material),
          what);
      if (is_added) rigid_.push_back(key);
    } else {
      is_added = fault.check(rayc_contact_system_add_moved(system(), scene, body.number, &body.material), what);
    }
    if (is_added) bodies_.emplace(key, std::move(body));
  }

  void set_motion(uint64_t key, const rayc_motion& motion, Fault& fault) {
    const std::string what = "motion of the body of key " + std::to_string(key);
    const auto found = bodies_.find(key);
    if (found == bodies_.end()) {
      fault.note(RAYC_STATUS_UNKNOWN_BODY, what + ": this rank does not have it");
      return;
    }
    if (fault.check(rayc_contact_system_set_motion(system(), found->second.number, &motion), what))
      found->second.motion = motion;
  }

  /** Bodies' masses count from the next begin on. */
  void settle(Fault& fault) {
    if (!has_new_masses_) return;
    fault.check(rayc_contact_system_set_node_masses(system(), masses_.size(), masses_.data()), "masses of nodes");
    has_new_masses_ = false;
  }

  /** All ranks that have ghosts of own bodies know them now. */
  void have_been_told() {
    for (auto& [key, body] : bodies_) body.is_new = false;
  }

  void note_half_space(const double* normal, double offset, const rayc_material& material) {
    Bytes bytes;
    write(bytes, normal, 3);
    write(bytes, offset);
    write(bytes, material);
    for (unsigned char byte : bytes) checksum_ = (checksum_ ^ byte) * 0x100000001b3ull;
  }

  Grips& grips() { return grips_; }

  /** What all pairs of ghosts remember waits. */
  void keep_all_memories(Fault& fault) {
    std::set<uint32_t> ghosts;
    for (const auto& [key, body] : bodies_)
      if (!body.is_own) ghosts.insert(body.number);
    grips_.keep(ghosts, fault);
  }

  /** Where own rigid bodies end, by the rank's unknowns. */
  void keep_ends(const std::vector<double>& unknowns) {
    for (auto& [key, body] : bodies_)
      if (body.is_own && body.kind == Carried::RIGID)
        std::copy_n(unknowns.begin() + static_cast<std::ptrdiff_t>(start(key)), body.end.size(), body.end.begin());
  }

  void write_ghost(Bytes& message, uint64_t key, bool is_known) override {
    const Carried& body = bodies_.at(key);
    const bool tells_all = !is_known || body.is_new;
    write(message, uint64_t{tells_all});
    if (tells_all) body.write_to(message);
    // Within a step those who know the body know how it began.
    if (tells_all || !is_busy) {
      write(message, body.motion);
      write_nodes(message, body, nodes[0]);
      write_nodes(message, body, nodes[1]);
    }
    write_nodes(message, body, nodes[2]);
    if (is_busy) write(message, body.end);
  }

  bool read_ghost(Reader& message, uint64_t key, uint32_t number, Fault& fault) override {
    const bool tells_all = message.read<uint64_t>() != 0;
    if (tells_all) {
      if (bodies_.count(key) != 0) grips_.keep({number}, fault);
      remove(key);
      Carried body = Carried::read_from(message);
      body.is_own = false;
      body.number = number;
      add(key, std::move(body), fault);
    }
    const auto found = bodies_.find(key);
    Carried* body = found == bodies_.end() ? nullptr : &found->second;
    if (tells_all || !is_busy) {
      const auto motion = message.read<rayc_motion>();
      read_nodes(message, body, nodes[0]);
      read_nodes(message, body, nodes[1]);
      if (body != nullptr && body->kind != Carried::DEFORMABLE) set_motion(key, motion, fault);
    }
    read_nodes(message, body, nodes[2]);
    const auto end = is_busy ? message.read<std::array<double, 6>>() : std::array<double, 6>();
    if (body != nullptr) body->end = end;
    return tells_all;
  }

  void keep_memories(const std::set<uint32_t>& ghosts, Fault& fault) override { grips_.keep(ghosts, fault); }

  void set_pair_material(uint32_t first, uint32_t second, const PairSetting& setting, Fault& fault) override {
    const rayc_material* material = setting.has_material != 0 ? &setting.material : nullptr;
    fault.check(rayc_contact_system_set_pair_material(system(), first, second, material), "material of a pair");
  }

  /** Of an own body and a half-space; NULL takes it back. */
  void set_half_space_material(uint64_t key, uint32_t half_space, const rayc_material* material, Fault& fault) {
    const std::string what = "material of the body of key " + std::to_string(key) + " on a half-space";
    const auto found = bodies_.find(key);
    if (found == bodies_.end() || !found->second.is_own) {
      fault.note(RAYC_STATUS_UNKNOWN_BODY, what + ": this rank does not have it");
      return;
    }
    Carried& body = found->second;
    if (!fault.check(rayc_contact_system_set_half_space_material(system(), body.number, half_space, material), what))
      return;
    if (material != nullptr)
      body.half_space_materials[half_space] = *material;
    else
      body.half_space_materials.erase(half_space);
  }

  void write_body(Bytes& message, uint64_t key) override {
    const auto found = bodies_.find(key);
    if (found != bodies_.end()) found->second.write_to(message);
  }

  void read_body(const Bytes& message, uint64_t key, uint32_t number, Fault& fault) override {
    if (message.empty()) return;
    Reader reader(message);
    Carried body = Carried::read_from(reader);
    body.number = number;
    const std::map<uint32_t, rayc_material> materials = std::move(body.half_space_materials);
    add(key, std::move(body), fault);
    for (const auto& [half_space, material] : materials) set_half_space_material(key, half_space, &material, fault);
  }

  void remove(uint64_t key) override {
    const auto found = bodies_.find(key);
    if (found == bodies_.end()) return;
    const Carried& body = found->second;
    static_cast<void>(rayc_contact_system_remove_body(system(), body.number));
    if (body.kind == Carried::DEFORMABLE) free_nodes_[body.masses.size()].push_back(body.first_node);
    if (body.kind == Carried::RIGID) rigid_.erase(std::find(rigid_.begin(), rigid_.end(), key));
    bodies_.erase(found);
  }

  void write_memories(std::vector<Bytes>& to_ranks, const Finder& finder, Fault& fault) override {
    grips_.write(to_ranks, finder, fault);
  }

  void read_memories(const Bytes& message) override { grips_.read(message); }

  uint64_t checksum() const override { return checksum_; }

 private:
  /** Nodes of a body that has left, or new ones; bodies of a scene often have equally many. */
  bool take_nodes(Carried& body, Fault& fault) {
    const std::size_t count = body.masses.size();
    std::vector<std::size_t>& free = free_nodes_[count];
    if (free.empty()) {
      if (used_ + count > masses_.size()) {
        // More than are needed now, so that this is rare.
        masses_.resize(std::max(used_ + count, masses_.size() + masses_.size() / 2), 1.0);
        for (std::vector<double>& field : nodes) field.resize(3 * masses_.size());
        if (!fault.check(rayc_contact_system_set_node_masses(system(), masses_.size(), masses_.data()), "nodes"))
          return false;
      }
      free.push_back(used_);
      used_ += count;
    }
    body.first_node = free.back();
    free.pop_back();
    std::copy(body.masses.begin(), body.masses.end(), masses_.begin() + static_cast<std::ptrdiff_t>(body.first_node));
    has_new_masses_ = true;
    return true;
  }

  static std::vector<double>::iterator at(std::vector<double>& field, std::size_t node) {
    return field.begin() + static_cast<std::ptrdiff_t>(3 * node);
  }

  static void write_nodes(Bytes& message, const Carried& body, const std::vector<double>& field) {
    write(message, uint64_t{body.masses.size()});
    write(message, field.data() + 3 * body.first_node, 3 * body.masses.size());
  }

  static void read_nodes(Reader& message, const Carried* body, std::vector<double>& field) {
    const auto count = static_cast<std::size_t>(message.read<uint64_t>());
    const std::vector<double> numbers = message.read_all<double>(3 * count);
    if (body != nullptr) std::copy(numbers.begin(), numbers.end(), at(field, body->first_node));
  }

  SystemOwner system_;
  Bodies& scene_bodies_;
  Grips grips_;
  std::map<uint64_t, Carried> bodies_;
  std::vector<uint64_t> rigid_;  // in the system's order
  std::vector<double> masses_;
  std::size_t used_ = 0;
  bool has_new_masses_ = false;
  std::map<std::size_t, std::vector<std::size_t>> free_nodes_;  // by how many there are together
  uint64_t checksum_ = 0xcbf29ce484222325ull;
};

}  // namespace raycontact::mpi_detail

#endif  // RAYCONTACT_MPI_CARRIED_HPP
