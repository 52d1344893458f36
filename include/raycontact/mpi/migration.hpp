// SPDX-License-Identifier: MIT OR Apache-2.0
/** Bodies that change ranks, and with them what their pairs remember. */
#ifndef RAYCONTACT_MPI_MIGRATION_HPP
#define RAYCONTACT_MPI_MIGRATION_HPP

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "raycontact/mpi/step.hpp"

namespace raycontact::mpi_detail {

class Migration {
 public:
  Migration(const Communicator& comm, Bodies& bodies, Step& step, std::vector<KeyedMemory>& waiting)
      : comm_(comm), bodies_(bodies), step_(step), waiting_(waiting) {}

  /** `owners`: the new rank of each own body, in the order of their keys. */
  template <class Pack, class Unpack>
  Fault run(const std::vector<int>& owners, Pack& pack, Unpack& unpack) {
    Fault fault = std::exchange(bodies_.fault, Fault());
    if (owners.size() != bodies_.own.size())
      fault.note(RAYC_STATUS_WRONG_COUNT, "there are " + std::to_string(owners.size()) + " owners for " +
                                              std::to_string(bodies_.own.size()) + " bodies; give one for each");
    for (int owner : owners)
      if (owner < 0 || owner >= comm_.size())
        fault.note(RAYC_STATUS_UNKNOWN_RANK, "rank " + std::to_string(owner) + " is to own a body, but there are " +
                                                 std::to_string(comm_.size()) + " ranks, numbered from 0");
    if (bodies_.is_busy("bodies change ranks")) fault.take(bodies_.fault);
    if (Fault agreed = comm_.agree(fault)) return agreed;
    new_owners_.clear();
    std::size_t place = 0;
    for (const auto& [key, body] : bodies_.own) new_owners_[key] = owners[place++];
    tell_new_owners(fault);
    std::vector<Bytes> messages(static_cast<std::size_t>(comm_.size())), of_attachment(messages.size());
    send_memories(messages, fault);
    if (bodies_.attachment != nullptr) {
      const auto finder = [this, &fault](uint64_t first, uint64_t second) { return find_finder(first, second, fault); };
      bodies_.attachment->write_memories(of_attachment, finder, fault);
    }
    for (std::size_t rank = 0; rank < messages.size(); ++rank) write_part(messages[rank], of_attachment[rank]);
    send_bodies(messages, pack);
    step_.drop_ghosts();
    const std::vector<Bytes> received = comm_.swap_all(messages, TAG_MIGRATION, fault);
    for (std::size_t rank = 0; rank < received.size(); ++rank) receive(received[rank], static_cast<int>(rank), unpack);
    fault.take(bodies_.fault);
    return comm_.agree(fault);
  }

 private:
  /** Whoever has a body as a ghost finds contacts of it, and must know who is to find them from now on. */
  void tell_new_owners(Fault& fault) {
    std::vector<int> to, from;
    std::vector<Bytes> messages;
    for (const auto& [rank, keys] : step_.lent()) {
      Bytes message;
      for (uint64_t key : keys) {
        const auto owner = new_owners_.find(key);
        if (owner == new_owners_.end()) continue;  // removed since
        write(message, key);
        write(message, owner->second);
      }
      to.push_back(rank);
      messages.push_back(std::move(message));
    }
    for (const auto& [rank, keys] : step_.borrowed()) from.push_back(rank);
    for (const Bytes& message : comm_.swap(to, messages, from, TAG_OWNERS, fault))
      for (Reader reader(message); !reader.is_at_end();) {
        const auto key = reader.read<uint64_t>();
        new_owners_[key] = reader.read<int>();
      }
  }

  /** The rank that is to find a pair, or -1 where a body is gone. */
  int find_finder(uint64_t first_key, uint64_t second_key, Fault& fault) const {
    const auto first = new_owners_.find(first_key), second = new_owners_.find(second_key);
    if (first == new_owners_.end() || second == new_owners_.end()) return -1;
    uint32_t first_finds = 1;
    if (first_key != second_key) fault.check(rayc_finds_pair(first_key, second_key, &first_finds), "keys of a pair");
    return first_finds != 0 ? first->second : second->second;
  }

  static void write_part(Bytes& message, const Bytes& part) {
    write(message, uint64_t{part.size()});
    write(message, part.data(), part.size());
  }

