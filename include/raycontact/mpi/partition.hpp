// SPDX-License-Identifier: MIT OR Apache-2.0
/** Which rank is to have which body: Zoltan's recursive coordinate bisection, weighted by what bodies cost. */
#ifndef RAYCONTACT_MPI_PARTITION_HPP
#define RAYCONTACT_MPI_PARTITION_HPP

#include <zoltan.h>

#include <array>
#include <cstddef>
#include <vector>

#include "raycontact/mpi/communicator.hpp"

namespace raycontact::mpi_detail {

/** A body as Zoltan sees it. */
struct Weighed {
  std::array<double, 3> centre{};
  double cost = 0;
};

class Partition {
 public:
  /** The new owner of each of this rank's bodies; as they are where Zoltan fails. */
  static std::vector<int> of(const Communicator& comm, const std::vector<Weighed>& bodies, Fault& fault) {
    std::vector<int> owners(bodies.size(), comm.rank());
    float version = 0;
    Zoltan_Struct* zoltan = Zoltan_Initialize(0, nullptr, &version) == ZOLTAN_OK ? Zoltan_Create(comm.get()) : nullptr;
    if (zoltan == nullptr) {
      fault.note(RAYC_STATUS_MPI_FAILED, "Zoltan does not start; is it built for this MPI?");
      return owners;
    }
    const std::array<std::array<const char*, 2>, 6> parameters = {{{"DEBUG_LEVEL", "0"},
                                                                   {"LB_METHOD", "RCB"},
                                                                   {"NUM_GID_ENTRIES", "2"},
                                                                   {"NUM_LID_ENTRIES", "1"},
                                                                   {"OBJ_WEIGHT_DIM", "1"},
                                                                   {"RETURN_LISTS", "EXPORT"}}};
    for (const auto& [name, value] : parameters) Zoltan_Set_Param(zoltan, name, value);
    Data data{&bodies, comm.rank()};
    Zoltan_Set_Num_Obj_Fn(zoltan, count, &data);
    Zoltan_Set_Obj_List_Fn(zoltan, list, &data);
    Zoltan_Set_Num_Geom_Fn(zoltan, dimensions, &data);
    Zoltan_Set_Geom_Multi_Fn(zoltan, positions, &data);
    int has_changed = 0, global_entries = 0, local_entries = 0, import_count = 0, export_count = 0;
    ZOLTAN_ID_PTR imports = nullptr, local_imports = nullptr, exports = nullptr, local_exports = nullptr;
    int *import_ranks = nullptr, *import_parts = nullptr, *export_ranks = nullptr, *export_parts = nullptr;
    const int status = Zoltan_LB_Partition(zoltan, &has_changed, &global_entries, &local_entries, &import_count,
                                           &imports, &local_imports, &import_ranks, &import_parts, &export_count,
                                           &exports, &local_exports, &export_ranks, &export_parts);
    if (status == ZOLTAN_OK || status == ZOLTAN_WARN)
      for (int i = 0; i < export_count; ++i) owners[local_exports[i]] = export_ranks[i];
    else
      fault.note(RAYC_STATUS_MPI_FAILED, "Zoltan found no partition (" + std::to_string(status) + ")");
    Zoltan_LB_Free_Part(&imports, &local_imports, &import_ranks, &import_parts);
    Zoltan_LB_Free_Part(&exports, &local_exports, &export_ranks, &export_parts);
    Zoltan_Destroy(&zoltan);
    return owners;
  }

 private:
  struct Data {
    const std::vector<Weighed>* bodies;
    int rank;
  };

  static const Data& of_host(void* data) { return *static_cast<const Data*>(data); }

  static int count(void* data, int* status) {
    *status = ZOLTAN_OK;
    return static_cast<int>(of_host(data).bodies->size());
  }

  /** Objects are known by their rank and their place there. */
  static void list(void* data, int, int, ZOLTAN_ID_PTR global, ZOLTAN_ID_PTR local, int, float* weights, int* status) {
    const std::vector<Weighed>& bodies = *of_host(data).bodies;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      global[2 * i] = static_cast<ZOLTAN_ID_TYPE>(of_host(data).rank);
      global[2 * i + 1] = local[i] = static_cast<ZOLTAN_ID_TYPE>(i);
      weights[i] = static_cast<float>(bodies[i].cost);
    }
    *status = ZOLTAN_OK;
  }

  static int dimensions(void*, int* status) {
    *status = ZOLTAN_OK;
    return 3;
  }

  static void positions(void* data, int, int, int object_count, ZOLTAN_ID_PTR, ZOLTAN_ID_PTR local, int, double* out,
                        int* status) {
    const std::vector<Weighed>& bodies = *of_host(data).bodies;
    for (int i = 0; i < object_count; ++i)
      for (std::size_t axis = 0; axis < 3; ++axis)
        out[3 * static_cast<std::size_t>(i) + axis] = bodies[local[i]].centre[axis];
    *status = ZOLTAN_OK;
  }
};

}  // namespace raycontact::mpi_detail

#endif  // RAYCONTACT_MPI_PARTITION_HPP
