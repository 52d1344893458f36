// What is wrong with a contact system on one rank is said on all, each fault by its own status, and the next step is as
// it would have been.
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "expect_fault.hpp"
#include "torus.hpp"

namespace {

rayc_material material() {
  rayc_material material{};
  material.struct_size = sizeof material;
  material.stiffness = 4000;
  material.damping_time = 0.01;
  material.friction = 0.5;
  material.depth_cap = 0.05;
  return material;
}

/** One soft torus on each rank, in a row, each of which overlaps its neighbours. */
struct Row {
  raycontact::DistributedScene scene{MPI_COMM_WORLD};
  raycontact::DistributedContactSystem system{scene};
  Torus shape = in_row(torus(16, 8), static_cast<uint32_t>(rank_here));
  uint64_t key = 100 + static_cast<uint64_t>(rank_here);
  std::vector<double> still = std::vector<double>(shape.positions.size());

  explicit Row(bool is_said = true) {
    scene.add(key, {raycontact::vectors(shape.positions), shape.triangles});
    if (is_said) say();
  }

  void say() { system.add_deformable(key, std::vector<double>(still.size() / 3, 0.1), material()); }
  void begin() { system.begin(0.01, shape.positions, still, still); }

  /** The sum of the forces' squares, over all ranks; the step goes on. */
  double forces() {
    std::vector<double> forces(still.size());
    system.add_forces(still, forces);
    return system.dot(forces, forces);
  }
};

const auto pack = [](uint64_t) { return std::vector<unsigned char>(); };
const auto unpack = [](uint64_t, const std::vector<unsigned char>&) {};

void check_begin(bool is_last) {
  Row row(!is_last);
  expect_fault([&] { row.begin(); }, RAYC_STATUS_UNKNOWN_BODY, "begin", "say first what carries it");
  if (is_last) row.say();
  std::vector<double> broken = row.still;
  if (is_last) broken[7] = std::nan("");
  expect_fault([&] { row.system.begin(0.01, row.shape.positions, broken, row.still); }, RAYC_STATUS_NOT_FINITE, "begin",
               "velocities[7]");
  if (is_last) broken.pop_back();
  expect_fault([&] { row.system.begin(0.01, row.shape.positions, row.still, broken); }, RAYC_STATUS_WRONG_COUNT,
               "begin", "free_velocities");
  expect_fault([&] { row.system.begin(is_last ? 0 : 0.01, row.shape.positions, row.still, row.still); },
               RAYC_STATUS_INVALID_STEP, "begin", "seconds long");
  if (is_last) row.say();
  expect_fault([&] { row.begin(); }, RAYC_STATUS_BODY_TWICE, "begin", "known already");
  if (is_last) row.system.set_motion(row.key, rayc_motion{{0, 0, 0}, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0}, {0}});
  expect_fault([&] { row.begin(); }, RAYC_STATUS_UNKNOWN_BODY, "motion", "motion of the body");
  expect_fault([&] { row.scene.step(0.01); }, RAYC_STATUS_OUT_OF_ORDER, "step", "has a contact system");
  expect_fault([&] { raycontact::DistributedContactSystem other(row.scene); }, RAYC_STATUS_OUT_OF_ORDER, "system",
               "use that");
  expect_fault([&] { row.forces(); }, RAYC_STATUS_OUT_OF_ORDER, "order", "begin one first");
  expect_fault([&] { row.system.finish(row.still); }, RAYC_STATUS_OUT_OF_ORDER, "order", "begin one first");

  Row other;
  row.begin();
  other.begin();
  const double forces = row.forces();
  expect(forces == other.forces() && (rank_count == 1 || forces > 0), "begin", "nothing has changed");
}

void check_solve(bool is_last) {
  Row row;
  row.begin();
  const double forces = row.forces();
  std::vector<double> broken = row.still, result(row.still.size());
  if (is_last) broken[2] = std::nan("");
  expect_fault([&] { row.system.add_product(0.01, broken, result); }, RAYC_STATUS_NOT_FINITE, "product", "change[2]");
  expect_fault([&] { row.system.add_forces(broken, result); }, RAYC_STATUS_NOT_FINITE, "forces", "velocities[2]");
  expect_fault([&] { row.system.linearise(broken); }, RAYC_STATUS_NOT_FINITE, "linearise", "velocities[2]");
  expect_fault([&] { row.system.finish(broken); }, RAYC_STATUS_NOT_FINITE, "finish", "velocities[2]");
  expect(result == std::vector<double>(result.size()), "product", "nothing has been added");
  if (is_last) broken.pop_back();
  expect_fault([&] { row.system.add_product(0.01, broken, result); }, RAYC_STATUS_WRONG_COUNT, "product", "change has");
  expect_fault([&] { static_cast<void>(row.system.dot(row.still, broken)); }, RAYC_STATUS_WRONG_COUNT, "dot",
               "a vector");
  expect_fault([&] { row.begin(); }, RAYC_STATUS_OUT_OF_ORDER, "order", "finish it first");
  expect_fault([&] { row.scene.migrate({0}, pack, unpack); }, RAYC_STATUS_OUT_OF_ORDER, "migrate", "finish it first");
  if (is_last) row.scene.remove(row.key);
  expect_fault([&] { row.scene.rebalance(pack, unpack); }, RAYC_STATUS_OUT_OF_ORDER, "remove", "finish it first");
  expect(row.scene.keys() == std::vector<uint64_t>{row.key}, "remove", "nobody has gone");
  expect(row.forces() == forces, "solve", "the step is as it was");
  row.system.finish(row.still);
  row.begin();
}

