// SPDX-License-Identifier: MIT OR Apache-2.0
/** What friction remembers of pairs whose bodies are not both here now: it goes where they go. */
#ifndef RAYCONTACT_MPI_GRIPS_HPP
#define RAYCONTACT_MPI_GRIPS_HPP

#include <cstddef>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "raycontact/contact_system.hpp"
#include "raycontact/mpi/attachment.hpp"
#include "raycontact/mpi/bodies.hpp"

namespace raycontact::mpi_detail {

using SystemOwner = detail::Owner<rayc_contact_system, rayc_contact_system_destroy>;

/** What a pair's friction remembers, by keys; a half-space by its number. */
struct GripMemory {
  uint64_t first = 0, second = 0;
  uint64_t is_half_space = 0;
  Bytes bytes;
};

class Grips {
 public:
  Grips(const Bodies& bodies, rayc_contact_system* system) : bodies_(bodies), system_(system) {}

  /** Gives back what waits to all pairs that are here now. The others may meet again as long as the step lasts. */
  void put(Fault& fault) {
    std::vector<GripMemory> others;
    for (GripMemory& grip : waiting_) {
      rayc_contact_memory pair{};
      pair.second = static_cast<uint32_t>(grip.second);
      const bool is_here = bodies_.number(grip.first, &pair.first) &&
                           (grip.is_half_space != 0 || bodies_.number(grip.second, &pair.second));
      if (!is_here) {
        others.push_back(std::move(grip));
        continue;
      }
      pair.is_half_space = static_cast<uint32_t>(grip.is_half_space);
      pair.length = grip.bytes.size();
      fault.check(rayc_contact_system_put_memory(system_, &pair, grip.bytes.data()), "memory of a pair");
    }
    waiting_ = std::move(others);
  }

  /** The step has ended: pairs that have not met have forgotten. */
  void forget() { waiting_.clear(); }

  /** What pairs of these bodies, by number, remember, waits. */
  void keep(const std::set<uint32_t>& bodies, Fault& fault) {
    collect(fault, [&bodies](const rayc_contact_memory& pair) {
      return bodies.count(pair.first) != 0 || (pair.is_half_space == 0 && bodies.count(pair.second) != 0);
    });
  }

  /** All of it, to the ranks that are to find the pairs. */
  void write(std::vector<Bytes>& to_ranks, const Attachment::Finder& finder, Fault& fault) {
    collect(fault, [](const rayc_contact_memory&) { return true; });
    for (const GripMemory& grip : std::exchange(waiting_, {})) {
      const int rank = finder(grip.first, grip.is_half_space != 0 ? grip.first : grip.second);
      if (rank < 0) continue;
      Bytes& message = to_ranks[static_cast<std::size_t>(rank)];
      for (uint64_t number : {grip.first, grip.second, grip.is_half_space, uint64_t{grip.bytes.size()}})
        mpi_detail::write(message, number);
      mpi_detail::write(message, grip.bytes.data(), grip.bytes.size());
    }
  }

  void read(const Bytes& message) {
    for (Reader reader(message); !reader.is_at_end();) {
      GripMemory grip;
      grip.first = reader.read<uint64_t>();
      grip.second = reader.read<uint64_t>();
      grip.is_half_space = reader.read<uint64_t>();
      grip.bytes = reader.read_all<unsigned char>(static_cast<std::size_t>(reader.read<uint64_t>()));
      waiting_.push_back(std::move(grip));
    }
  }

 private:
  template <class Wanted>
  void collect(Fault& fault, Wanted wanted) {
    std::size_t count = 0;
    fault.check(rayc_contact_system_memory_count(system_, &count), "memories of pairs");
    std::vector<rayc_contact_memory> memories(count);
    fault.check(rayc_contact_system_copy_memories(system_, count, memories.data()), "memories of pairs");
    for (const rayc_contact_memory& memory : memories) {
      if (!wanted(memory)) continue;
      GripMemory grip;
      grip.first = bodies_.named.at(memory.first).key;
      grip.second = memory.is_half_space != 0 ? memory.second : bodies_.named.at(memory.second).key;
      grip.is_half_space = memory.is_half_space;
      grip.bytes.resize(memory.length);
      fault.check(rayc_contact_system_pack_memory(system_, &memory, grip.bytes.data()), "memory of a pair");
      waiting_.push_back(std::move(grip));
    }
  }

  const Bodies& bodies_;
  rayc_contact_system* system_;
  std::vector<GripMemory> waiting_;
};

}  // namespace raycontact::mpi_detail

#endif  // RAYCONTACT_MPI_GRIPS_HPP
