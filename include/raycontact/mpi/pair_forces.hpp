// SPDX-License-Identifier: MIT OR Apache-2.0
/** Forces of a step: summed pair by pair where pairs are found, sent back to the owners of ghosts, added in one order.
 */
#ifndef RAYCONTACT_MPI_PAIR_FORCES_HPP
#define RAYCONTACT_MPI_PAIR_FORCES_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "raycontact/mpi/bodies.hpp"
#include "raycontact/mpi/traffic.hpp"

namespace raycontact::mpi_detail {

class PairForces {
 public:
  PairForces(const Communicator& comm, Bodies& bodies, const rayc_response_options& response, bool is_single,
             Traffic& traffic)
      : comm_(comm), bodies_(bodies), response_(response), is_single_(is_single), traffic_(traffic) {}

  void sum(Fault& fault) {
    std::vector<rayc_vectors> velocities;
    if (response_.damping_time > 0) {
      for (const auto& [number, body] : bodies_.named) {
        if (velocities.size() <= number) velocities.resize(number + 1, vectors<double>(nullptr, 0));
        velocities[number] = vectors(body.own != nullptr ? body.own->velocities : body.ghost->velocities);
      }
    }
    std::size_t pair_count = 0, force_count = 0;
    fault.check(
        rayc_contacts_sum_pair_forces(bodies_.contacts.get(), &response_, velocities.size(), nullptr,
                                      velocities.empty() ? nullptr : velocities.data(), &pair_count, &force_count),
        "forces");
    pairs_.resize(pair_count);
    forces_.resize(force_count);
    fault.check(
        rayc_contacts_copy_pair_forces(bodies_.contacts.get(), pair_count, pairs_.data(), force_count, forces_.data()),
        "forces");
    if (fault) pairs_.clear();
  }

  /** What a pair does to a ghost goes to its owner, which adds it in the order of the keys as if it had found it
   * itself. */
  void send_back(const Keys& lent, const Keys& borrowed, Fault& fault) {
    for (auto& [key, body] : bodies_.own) body.parts.clear();
    std::map<int, Bytes> messages;
    for (const auto& [rank, keys] : borrowed) messages[rank];
    for (const rayc_pair_forces& pair : pairs_) {
      const Named &first = bodies_.named.at(pair.first), &second = bodies_.named.at(pair.second);
      give(first, second.key, pair.start, pair.first_count, borrowed, messages);
      if (pair.first != pair.second)
        give(second, first.key, pair.start + pair.first_count, pair.second_count, borrowed, messages);
    }
    std::vector<Bytes> sent;
    for (auto& [rank, message] : messages) {
      traffic_.force_bytes += message.size();
      sent.push_back(std::move(message));
    }
    const std::vector<int> from = ranks(lent);
    const std::vector<Bytes> received = comm_.swap(ranks(borrowed), sent, from, TAG_FORCES, fault);
    for (std::size_t i = 0; i < from.size(); ++i) {
      const std::vector<uint64_t> keys(lent.at(from[i]).begin(), lent.at(from[i]).end());
      for (Reader reader(received[i]); !reader.is_at_end();) {
        const uint64_t key = keys[static_cast<std::size_t>(reader.read_whole())];
        const auto other = reader.read<uint64_t>();
        const auto count = static_cast<std::size_t>(reader.read_whole());
        bodies_.own.at(key).parts.push_back(Part{other, forces_.size(), count});
        uint32_t vertex = 0;
        for (std::size_t k = 0; k < count; ++k) {
          rayc_vertex_force force{};
          force.vertex = vertex += static_cast<uint32_t>(reader.read_whole());
          reader.read_numbers(force.force, 3, is_single_);
          forces_.push_back(force);
        }
      }
    }
  }

  void add() {
    for (auto& [key, body] : bodies_.own) {
      std::fill(body.forces.begin(), body.forces.end(), 0.0);
      std::sort(body.parts.begin(), body.parts.end(), [](const Part& a, const Part& b) { return a.other < b.other; });
      for (const Part& part : body.parts)
        for (std::size_t i = part.start; i < part.start + part.count; ++i)
          for (std::size_t axis = 0; axis < 3; ++axis)
            body.forces[3 * std::size_t{forces_[i].vertex} + axis] += forces_[i].force[axis];
    }
  }

 private:
  void give(const Named& body, uint64_t other, std::size_t start, std::size_t count, const Keys& borrowed,
            std::map<int, Bytes>& messages) {
    if (body.own != nullptr) {
      body.own->parts.push_back(Part{other, start, count});
      return;
    }
    // Which of the bodies lent its owner knows too. Vertices ascend, so most are one byte from the one before.
    const std::set<uint64_t>& keys = borrowed.at(body.ghost->owner);
    Bytes& message = messages[body.ghost->owner];
    write_whole(message, static_cast<uint64_t>(std::distance(keys.begin(), keys.find(body.key))));
    write(message, other);
    write_whole(message, count);
    uint32_t vertex = 0;
    for (std::size_t i = start; i < start + count; ++i) {
      write_whole(message, forces_[i].vertex - vertex);
      vertex = forces_[i].vertex;
      write_numbers(message, forces_[i].force, 3, is_single_);
    }
  }

  const Communicator& comm_;
  Bodies& bodies_;
  const rayc_response_options& response_;
  bool is_single_;
  Traffic& traffic_;
  std::vector<rayc_pair_forces> pairs_;
  std::vector<rayc_vertex_force> forces_;
};

}  // namespace raycontact::mpi_detail

#endif  // RAYCONTACT_MPI_PAIR_FORCES_HPP
