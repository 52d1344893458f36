// SPDX-License-Identifier: MIT OR Apache-2.0
/** A rank's part of a distributed scene: its own bodies, ghosts of others, and the meshes they are made of. */
#ifndef RAYCONTACT_MPI_BODIES_HPP
#define RAYCONTACT_MPI_BODIES_HPP

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "raycontact/mpi/attachment.hpp"
#include "raycontact/mpi/boxes.hpp"
#include "raycontact/mpi/communicator.hpp"
#include "raycontact/mpi/pair_settings.hpp"
#include "raycontact/scene.hpp"

namespace raycontact::mpi_detail {

using SceneOwner = detail::Owner<rayc_scene, rayc_scene_destroy>;
using ContactsOwner = detail::Owner<rayc_contacts, rayc_contacts_destroy>;
using MeshOwner = detail::Owner<rayc_mesh, rayc_mesh_destroy>;

/** A mesh as it was packed; known by the checksum at the end of its bytes. */
struct Shape {
  Bytes packed;
  std::set<int> known_to;  // ranks that have been sent it, and keep it
  MeshOwner mesh;          // made when a body of another rank needs it
};

/** What a pair does to a body: its forces among all of a step. */
struct Part {
  uint64_t other;  // key of the other body; its own, of a body with itself
  std::size_t start, count;
};

/** A body of this rank's own. */
struct Own {
  uint32_t number = 0;
  uint64_t shape = 0;
  bool collides_with_itself = false;
  bool is_new = true;  // not yet known to be on no other rank
  std::size_t vertex_count = 0;
  std::vector<double> positions, velocities, forces;
  Box box;
  uint32_t neighbours = 0;
  double cost = 0;
  std::vector<Part> parts;
};

/** Another rank's body that meets bodies of this one. */
struct Ghost {
  uint32_t number = 0;
  uint64_t shape = 0;
  int owner = 0;
  bool is_current = false;
  std::vector<double> velocities;
};

/** Keys of own bodies that other ranks have as ghosts, by rank; or of ghosts, by the ranks that they are had from. */
using Keys = std::map<int, std::set<uint64_t>>;

inline std::vector<int> ranks(const Keys& keys) {
  std::vector<int> ranks;
  for (const auto& [rank, of_rank] : keys) ranks.push_back(rank);
  return ranks;
}

/** A body by its number in the rank's scene. */
struct Named {
  uint64_t key = 0;
  Own* own = nullptr;
  Ghost* ghost = nullptr;
};

/** What a pair remembers, by keys, the smaller first. */
struct KeyedMemory {
  uint64_t first, second;
  rayc_pair_memory memory;
};

inline bool read_vectors(const rayc_vectors& from, std::vector<double>& to) {
  to.resize(3 * from.count);
  const std::size_t size = from.scalar == RAYC_SCALAR_F32 ? sizeof(float) : sizeof(double);
  const std::size_t stride = from.stride != 0 ? from.stride : 3 * size;
  for (std::size_t i = 0; i < to.size(); ++i) {
    const char* at = static_cast<const char*>(from.data) + i / 3 * stride + i % 3 * size;
    float narrow = 0;
    if (size == sizeof(float))
      std::memcpy(&narrow, at, size);
    else
      std::memcpy(&to[i], at, size);
    if (size == sizeof(float)) to[i] = narrow;
    if (!(to[i] - to[i] == 0)) return false;
  }
  return true;
}

/**
 * The bodies of one rank. Calls of the host note what is wrong and leave all as it was; the next collective call says
 * it.
 */
class Bodies {
 public:
  std::map<uint64_t, Own> own;
  std::map<uint64_t, Ghost> ghosts;
  std::unordered_map<uint32_t, Named> named;
  std::map<uint64_t, Shape> shapes;
  SceneOwner scene;
  ContactsOwner contacts;
  Fault fault;
  bool has_new = false;
  Attachment* attachment = nullptr;
  PairSettings settings;

