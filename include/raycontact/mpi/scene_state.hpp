// SPDX-License-Identifier: MIT OR Apache-2.0
/** What a distributed scene is made of. */
#ifndef RAYCONTACT_MPI_SCENE_STATE_HPP
#define RAYCONTACT_MPI_SCENE_STATE_HPP

#include <cstddef>
#include <string>
#include <vector>

#include "raycontact/mpi/step.hpp"

namespace raycontact {

/** What all ranks of a distributed scene must agree on; only the scene's threads may differ. */
struct DistributedOptions {
  rayc_scene_options scene = default_scene_options();              ///< precision and threads
  rayc_detection_options detection = default_detection_options();  ///< how contacts are found
  rayc_response_options response = default_response_options();     ///< how they push
};

namespace mpi_detail {

struct SceneState {
  SceneState(MPI_Comm host, const DistributedOptions& given)
      : comm(host),
        options(given),
        step(comm, bodies, options.response, options.scene.precision == RAYC_SCALAR_F32, traffic) {}

  Communicator comm;
  DistributedOptions options;
  Bodies bodies;
  Traffic traffic;
  Step step;
  std::vector<KeyedMemory> waiting;
};

inline Error error(const Fault& fault) { return Error(static_cast<rayc_status>(fault.status), fault.message); }

/** Whether all ranks have the options of the first. */
inline Fault compare(const Communicator& comm, const DistributedOptions& options) {
  const rayc_detection_options& detection = options.detection;
  const rayc_response_options& response = options.response;
  const double own[] = {double(options.scene.precision), double(detection.sampling), detection.sampling_value,
                        double(detection.edges),         double(detection.escape),   double(detection.past_folds),
                        double(detection.law),           response.stiffness,         response.damping_time,
                        double(response.weighting)};
  constexpr std::size_t count = sizeof own / sizeof *own;
  double firsts[count];
  for (std::size_t i = 0; i < count; ++i) firsts[i] = own[i];
  MPI_Bcast(firsts, count, MPI_DOUBLE, 0, comm.get());
  Fault fault;
  for (std::size_t i = 0; i < count; ++i)
    if (firsts[i] != own[i])
      fault.note(RAYC_STATUS_RANKS_DISAGREE, "an option is " + std::to_string(own[i]) + " here and " +
                                                 std::to_string(firsts[i]) + " on rank 0; give all ranks the same");
  return comm.agree(fault);
}

}  // namespace mpi_detail
}  // namespace raycontact

#endif  // RAYCONTACT_MPI_SCENE_STATE_HPP