/** Materials of pairs, explicit steps, and what else a step is asked. */
void check_more(bool is_last) {
  Row row;
  const uint64_t first = 100;
  rayc_material broken = material();
  broken.friction = -1;
  if (is_last) row.system.set_pair_material(first, row.key, &broken);
  expect_fault([&] { row.begin(); }, RAYC_STATUS_INVALID_MATERIAL, "material", "friction is -1");
  const rayc_material fine = material();
  if (is_last) row.system.set_pair_material(first, 7, &fine);
  expect_fault([&] { row.begin(); }, RAYC_STATUS_UNKNOWN_BODY, "material", "no rank has the body of key 7");
  if (is_last) row.system.set_half_space_material(row.key, 0, &fine);
  expect_fault([&] { row.begin(); }, RAYC_STATUS_WRONG_COUNT, "material", "half-space");
  if (is_last) row.system.set_half_space_material(7, 0, &fine);
  expect_fault([&] { row.begin(); }, RAYC_STATUS_UNKNOWN_BODY, "material", "body of key 7");

  raycontact::DistributedBlocks blocks;
  std::vector<double> wrong = row.still, forces(row.still.size());
  expect_fault([&] { static_cast<void>(row.system.detect_again(row.still)); }, RAYC_STATUS_OUT_OF_ORDER, "again",
               "begin one first");
  expect_fault([&] { static_cast<void>(row.system.energy(row.still)); }, RAYC_STATUS_OUT_OF_ORDER, "energy",
               "begin one first");
  expect_fault([&] { row.system.copy_blocks_to(0.01, blocks); }, RAYC_STATUS_OUT_OF_ORDER, "blocks", "begin one first");
  if (is_last) wrong[3] = std::nan("");
  const auto explicit_step = [&](double dt, const std::vector<double>& v) {
    static_cast<void>(row.system.explicit_step(dt, row.shape.positions, v, forces));
  };
  expect_fault([&] { explicit_step(0.001, wrong); }, RAYC_STATUS_NOT_FINITE, "explicit", "velocities[3]");
  expect_fault([&] { explicit_step(is_last ? -1 : 0.001, row.still); }, RAYC_STATUS_INVALID_STEP, "explicit",
               "seconds long");
  expect(forces == row.still, "explicit", "nothing has been added");
  if (is_last) forces.pop_back();
  expect_fault([&] { explicit_step(0.001, row.still); }, RAYC_STATUS_WRONG_COUNT, "explicit", "equally many");

  row.begin();
  const double square = row.forces(), joules = row.system.energy(row.still);
  expect_fault([&] { static_cast<void>(row.system.detect_again(wrong)); }, RAYC_STATUS_NOT_FINITE, "again",
               "velocities[3]");
  expect_fault([&] { static_cast<void>(row.system.energy(wrong)); }, RAYC_STATUS_NOT_FINITE, "energy", "velocities[3]");
  expect_fault([&] { row.system.copy_blocks_to(is_last ? std::nan("") : 1, blocks); }, RAYC_STATUS_NOT_FINITE, "blocks",
               "factor");
  expect_fault([&] { explicit_step(0.001, row.still); }, RAYC_STATUS_OUT_OF_ORDER, "explicit", "finish it first");
  if (is_last) row.system.set_pair_material(first, row.key, &fine);
  expect_fault([&] { static_cast<void>(row.system.detect_again(row.still)); }, RAYC_STATUS_OUT_OF_ORDER, "again",
               "finish it first");
  expect(!row.system.detect_again(row.still), "again", "there is nothing to look for");
  expect(row.forces() == square && row.system.energy(row.still) == joules, "again", "the step is as it was");
  row.system.copy_blocks_to(0.01, blocks);
  expect(rank_count == 1 || !blocks.rows.empty(), "blocks", "neighbours touch");
  row.system.finish(row.still);
}

/** A scene that has made steps of its own has ghosts that the system does not know. */
void check_later_system() {
  Row row;
  row.begin();
  raycontact::DistributedScene scene(MPI_COMM_WORLD);
  scene.add(row.key, {raycontact::vectors(row.shape.positions), row.shape.triangles});
  scene.step(0.01);
  raycontact::DistributedContactSystem system(scene);
  system.add_deformable(row.key, std::vector<double>(row.still.size() / 3, 0.1), material());
  system.begin(0.01, row.shape.positions, row.still, row.still);
  std::vector<double> forces(row.still.size());
  system.add_forces(row.still, forces);
  expect(system.dot(forces, forces) == row.forces(), "later", "the forces are the same");
}

void check_half_spaces(bool is_last) {
  Row row;
  row.system.add_half_space({0, 0, 1}, is_last ? 0.25 : 0.5, material());
  if (rank_count > 1)
    expect_fault([&] { row.begin(); }, RAYC_STATUS_RANKS_DISAGREE, "half-spaces", "differ from rank to rank");
  else
    row.begin();
  Row other;
  if (is_last) other.system.add_half_space({0, 0, 2}, 0, material());
  expect_fault([&] { other.begin(); }, RAYC_STATUS_INVALID_DIRECTION, "half-spaces", "normal");
}

}  // namespace

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_here);
  MPI_Comm_size(MPI_COMM_WORLD, &rank_count);
  const bool is_last = rank_here == rank_count - 1;
  check_begin(is_last);
  check_solve(is_last);
  check_half_spaces(is_last);
  check_later_system();
  check_more(is_last);
  MPI_Allreduce(MPI_IN_PLACE, &failures, 1, MPI_INT, MPI_SUM, MPI_COMM_WORLD);
  MPI_Finalize();
  return failures == 0 ? 0 : 1;
}
