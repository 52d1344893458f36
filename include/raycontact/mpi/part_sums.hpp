// SPDX-License-Identifier: MIT OR Apache-2.0
/** What pairs do to bodies, found on any rank and added on the body's own in one order. */
#ifndef RAYCONTACT_MPI_PART_SUMS_HPP
#define RAYCONTACT_MPI_PART_SUMS_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <tuple>
#include <vector>

#include "raycontact/mpi/carried.hpp"
#include "raycontact/mpi/step.hpp"

namespace raycontact::mpi_detail {

/** The parts of a step's rows: those that this rank's system has, and those of own bodies that other ranks' have. */
class PartSums {
 public:
  PartSums(const Communicator& comm, const Bodies& scene_bodies, const CarriedBodies& bodies, const Step& step,
           Traffic& traffic)
      : comm_(comm), scene_bodies_(scene_bodies), bodies_(bodies), step_(step), traffic_(traffic) {}

  /** The parts of this rank's system. */
  const std::vector<rayc_contact_part>& parts() const { return parts_; }
  /** How many blocks it has. */
  std::size_t block_count() const { return block_count_; }
  /** What they do, three numbers for each, or as many as is said below; those of other ranks behind them. */
  std::vector<double> values;

  /** After a step's begin, on all ranks: asks the system, and tells the owners of ghosts what will act on them. */
  void find(Fault& fault) {
    std::size_t part_count = 0;
    block_count_ = 0;
    fault.check(rayc_contact_system_part_count(bodies_.system(), &part_count, &block_count_), "parts");
    parts_.resize(part_count);
    blocks_.resize(block_count_);
    fault.check(
        rayc_contact_system_copy_parts(bodies_.system(), part_count, parts_.data(), block_count_, blocks_.data()),
        "parts");
    forget();
    if (fault) parts_.clear();
    std::map<int, Bytes> messages;
    for (const auto& [rank, keys] : step_.borrowed()) messages[rank];
    for (const rayc_contact_part& part : parts_) {
      const Named& body = scene_bodies_.named.at(part.body);
      const uint64_t other = part.is_half_space != 0 ? part.other : scene_bodies_.named.at(part.other).key;
      if (body.own != nullptr) {
        own_.push_back(OwnPart{body.key, part.is_half_space, other, part.start, part.count});
        continue;
      }
      given_[body.ghost->owner].push_back(Range{part.start, part.count});
      Bytes& message = messages[body.ghost->owner];
      for (uint64_t number : {body.key, other, uint64_t{part.count}}) write(message, number);
      const auto first = static_cast<uint32_t>(bodies_.start(body.key) / 3);
      for (std::size_t i = part.start; i < part.start + part.count; ++i) write(message, blocks_[i] - first);
    }
    std::vector<Bytes> sent;
    for (auto& [rank, message] : messages) {
      traffic_.part_bytes += message.size();
      sent.push_back(std::move(message));
    }
    const std::vector<int> from = ranks(step_.lent());
    const std::vector<Bytes> received = comm_.swap(ranks(step_.borrowed()), sent, from, TAG_PARTS, fault);
    for (std::size_t i = 0; i < from.size(); ++i)
      for (Reader reader(received[i]); !reader.is_at_end();) {
        const auto key = reader.read<uint64_t>(), other = reader.read<uint64_t>();
        const auto count = static_cast<std::size_t>(reader.read<uint64_t>());
        const auto first = static_cast<uint32_t>(bodies_.start(key) / 3);
        own_.push_back(OwnPart{key, 0, other, blocks_.size(), count});
        taken_[from[i]].push_back(Range{blocks_.size(), count});
        for (uint32_t block : reader.read_all<uint32_t>(count)) blocks_.push_back(first + block);
      }
    std::sort(own_.begin(), own_.end(), [](const OwnPart& a, const OwnPart& b) {
      return std::tie(a.key, a.is_half_space, a.other) < std::tie(b.key, b.is_half_space, b.other);
    });
    values.resize(3 * blocks_.size());
  }

  /** The step has ended. */
  void forget() {
    own_.clear();
    given_.clear();
    taken_.clear();
  }

  /** The unknowns of own bodies that other ranks' rows need go there, those of ghosts come; `width` numbers a block. */
  void spread(std::vector<double>& unknowns, Fault& fault, std::size_t width = 3) {
    std::vector<Bytes> messages;
    for (const auto& [rank, ranges] : taken_) {
      Bytes message;
      for (const Range& range : ranges)
        for (std::size_t i = range.start; i < range.start + range.count; ++i)
          write(message, &unknowns[width * std::size_t{blocks_[i]}], width);
      messages.push_back(std::move(message));
    }
    swap(taken_, messages, given_, fault, [&](const Range& range, Reader& reader) {
      for (std::size_t i = range.start; i < range.start + range.count; ++i)
        reader.read(&unknowns[width * std::size_t{blocks_[i]}], width);
    });
  }

  /** What this rank's rows do to ghosts goes to their owners, what other ranks' do to own bodies comes. */
  void collect(Fault& fault, std::size_t width = 3) {
    std::vector<Bytes> messages;
    for (const auto& [rank, ranges] : given_) {
      Bytes message;
      for (const Range& range : ranges) write(message, values.data() + width * range.start, width * range.count);
      messages.push_back(std::move(message));
    }
    swap(given_, messages, taken_, fault, [&](const Range& range, Reader& reader) {
      reader.read(values.data() + width * range.start, width * range.count);
    });
  }

  /** Adds all that acts on own bodies: by their keys, then by those of the others, then half-spaces. */
  template <class At>
  void add(At at, std::size_t width = 3) const {
    for (const OwnPart& part : own_)
      for (std::size_t i = part.start; i < part.start + part.count; ++i)
        for (std::size_t axis = 0; axis < width; ++axis)
          at(part.key, width * std::size_t{blocks_[i]} + axis) += values[width * i + axis];
  }

 private:
  struct OwnPart {
    uint64_t key;
    uint32_t is_half_space;
    uint64_t other;
    std::size_t start, count;
  };
  struct Range {
    std::size_t start, count;
  };
  using Ranges = std::map<int, std::vector<Range>>;

  template <class Read>
  void swap(const Ranges& to, const std::vector<Bytes>& messages, const Ranges& from, Fault& fault, Read read) {
    std::vector<int> receivers, senders;
    for (const auto& [rank, ranges] : to) receivers.push_back(rank);
    for (const auto& [rank, ranges] : from) senders.push_back(rank);
    for (const Bytes& message : messages) traffic_.product_bytes += message.size();
    const std::vector<Bytes> received = comm_.swap(receivers, messages, senders, TAG_PARTS, fault);
    std::size_t place = 0;
    for (const auto& [rank, ranges] : from) {
      Reader reader(received[place++]);
      for (const Range& range : ranges) read(range, reader);
    }
  }

  const Communicator& comm_;
  const Bodies& scene_bodies_;
  const CarriedBodies& bodies_;
  const Step& step_;
  Traffic& traffic_;
  std::vector<rayc_contact_part> parts_;
  std::size_t block_count_ = 0;
  std::vector<uint32_t> blocks_;  // of the rank's system, then of own bodies that other ranks' act on
  std::vector<OwnPart> own_;
  Ranges given_, taken_;
};

}  // namespace raycontact::mpi_detail

#endif  // RAYCONTACT_MPI_PART_SUMS_HPP