  static Bytes read_part(Reader& reader) {
    return reader.read_all<unsigned char>(static_cast<std::size_t>(reader.read<uint64_t>()));
  }

  void send_memories(std::vector<Bytes>& messages, Fault& fault) {
    std::vector<KeyedMemory> all = std::exchange(waiting_, {});
    step_.copy_memories(all, fault);
    std::vector<Bytes> with_count(messages.size());
    std::vector<uint64_t> counts(messages.size());
    for (const KeyedMemory& keyed : all) {
      const int rank = find_finder(keyed.first, keyed.second, fault);
      if (rank < 0) continue;
      const auto finder = static_cast<std::size_t>(rank);
      ++counts[finder];
      write(with_count[finder], keyed);
    }
    for (std::size_t rank = 0; rank < messages.size(); ++rank) {
      write(messages[rank], counts[rank]);
      write(messages[rank], with_count[rank].data(), with_count[rank].size());
    }
  }

  template <class Pack>
  void send_bodies(std::vector<Bytes>& messages, Pack& pack) {
    for (auto at = bodies_.own.begin(); at != bodies_.own.end();) {
      const auto& [key, body] = *at++;
      const int owner = new_owners_.at(key);
      if (owner == comm_.rank()) continue;
      Bytes& message = messages[static_cast<std::size_t>(owner)];
      write(message, key);
      bodies_.write_shape(message, body.shape, owner);
      write(message, uint64_t{body.collides_with_itself});
      write(message, body.cost);
      write(message, uint64_t{body.vertex_count});
      write(message, body.positions.data(), body.positions.size());
      write(message, body.velocities.data(), body.velocities.size());
      write_part(message, pack(uint64_t{key}));
      Bytes of_attachment;
      if (bodies_.attachment != nullptr) bodies_.attachment->write_body(of_attachment, key);
      write_part(message, of_attachment);
      bodies_.settings.write_body(message, key);
      bodies_.let_go(uint64_t{key});
    }
  }

  template <class Unpack>
  void receive(const Bytes& message, int from, Unpack& unpack) {
    Reader reader(message);
    if (reader.is_at_end()) return;
    const auto count = static_cast<std::size_t>(reader.read<uint64_t>());
    for (const KeyedMemory& keyed : reader.read_all<KeyedMemory>(count)) waiting_.push_back(keyed);
    const Bytes memories = read_part(reader);
    if (bodies_.attachment != nullptr) bodies_.attachment->read_memories(memories);
    while (!reader.is_at_end()) {
      const auto key = reader.read<uint64_t>();
      Own body;
      body.shape = bodies_.read_shape(reader, from);
      body.is_new = false;
      body.collides_with_itself = reader.read<uint64_t>() != 0;
      body.cost = reader.read<double>();
      body.vertex_count = static_cast<std::size_t>(reader.read<uint64_t>());
      body.positions = reader.read_all<double>(3 * body.vertex_count);
      body.velocities = reader.read_all<double>(3 * body.vertex_count);
      body.forces.resize(3 * body.vertex_count);
      const Bytes of_host = read_part(reader), of_attachment = read_part(reader);
      bodies_.settings.read_body(reader, key);
      if (!bodies_.add_received(key, body.shape, &body.number)) continue;
      const std::string what = "body of key " + std::to_string(key);
      const rayc_vectors view = vectors(body.positions);
      bodies_.fault.check(rayc_scene_set_positions(bodies_.scene.get(), body.number, &view), what);
      bodies_.fault.check(
          rayc_scene_set_self_collision(bodies_.scene.get(), body.number, body.collides_with_itself ? 1 : 0), what);
      Own& added = bodies_.own[key] = std::move(body);
      bodies_.named[added.number] = Named{key, &added, nullptr};
      if (bodies_.attachment != nullptr) bodies_.attachment->read_body(of_attachment, key, added.number, bodies_.fault);
      unpack(uint64_t{key}, of_host);
    }
  }

  const Communicator& comm_;
  Bodies& bodies_;
  Step& step_;
  std::vector<KeyedMemory>& waiting_;
  std::map<uint64_t, int> new_owners_;
};

}  // namespace raycontact::mpi_detail

#endif  // RAYCONTACT_MPI_MIGRATION_HPP
