// SPDX-License-Identifier: MIT OR Apache-2.0
/** Whether each key is on one rank only. */
#ifndef RAYCONTACT_MPI_KEYS_HPP
#define RAYCONTACT_MPI_KEYS_HPP

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "raycontact/mpi/bodies.hpp"

namespace raycontact::mpi_detail {

/** Each key is looked at by one rank, which sees whether two others have it. New bodies that do are taken back. */
inline Fault check_keys(const Communicator& comm, Bodies& bodies, int tag) {
  const auto size = static_cast<uint64_t>(comm.size());
  Fault fault;
  std::vector<Bytes> keys(size);
  for (const auto& [key, body] : bodies.own) write(keys[key % size], key);
  const std::vector<Bytes> received = comm.swap_all(keys, tag, fault);
  std::map<uint64_t, std::vector<std::size_t>> owners;
  for (std::size_t rank = 0; rank < received.size(); ++rank)
    for (Reader reader(received[rank]); !reader.is_at_end();) owners[reader.read<uint64_t>()].push_back(rank);
  std::vector<Bytes> twice(size);
  for (const auto& [key, ranks] : owners) {
    if (ranks.size() == 1) continue;
    fault.note(RAYC_STATUS_BODY_ON_TWO_RANKS, "body of key " + std::to_string(key) + " is on the ranks " +
                                                  std::to_string(ranks[0]) + " and " + std::to_string(ranks[1]) +
                                                  "; add it on one of them only");
    for (std::size_t rank : ranks) write(twice[rank], key);
  }
  for (const Bytes& message : comm.swap_all(twice, tag, fault))
    for (Reader reader(message); !reader.is_at_end();) {
      const auto key = reader.read<uint64_t>();
      if (bodies.own.at(key).is_new) bodies.let_go(key);
    }
  fault = comm.agree(fault);
  if (!fault) {
    for (auto& [key, body] : bodies.own) body.is_new = false;
    bodies.has_new = false;
  }
  return fault;
}

}  // namespace raycontact::mpi_detail

#endif  // RAYCONTACT_MPI_KEYS_HPP
