// SPDX-License-Identifier: MIT OR Apache-2.0
#include <mpi.h>
#include <zoltan.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <numeric>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "drifters.hpp"
#include "raycontact/mpi.hpp"

namespace {

const char* const usage =
    "usage: distributed_parts BODIES PARTS\n"
    "\n"
    "Divides the bodies of the demo distributed, as many as are wanted, into parts as ranks would, by Zoltan's "
    "recursive\n"
    "coordinate bisection weighted by how much their boxes share, and counts for each part what its rank would find, "
    "lend and send. Prints "
    "a\n"
    "row for each part, as comma-separated values. No contact is looked for: only boxes are.\n"
    "\n"
    "  BODIES   up to ten million\n"
    "  PARTS    up to as many\n"
    "  --help   this text\n"
    "\n"
    "Exit status: 0 done, 1 something failed, 2 wrong usage.\n";

using raycontact::mpi_detail::Box;

/** A tenth of the bodies are small ones inside others; all have drifted for some steps as if they met nobody. */
std::vector<Box> boxes_of(uint64_t count) {
  std::vector<Box> boxes(count);
  for (uint64_t key = 0; key < count; ++key) {
    const demo::Drifter body = demo::drifter(key, count);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double reach = (axis == 1 ? 0.4 : 1.4) * (demo::is_small(key) ? 0.12 : 1);
      const double middle = body.place[axis] + 3 * demo::drift_step * body.velocity[axis];
      boxes[key].lower[axis] = middle - reach;
      boxes[key].upper[axis] = middle + reach;
    }
  }
  return boxes;
}

using Pairs = std::vector<std::pair<uint32_t, uint32_t>>;

