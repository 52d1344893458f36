// SPDX-License-Identifier: MIT OR Apache-2.0
/** What a distributed scene has sent, and how long its parts took. */
#ifndef RAYCONTACT_MPI_TRAFFIC_HPP
#define RAYCONTACT_MPI_TRAFFIC_HPP

#include <cstdint>

namespace raycontact {

/** What the exchange has taken on this rank since the scene was made. */
struct Traffic {
  uint64_t header_bytes = 0;     ///< sent, 56 for each body and neighbouring rank
  uint64_t position_bytes = 0;   ///< sent, of positions, and of velocities where there is damping
  uint64_t shape_bytes = 0;      ///< sent, of meshes: each once to a rank
  uint64_t force_bytes = 0;      ///< sent back to the owners of ghosts
  uint64_t part_bytes = 0;       ///< of a contact system: sent once a step, which unknowns of ghosts rows act on
  uint64_t product_bytes = 0;    ///< of a contact system: unknowns of ghosts there, and what acts on them back
  uint64_t ghosts = 0;           ///< ghosts, summed over all steps
  uint64_t ghost_pairs = 0;      ///< pairs of an own body and a ghost that this rank has looked at, over all steps
  uint64_t new_ghosts = 0;       ///< of these, those that were not there in the step before
  double query_seconds = 0;      ///< in the library's query
  double ghost_seconds = 0;      ///< in adding, moving and removing ghosts
  double processor_seconds = 0;  ///< that this process's threads have computed in queries and sums
  double sum_seconds = 0;        ///< in summing forces pair by pair
  double total_seconds = 0;      ///< in all of step(); what remains is exchange and waiting
};

}  // namespace raycontact

#endif  // RAYCONTACT_MPI_TRAFFIC_HPP