  void add(uint64_t key, const rayc_mesh* mesh, bool collides_with_itself) {
    const std::string what = "body of key " + std::to_string(key);
    if (own.count(key) != 0) {
      fault.note(RAYC_STATUS_KEY_TAKEN, what + ": this rank has one already; give each body its own key");
      return;
    }
    if (is_busy(what)) return;
    std::size_t length = 0, vertex_count = 0;
    if (!fault.check(rayc_mesh_packed_length(mesh, &length), what)) return;
    Bytes packed(length);
    if (!fault.check(rayc_mesh_pack(mesh, length, packed.data()), what)) return;
    if (!fault.check(rayc_mesh_vertex_count(mesh, &vertex_count), what)) return;
    // It may have been a ghost here until now.
    if (ghosts.count(key) != 0) remove_ghost(ghosts.find(key));
    Own body;
    body.vertex_count = vertex_count;
    body.positions.resize(3 * vertex_count);
    body.velocities.resize(3 * vertex_count);
    body.forces.resize(3 * vertex_count);
    body.collides_with_itself = collides_with_itself;
    body.shape = keep(std::move(packed));
    const rayc_vectors_mut view = vectors_mut(body.positions);
    if (!fault.check(rayc_mesh_copy_positions(mesh, &view), what)) return;
    if (!fault.check(rayc_scene_add_mesh_with_key(scene.get(), mesh, key, &body.number), what)) return;
    if (!fault.check(rayc_scene_set_self_collision(scene.get(), body.number, collides_with_itself ? 1 : 0), what)) {
      static_cast<void>(rayc_scene_remove_body(scene.get(), body.number));
      return;
    }
    Own& added = own[key] = std::move(body);
    named[added.number] = Named{key, &added, nullptr};
    has_new = true;
  }

  /** Whether a contact system's step is under way, in which bodies stay; notes it. */
  bool is_busy(const std::string& what) {
    if (attachment == nullptr || !attachment->is_busy) return false;
    fault.note(RAYC_STATUS_OUT_OF_ORDER, what + ": a step of the contact system is under way; finish it first");
    return true;
  }

  Own* find(uint64_t key) {
    const auto found = own.find(key);
    if (found != own.end()) return &found->second;
    fault.note(RAYC_STATUS_UNKNOWN_BODY, "body of key " + std::to_string(key) + ": this rank does not have it");
    return nullptr;
  }

  void set_positions(uint64_t key, const rayc_vectors& positions) {
    Own* body = find(key);
    if (body == nullptr) return;
    const std::string what = "body of key " + std::to_string(key);
    if (fault.check(rayc_scene_set_positions(scene.get(), body->number, &positions), what))
      read_vectors(positions, body->positions);
  }

  void set_velocities(uint64_t key, const rayc_vectors& velocities) {
    Own* body = find(key);
    if (body == nullptr) return;
    const std::string what = "velocities of the body of key " + std::to_string(key);
    std::vector<double> read;
    if (velocities.count != body->vertex_count)
      fault.note(RAYC_STATUS_WRONG_COUNT, what + ": there are " + std::to_string(velocities.count) +
                                              "; give one for each of " + std::to_string(body->vertex_count) +
                                              " vertices");
    else if (velocities.data == nullptr)
      fault.note(RAYC_STATUS_NULL_POINTER, what + ": data is NULL; pass a valid pointer");
    else if (!read_vectors(velocities, read))
      fault.note(RAYC_STATUS_NOT_FINITE, what + ": a number is NaN or infinite; check the simulation's last step");
    else
      body->velocities = std::move(read);
  }

  /** The host removes a body of this rank's. */
  void remove(uint64_t key) {
    Own* body = find(key);
    if (body == nullptr || is_busy("body of key " + std::to_string(key))) return;
    settings.forget(key);
    let_go(key, body);
  }

  /** The body is another rank's from now on. */
  void let_go(uint64_t key) {
    let_go(key, find(key));
    settings.has_left(key, own);
  }

  /** The host says something of two bodies of any ranks. */
  void set_pair(uint64_t first, uint64_t second, const PairSetting& change) {
    const std::string what = "pair of keys " + std::to_string(first) + " and " + std::to_string(second);
    if (first == second && change.said != PairSetting::MATERIAL)
      fault.note(RAYC_STATUS_INVALID_OPTION, what + ": these are the same body; name two different ones");
    else if (!is_busy(what))
      settings.change(first, second, change);
  }