/** Boxes that overlap: sought in the cells of a grid, none of which is smaller than a box. */
Pairs pairs_of(const std::vector<Box>& boxes) {
  const std::array<double, 3> size = {2.8, 0.8, 2.8};
  Box all;
  for (const Box& box : boxes) all.include(box);
  std::array<int64_t, 3> counts{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    counts[axis] = static_cast<int64_t>((all.upper[axis] - all.lower[axis]) / size[axis]) + 3;
  const auto cell_of = [&](const Box& box) {
    int64_t cell = 0;
    for (std::size_t axis = 3; axis-- > 0;)
      cell = cell * counts[axis] + static_cast<int64_t>((box.lower[axis] - all.lower[axis]) / size[axis]) + 1;
    return cell;
  };
  std::vector<uint32_t> starts(static_cast<std::size_t>(counts[0] * counts[1] * counts[2]) + 1), order(boxes.size());
  std::vector<int64_t> cells;
  for (const Box& box : boxes) ++starts[static_cast<std::size_t>(cells.emplace_back(cell_of(box))) + 1];
  std::partial_sum(starts.begin(), starts.end(), starts.begin());
  std::vector<uint32_t> next = starts;
  for (uint32_t i = 0; i < boxes.size(); ++i) order[next[static_cast<std::size_t>(cells[i])]++] = i;
  Pairs pairs;
  for (uint32_t i = 0; i < boxes.size(); ++i)
    for (int64_t k = 0; k < 27; ++k) {
      const int64_t by = (k % 3 - 1) + counts[0] * ((k / 3 % 3 - 1) + counts[1] * (k / 9 - 1));
      const auto cell = static_cast<std::size_t>(cells[i] + by);
      for (uint32_t at = starts[cell]; at < starts[cell + 1]; ++at)
        if (order[at] > i && boxes[i].overlaps(boxes[order[at]])) pairs.emplace_back(i, order[at]);
    }
  return pairs;
}

/** How much of space two bodies' boxes share: they cast about as many rays into one another. */
double overlap(const Box& a, const Box& b) {
  double volume = 1;
  for (std::size_t axis = 0; axis < 3; ++axis)
    volume *= std::min(a.upper[axis], b.upper[axis]) - std::max(a.lower[axis], b.lower[axis]);
  return volume;
}

struct Objects {
  const std::vector<Box>& boxes;
  std::vector<float> weights;
};

void check(int status, const char* what) {
  if (status != ZOLTAN_OK && status != ZOLTAN_WARN) throw std::runtime_error(std::string(what) + ": Zoltan failed");
}

/** The part of each body. */
std::vector<int> divide(Objects& objects, int parts) {
  Zoltan_Struct* zoltan = Zoltan_Create(MPI_COMM_SELF);
  if (zoltan == nullptr) throw std::runtime_error("Zoltan does not start");
  const std::string count = std::to_string(parts);
  const char* const parameters[][2] = {
      {"DEBUG_LEVEL", "0"},     {"LB_METHOD", "RCB"},    {"NUM_GLOBAL_PARTS", count.c_str()},
      {"NUM_GID_ENTRIES", "1"}, {"OBJ_WEIGHT_DIM", "1"}, {"RETURN_LISTS", "PARTS"}};
  for (const auto& [name, value] : parameters) check(Zoltan_Set_Param(zoltan, name, value), name);
  Zoltan_Set_Num_Obj_Fn(
      zoltan,
      [](void* data, int* status) {
        *status = ZOLTAN_OK;
        return static_cast<int>(static_cast<Objects*>(data)->boxes.size());
      },
      &objects);
  Zoltan_Set_Obj_List_Fn(
      zoltan,
      [](void* data, int, int, ZOLTAN_ID_PTR global, ZOLTAN_ID_PTR local, int, float* weights, int* status) {
        const Objects& all = *static_cast<Objects*>(data);
        for (std::size_t i = 0; i < all.boxes.size(); ++i) {
          global[i] = local[i] = static_cast<ZOLTAN_ID_TYPE>(i);
          weights[i] = all.weights[i];
        }
        *status = ZOLTAN_OK;
      },
      &objects);
  Zoltan_Set_Num_Geom_Fn(
      zoltan,
      [](void*, int* status) {
        *status = ZOLTAN_OK;
        return 3;
      },
      nullptr);
  Zoltan_Set_Geom_Fn(
      zoltan,
      [](void* data, int, int, ZOLTAN_ID_PTR global, ZOLTAN_ID_PTR, double* middle, int* status) {
        const Box& box = static_cast<Objects*>(data)->boxes[*global];
        for (std::size_t axis = 0; axis < 3; ++axis) middle[axis] = (box.lower[axis] + box.upper[axis]) / 2;
        *status = ZOLTAN_OK;
      },
      &objects);
  int changes = 0, global_size = 0, local_size = 0, import_count = 0, export_count = 0;
  ZOLTAN_ID_PTR imports = nullptr, local_imports = nullptr, exports = nullptr, local_exports = nullptr;
  int *from = nullptr, *import_parts = nullptr, *to = nullptr, *export_parts = nullptr;
  check(Zoltan_LB_Partition(zoltan, &changes, &global_size, &local_size, &import_count, &imports, &local_imports, &from,
                            &import_parts, &export_count, &exports, &local_exports, &to, &export_parts),
        "division");
  std::vector<int> owners(objects.boxes.size());
  for (int i = 0; i < export_count; ++i) owners[exports[i]] = export_parts[i];
  Zoltan_LB_Free_Part(&imports, &local_imports, &from, &import_parts);
  Zoltan_LB_Free_Part(&exports, &local_exports, &to, &export_parts);
  Zoltan_Destroy(&zoltan);
  return owners;
}

struct Part {
  uint64_t bodies = 0, pairs = 0, ghost_pairs = 0, given_pairs = 0, ghosts = 0, lent = 0, headers = 0;
  double overlap = 0;
  Box box;
  std::set<int> neighbours;
};

void count(uint64_t body_count, int part_count) {
  const std::vector<Box> boxes = boxes_of(body_count);
  const Pairs pairs = pairs_of(boxes);
  Objects objects{boxes, std::vector<float>(boxes.size(), 1e-3f)};
  for (const auto& [first, second] : pairs)
    for (uint32_t body : {first, second})
      objects.weights[body] += static_cast<float>(overlap(boxes[first], boxes[second]));
  const std::vector<int> owners = divide(objects, part_count);
  std::vector<Part> parts(static_cast<std::size_t>(part_count));
  const auto part_of = [&](uint32_t body) -> Part& { return parts[static_cast<std::size_t>(owners[body])]; };
  for (uint32_t body = 0; body < boxes.size(); ++body) {
    ++part_of(body).bodies;
    part_of(body).box.include(boxes[body]);
  }
  std::vector<std::pair<int, uint32_t>> ghosts;  // the part that has it, and the body
  for (auto [first, second] : pairs) {
    uint32_t first_finds = 1;
    if (owners[first] != owners[second]) rayc_finds_pair(first, second, &first_finds);
    if (first_finds == 0) std::swap(first, second);
    ++part_of(first).pairs;
    part_of(first).overlap += overlap(boxes[first], boxes[second]);
    if (owners[first] == owners[second]) continue;
    ++part_of(first).ghost_pairs;
    ++part_of(second).given_pairs;
    part_of(first).neighbours.insert(owners[second]);
    part_of(second).neighbours.insert(owners[first]);
    ghosts.emplace_back(owners[first], second);
  }
  std::sort(ghosts.begin(), ghosts.end());
  ghosts.erase(std::unique(ghosts.begin(), ghosts.end()), ghosts.end());
  for (const auto& [part, body] : ghosts) {
    ++parts[static_cast<std::size_t>(part)].ghosts;
    ++part_of(body).lent;
  }
  std::vector<std::vector<std::size_t>> near(parts.size());
  for (std::size_t i = 0; i < parts.size(); ++i)
    for (std::size_t k = 0; k < parts.size(); ++k)
      if (i != k && parts[i].box.overlaps(parts[k].box)) near[i].push_back(k);
  for (uint32_t body = 0; body < boxes.size(); ++body)
    for (std::size_t other : near[static_cast<std::size_t>(owners[body])])
      part_of(body).headers += boxes[body].overlaps(parts[other].box) ? 1 : 0;
  std::printf(
      "total_bodies,parts,part,bodies,pairs,ghost_pairs,given_pairs,ghosts,lent,headers,near,neighbours,overlap\n");
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Part& part = parts[i];
    std::printf("%llu,%d,%zu", static_cast<unsigned long long>(body_count), part_count, i);
    for (uint64_t number : {part.bodies, part.pairs, part.ghost_pairs, part.given_pairs, part.ghosts, part.lent,
                            part.headers, uint64_t{near[i].size()}, uint64_t{part.neighbours.size()}})
      std::printf(",%llu", static_cast<unsigned long long>(number));
    std::printf(",%.6g\n", part.overlap);
  }
}

