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

namespace raycontact::mpi_detail {

using SystemOwner = detail::Owner<rayc_contact_system, rayc_contact_system_destroy>;

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

/** What a pair's friction remembers, by keys; a half-space by its number. */
struct GripMemory {
  uint64_t first = 0, second = 0;
  uint64_t is_half_space = 0;
  Bytes bytes;
};

class CarriedBodies final : public Attachment {
 public:
  CarriedBodies(Bodies& bodies, SystemOwner system) : system_(std::move(system)), scene_bodies_(bodies) {}

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

  /** What pairs remembered on other ranks; those whose bodies do not meet any more have forgotten. */
  void put_memories(Fault& fault) {
    for (const GripMemory& grip : waiting_) {
      const auto first = bodies_.find(grip.first), second = bodies_.find(grip.second);
      const bool has_second = grip.is_half_space != 0 || second != bodies_.end();
      if (first == bodies_.end() || !has_second) continue;
      rayc_contact_memory pair{};
      pair.first = first->second.number;
      pair.second = grip.is_half_space != 0 ? static_cast<uint32_t>(grip.second) : second->second.number;
      pair.is_half_space = static_cast<uint32_t>(grip.is_half_space);
      pair.length = grip.bytes.size();
      fault.check(rayc_contact_system_put_memory(system(), &pair, grip.bytes.data()), "memory of a pair");
    }
    waiting_.clear();
  }

  void write_ghost(Bytes& message, uint64_t key, bool is_known) override {
    const Carried& body = bodies_.at(key);
    const bool tells_all = !is_known || body.is_new;
    write(message, uint64_t{tells_all});
    if (tells_all) body.write_to(message);
    write(message, body.motion);
    write(message, uint64_t{body.masses.size()});
    for (const std::vector<double>& field : nodes)
      write(message, field.data() + 3 * body.first_node, 3 * body.masses.size());
  }

  void read_ghost(Reader& message, uint64_t key, uint32_t number, Fault& fault) override {
    if (message.read<uint64_t>() != 0) {
      remove(key);
      Carried body = Carried::read_from(message);
      body.is_own = false;
      body.number = number;
      add(key, std::move(body), fault);
    }
    const auto motion = message.read<rayc_motion>();
    const auto count = static_cast<std::size_t>(message.read<uint64_t>());
    const auto found = bodies_.find(key);
    for (std::vector<double>& field : nodes) {
      const std::vector<double> read = message.read_all<double>(3 * count);
      if (found != bodies_.end()) std::copy(read.begin(), read.end(), at(field, found->second.first_node));
    }
    if (found != bodies_.end() && found->second.kind != Carried::DEFORMABLE) set_motion(key, motion, fault);
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
    add(key, std::move(body), fault);
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
    std::size_t count = 0;
    fault.check(rayc_contact_system_memory_count(system(), &count), "memories of pairs");
    std::vector<rayc_contact_memory> memories(count);
    fault.check(rayc_contact_system_copy_memories(system(), count, memories.data()), "memories of pairs");
    std::vector<GripMemory> all = std::exchange(waiting_, {});
    for (const rayc_contact_memory& memory : memories) {
      GripMemory grip;
      grip.first = scene_bodies_.named.at(memory.first).key;
      grip.second = memory.is_half_space != 0 ? memory.second : scene_bodies_.named.at(memory.second).key;
      grip.is_half_space = memory.is_half_space;
      grip.bytes.resize(memory.length);
      fault.check(rayc_contact_system_pack_memory(system(), &memory, grip.bytes.data()), "memory of a pair");
      all.push_back(std::move(grip));
    }
    for (const GripMemory& grip : all) {
      const int rank = finder(grip.first, grip.is_half_space != 0 ? grip.first : grip.second);
      if (rank < 0) continue;
      Bytes& message = to_ranks[static_cast<std::size_t>(rank)];
      for (uint64_t number : {grip.first, grip.second, grip.is_half_space, uint64_t{grip.bytes.size()}})
        write(message, number);
      write(message, grip.bytes.data(), grip.bytes.size());
    }
  }

  void read_memories(const Bytes& message) override {
    for (Reader reader(message); !reader.is_at_end();) {
      GripMemory grip;
      grip.first = reader.read<uint64_t>();
      grip.second = reader.read<uint64_t>();
      grip.is_half_space = reader.read<uint64_t>();
      grip.bytes = reader.read_all<unsigned char>(static_cast<std::size_t>(reader.read<uint64_t>()));
      waiting_.push_back(std::move(grip));
    }
  }

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

  SystemOwner system_;
  Bodies& scene_bodies_;
  std::map<uint64_t, Carried> bodies_;
  std::vector<uint64_t> rigid_;  // in the system's order
  std::vector<double> masses_;
  std::size_t used_ = 0;
  bool has_new_masses_ = false;
  std::map<std::size_t, std::vector<std::size_t>> free_nodes_;  // by how many there are together
  std::vector<GripMemory> waiting_;
  uint64_t checksum_ = 0xcbf29ce484222325ull;
};

}  // namespace raycontact::mpi_detail

#endif  // RAYCONTACT_MPI_CARRIED_HPP
