// SPDX-License-Identifier: MIT OR Apache-2.0
/** What else a rank knows of its bodies and of ghosts, and goes where they go: that of a contact system. */
#ifndef RAYCONTACT_MPI_ATTACHMENT_HPP
#define RAYCONTACT_MPI_ATTACHMENT_HPP

#include <cstdint>
#include <functional>
#include <set>
#include <vector>

#include "raycontact/mpi/bytes.hpp"
#include "raycontact/mpi/communicator.hpp"
#include "raycontact/mpi/pair_settings.hpp"

namespace raycontact::mpi_detail {

class Attachment {
 public:
  virtual ~Attachment() = default;

  /** Whether a step is under way. */
  bool is_busy = false;

  /** What a rank that has the body as a ghost needs in this step; `is_known`: it had it in the step before too, or
   * where the step is under way, in it. */
  virtual void write_ghost(Bytes& message, uint64_t key, bool is_known) = 0;
  /** Gives whether the ghost is told of anew. */
  virtual bool read_ghost(Reader& message, uint64_t key, uint32_t number, Fault& fault) = 0;
  /** These ghosts, by number, are going to be removed; what their pairs remember waits for the end of the step. */
  virtual void keep_memories(const std::set<uint32_t>& ghosts, Fault& fault) = 0;
  /** By numbers. */
  virtual void set_pair_material(uint32_t first, uint32_t second, const PairSetting& setting, Fault& fault) = 0;

  /** All of a body that changes ranks. */
  virtual void write_body(Bytes& message, uint64_t key) = 0;
  virtual void read_body(const Bytes& message, uint64_t key, uint32_t number, Fault& fault) = 0;

  /** The body, or ghost, leaves this rank; the scene still has it. */
  virtual void remove(uint64_t key) = 0;

  /** What pairs remember; `finder` gives the rank that is to find a pair, or -1 where one of the two is gone. */
  using Finder = std::function<int(uint64_t, uint64_t)>;
  virtual void write_memories(std::vector<Bytes>& to_ranks, const Finder& finder, Fault& fault) = 0;
  virtual void read_memories(const Bytes& message) = 0;

  /** A number for all that must be equal on all ranks. */
  virtual uint64_t checksum() const = 0;
};

}  // namespace raycontact::mpi_detail

#endif  // RAYCONTACT_MPI_ATTACHMENT_HPP