int refuse(const std::string& what) {
  std::fprintf(stderr, "distributed_parts: %s\n\n%s", what.c_str(), usage);
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  for (int i = 1; i < argc; ++i)
    if (std::strcmp(argv[i], "--help") == 0) return std::fputs(usage, stdout), 0;
  for (int i = 1; i < argc; ++i)
    if (argv[i][0] == '-') return refuse(std::string("unknown option ") + argv[i]);
  if (argc != 3) return refuse("two numbers are needed");
  long numbers[2];
  for (int i = 0; i < 2; ++i) {
    char* end = nullptr;
    numbers[i] = std::strtol(argv[i + 1], &end, 10);
    if (*end != '\0' || numbers[i] < 1 || numbers[i] > (i == 0 ? 10000000 : numbers[0]))
      return refuse(std::string(argv[i + 1]) + " is no number of " + (i == 0 ? "bodies" : "parts"));
  }
  MPI_Init(&argc, &argv);
  float version = 0;
  int status = 0;
  try {
    check(Zoltan_Initialize(argc, argv, &version), "start");
    count(static_cast<uint64_t>(numbers[0]), static_cast<int>(numbers[1]));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "distributed_parts: %s\n", error.what());
    status = 1;
  }
  MPI_Finalize();
  return status;
}
