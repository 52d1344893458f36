// What is wrong on one rank is said on all, each fault by its own status, and nothing has changed.
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "expect_fault.hpp"
#include "torus.hpp"

namespace {

/** One torus on each rank, in a row, each of which overlaps its neighbours. */
struct Row {
  raycontact::DistributedScene scene{MPI_COMM_WORLD};
  Torus shape = in_row(torus(16, 8), static_cast<uint32_t>(rank_here));
  uint64_t key = 100 + static_cast<uint64_t>(rank_here);

  Row() { scene.add(key, mesh(shape)); }
  static raycontact::Mesh mesh(const Torus& torus) { return {raycontact::vectors(torus.positions), torus.triangles}; }

  double largest_force() const {
    double largest = 0;
    for (double number : scene.forces(key)) largest = std::max(largest, std::fabs(number));
    MPI_Allreduce(MPI_IN_PLACE, &largest, 1, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
    return largest;
  }
};

const auto pack = [](uint64_t) { return std::vector<unsigned char>(); };
const auto unpack = [](uint64_t, const std::vector<unsigned char>&) {};

/** A ghost whose owner has removed the body is gone with the next step, and what it did too. */
void check_removed_owner() {
  Row row;
  row.scene.step(0.01);
  const uint64_t ghosts = row.scene.traffic().ghosts;
  if (rank_here == 1) row.scene.remove(row.key);
  row.scene.step(0.01);
  // With the second of three, the others touch nobody.
  expect(rank_count != 3 || row.largest_force() == 0, "owner gone", "no forces are left");
  expect(rank_count != 3 || row.scene.traffic().ghosts == ghosts, "owner gone", "no ghosts are left");
}

void check_steps() {
  const char* test = "steps";
  Row row;
  const int last = rank_count - 1;
  row.scene.step(0.01);
  const double force = row.largest_force();
  expect(rank_count == 1 || force > 0, test, "the row overlaps");

  std::vector<double> broken = row.shape.positions;
  broken[4] = std::nan("");
  if (rank_here == last) row.scene.set_positions(row.key, raycontact::vectors(broken));
  expect_fault([&] { row.scene.step(0.01); }, RAYC_STATUS_NOT_FINITE, "NaN",
               rank_count == 1 ? "vertex 1" : "rank " + std::to_string(last));
  expect(row.largest_force() == force, "NaN", "forces are as before");
  if (rank_here == 0) row.scene.set_velocities(row.key, raycontact::vectors(broken));
  expect_fault([&] { row.scene.step(0.01); }, RAYC_STATUS_NOT_FINITE, "velocities",
               "velocities of the body of key 100");
}

/** What is said of pairs: of nobody, of one body, or different things. */
void check_pairs() {
  const char* test = "pairs";
  const bool is_first = rank_here == 0, is_last = rank_here == rank_count - 1;
  const uint64_t last = 100 + static_cast<uint64_t>(rank_count - 1);
  Row row;
  row.scene.step(0.01);
  const double force = row.largest_force();
  if (is_last) row.scene.set_pair_collision(100, 7, false);
  expect_fault([&] { row.scene.step(0.01); }, RAYC_STATUS_UNKNOWN_BODY, test, "no rank has the body of key 7");
  if (is_first) row.scene.allow_escape(last, last, false);
  expect_fault([&] { row.scene.step(0.01); }, RAYC_STATUS_INVALID_OPTION, test, "name two different");
  row.scene.step(0.01);
  expect(row.largest_force() == force, test, "forces are as before");
  if (rank_count == 1) return;
  // Both ends say so, and of one pair the opposite.
  row.scene.set_pair_collision(100, 101, is_first);
  expect_fault([&] { row.scene.step(0.01); }, RAYC_STATUS_RANKS_DISAGREE, test, "different things");
  row.scene.step(0.01);
  expect(row.largest_force() == force, test, "nothing of it counts");
  // All say the same; the last one's neighbours too, whoever has the bodies.
  for (uint64_t key = 100; key < last; ++key) row.scene.set_pair_collision(key + 1, key, false);
  row.scene.step(0.01);
  expect(row.largest_force() == 0, test, "no pair is left");
  if (is_last) row.scene.set_pair_collision(last - 1, last, true);
  row.scene.step(0.01);
  expect(row.largest_force() > 0, test, "one is back");
  // A body that has gone takes with it what was said, also where its neighbour is.
  if (is_first) {
    row.scene.remove(row.key);
    row.scene.add(row.key, Row::mesh(row.shape));
  }
  row.scene.step(0.01);
  double own = 0;
  for (double number : row.scene.forces(row.key)) own = std::max(own, std::fabs(number));
  expect(!is_first || own > 0, test, "a new body of the same key collides");
}

}  // namespace

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_here);
  MPI_Comm_size(MPI_COMM_WORLD, &rank_count);
  const bool is_first = rank_here == 0, is_last = rank_here == rank_count - 1;
  check_steps();
  check_removed_owner();
  check_pairs();
  {
    Row row;
    if (is_first) row.scene.add(row.key, Row::mesh(row.shape));
    expect_fault([&] { row.scene.step(0.01); }, RAYC_STATUS_KEY_TAKEN, "key twice", "key 100");
    row.scene.step(0.01);
    if (is_last) row.scene.set_positions(7, raycontact::vectors(row.shape.positions));
    expect_fault([&] { row.scene.step(0.01); }, RAYC_STATUS_UNKNOWN_BODY, "unknown key", "key 7");
    if (is_last) row.scene.set_positions(row.key, raycontact::vectors(row.shape.positions.data(), 3));
    expect_fault([&] { row.scene.step(0.01); }, RAYC_STATUS_WRONG_COUNT, "count", "");
    expect_fault([&] { row.scene.step(-1); }, RAYC_STATUS_INVALID_OPTION, "seconds", "-1");
    std::vector<int> owners = {is_last ? rank_count : 0};
    expect_fault([&] { row.scene.migrate(owners, pack, unpack); }, RAYC_STATUS_UNKNOWN_RANK, "owner",
                 "is to own a body");
    owners.push_back(0);
    expect_fault([&] { row.scene.migrate(owners, pack, unpack); }, RAYC_STATUS_WRONG_COUNT, "owners", "2 owners for 1");
    expect(row.scene.keys() == std::vector<uint64_t>{row.key}, "owners", "nothing has moved");
    row.scene.step(0.01);
  }
  if (rank_count > 1) {
    Row row;
    row.scene.step(0.01);
    const double force = row.largest_force();
    if (is_last) row.scene.add(100, Row::mesh(row.shape));
    expect_fault([&] { row.scene.step(0.01); }, RAYC_STATUS_BODY_ON_TWO_RANKS, "two ranks", "key 100");
    expect(row.scene.keys() == std::vector<uint64_t>{row.key}, "two ranks", "the second is taken back");
    row.scene.step(0.01);
    expect(row.largest_force() == force, "two ranks", "forces are as before");
    expect_fault([&] { row.scene.step(is_last ? 0.02 : 0.01); }, RAYC_STATUS_RANKS_DISAGREE, "seconds", "0.02");

    // Each in turn. A neighbour that finds their pair has the body as a ghost, and notices.
    int noticed = 0;
    for (int rank = 0; rank < rank_count; ++rank) {
      const bool is_mine = rank == rank_here;
      uint32_t is_ghost_somewhere = 0;
      for (int neighbour = rank - 1; neighbour <= rank + 1; neighbour += 2) {
        uint32_t is_ghost = 0;
        if (neighbour >= 0 && neighbour < rank_count)
          rayc_finds_pair(100 + static_cast<uint64_t>(neighbour), 100 + static_cast<uint64_t>(rank), &is_ghost);
        is_ghost_somewhere |= is_ghost;
      }
      if (is_mine) {
        row.scene.remove(row.key);
        row.scene.add(row.key, Row::mesh(in_row(torus(15, 9), static_cast<uint32_t>(rank_here))));
      }
      const auto step = [&] { row.scene.step(0.01); };
      if (is_ghost_somewhere == 1) {
        expect_fault(step, RAYC_STATUS_OTHER_MESH, "another mesh", "key " + std::to_string(100 + rank));
        ++noticed;
      } else {
        step();
      }
      if (is_mine) {
        row.scene.remove(row.key);
        row.scene.add(row.key, Row::mesh(row.shape));
      }
      if (is_ghost_somewhere == 0) row.scene.step(0.01);
    }
    expect(noticed > 0, "another mesh", "somebody notices");

    raycontact::DistributedOptions options;
    if (is_last) options.detection.edges = 0;
    expect_fault([&] { raycontact::DistributedScene other(MPI_COMM_WORLD, options); }, RAYC_STATUS_RANKS_DISAGREE,
                 "options", "an option is 0");
    options = raycontact::DistributedOptions();
    if (is_last) options.response.stiffness = -1;
    expect_fault([&] { raycontact::DistributedScene other(MPI_COMM_WORLD, options); }, RAYC_STATUS_INVALID_OPTION,
                 "options", "stiffness");
  }
  expect_fault([] { raycontact::DistributedScene other(MPI_COMM_NULL); }, RAYC_STATUS_INVALID_COMMUNICATOR,
               "communicator", "MPI_COMM_NULL");
  MPI_Allreduce(MPI_IN_PLACE, &failures, 1, MPI_INT, MPI_SUM, MPI_COMM_WORLD);
  MPI_Finalize();
  return failures == 0 ? 0 : 1;
}