  /** Tells the scene, and the attachment, what has been said of pairs that are here, or have come here. */
  void apply_settings() {
    for (const PairSettings::Pair& pair : settings.take_untold()) {
      uint32_t numbers[2];
      if (!number(pair[0], &numbers[0]) || !number(pair[1], &numbers[1])) continue;
      const PairSetting setting = settings.find(pair[0], pair[1]);
      const std::string what = "pair of keys " + std::to_string(pair[0]) + " and " + std::to_string(pair[1]);
      if (attachment != nullptr) attachment->set_pair_material(numbers[0], numbers[1], setting, fault);
      if (pair[0] == pair[1]) continue;
      const uint32_t is_on = setting.is_ignored == 0 ? 1 : 0, is_allowed = setting.is_bound == 0 ? 1 : 0;
      fault.check(rayc_scene_set_pair_collision(scene.get(), numbers[0], numbers[1], is_on), what);
      fault.check(rayc_scene_allow_escape(scene.get(), numbers[0], numbers[1], is_allowed), what);
    }
  }

  /** The number of an own body or a ghost; false where there is none. */
  bool number(uint64_t key, uint32_t* number) const {
    const auto found = own.find(key);
    const auto ghost = ghosts.find(key);
    if (found != own.end())
      *number = found->second.number;
    else if (ghost != ghosts.end())
      *number = ghost->second.number;
    else
      return false;
    return true;
  }

 private:
  void let_go(uint64_t key, Own* body) {
    if (attachment != nullptr) attachment->remove(key);
    fault.check(rayc_scene_remove_body(scene.get(), body->number), "body of key " + std::to_string(key));
    named.erase(body->number);
    own.erase(key);
  }

 public:
  void remove_ghost(std::map<uint64_t, Ghost>::iterator ghost) {
    if (attachment != nullptr) attachment->remove(ghost->first);
    fault.check(rayc_scene_remove_body(scene.get(), ghost->second.number),
                "ghost of key " + std::to_string(ghost->first));
    named.erase(ghost->second.number);
    ghosts.erase(ghost);
  }

  /** Keeps a packed mesh; gives what it is known by. */
  uint64_t keep(Bytes packed) {
    uint64_t checksum = 0;
    for (std::size_t i = 0; i < 8; ++i) checksum |= uint64_t{packed[packed.size() - 8 + i]} << (8 * i);
    shapes[checksum].packed = std::move(packed);
    return checksum;
  }

  /** Adds a body that another rank has described, at the positions of its mesh's creation; gives its number. */
  bool add_received(uint64_t key, uint64_t shape_name, uint32_t* number) {
    const std::string what = "body of key " + std::to_string(key) + " from another rank";
    Shape& shape = shapes[shape_name];
    if (!shape.mesh) {
      rayc_mesh* mesh = nullptr;
      if (!fault.check(rayc_mesh_unpack(shape.packed.size(), shape.packed.data(), &mesh), what)) return false;
      shape.mesh.reset(mesh);
    }
    return fault.check(rayc_scene_add_mesh_with_key(scene.get(), shape.mesh.get(), key, number), what);
  }

  /** Writes what a shape is known by, and the shape itself the first time. */
  void write_shape(Bytes& message, uint64_t name, int rank) {
    Shape& shape = shapes[name];
    const uint64_t length = shape.known_to.insert(rank).second ? shape.packed.size() : 0;
    write(message, name);
    write(message, length);
    write(message, shape.packed.data(), length);
  }

  /** `from` keeps what it has sent, and need not be sent it. */
  uint64_t read_shape(Reader& message, int from) {
    const auto name = message.read<uint64_t>();
    const auto length = message.read<uint64_t>();
    if (length != 0) {
      shapes[name].packed = message.read_all<unsigned char>(length);
      shapes[name].known_to.insert(from);
    }
    return name;
  }
};

}  // namespace raycontact::mpi_detail

#endif  // RAYCONTACT_MPI_BODIES_HPP
