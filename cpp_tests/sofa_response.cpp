// The response in SOFA's words: its forces are the negative gradient of its energy, its products and blocks their
// derivative; implicit Euler over it keeps momentum and gains no energy, bodies come apart, friction holds a box on a
// slope and lets it slide as the textbook says, and forces for bodies with solvers of their own do not explode.
#include "raycontact/sofa_response.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "check.h"
#include "sofa_world.hpp"

namespace {

void forces_are_the_gradient_and_products_their_derivative(double friction) {
  const double dt = 0.02;
  World world = three_spheres(friction);
  world.begin(dt);
  const std::vector<Vectors> f = world.forces(world.v);
  std::vector<Vectors> direction = world.zeros();
  world.for_each([&](std::size_t body, std::size_t i, int axis) {
    direction[body][i][axis] = std::cos(double(7 * i + body) + axis);
  });
  const double h = 1e-4;
  const auto moved = [&](double by) {
    std::vector<Vectors> v = world.v;
    world.for_each([&](std::size_t b, std::size_t i, int axis) { v[b][i][axis] += by * direction[b][i][axis]; });
    return v;
  };
  const std::vector<Vectors> after = world.forces(moved(h));
  const double high = world.response.getPotentialEnergy();
  const std::vector<Vectors> before = world.forces(moved(-h));
  const double low = world.response.getPotentialEnergy();
  const double work = world.inner(f, direction);
  CHECK(std::abs(work) > 0.1);
  // Velocities change what is at the step's end by dt.
  CHECK_NEAR((low - high) / (2 * h * dt), work, 1e-6 * std::abs(work));

  std::vector<Vectors> product = world.zeros(), by_blocks = world.zeros();
  world.response.addDForce(World::views<Vectors>(product), World::views<const Vectors>(direction), 1);
  CHECK(world.inner(product, direction) < 0);
  const double size = std::sqrt(world.inner(product, product));
  world.for_each([&](std::size_t b, std::size_t i, int axis) {
    CHECK_NEAR((after[b][i][axis] - before[b][i][axis]) / (2 * h), product[b][i][axis], 1e-8 * size);
  });

  const raycontact::Blocks& blocks = world.response.blocks();
  for (std::size_t k = 0; k < blocks.rows.size(); ++k) {
    const auto [row_body, row] = world.response.place(blocks.rows[k]);
    const auto [column_body, column] = world.response.place(blocks.columns[k]);
    for (int i = 0; i < 9; ++i)
      by_blocks[row_body][row][i / 3] += blocks.numbers[9 * k + i] * direction[column_body][column][i % 3];
  }
  world.for_each([&](std::size_t b, std::size_t i, int axis) {
    CHECK_NEAR(by_blocks[b][i][axis], product[b][i][axis], 1e-12 * size);
  });
  CHECK(world.response.lastForce(1, 3)[0] == before[1][3][0]);
}

void sum_momentum(const World& world, double momentum[3], double& of_parts) {
  world.for_each([&](std::size_t body, std::size_t i, int axis) {
    momentum[axis] += world.masses[body] * world.v[body][i][axis];
    of_parts += world.masses[body] * std::abs(world.v[body][i][axis]);
  });
}

void bodies_come_apart_and_keep_their_momentum() {
  World world = three_spheres(0.3);
  world.is_rigid = true;
  for (Vectors& v : world.v) std::fill(v.begin(), v.end(), Vec3<double>(0, 0, 0));
  for (int step = 0; step < 200; ++step) world.step(0.02);
  double momentum[3] = {0, 0, 0}, of_parts = 0;
  sum_momentum(world, momentum, of_parts);
  CHECK(of_parts > 0.1);
  for (const double component : momentum) CHECK_NEAR(component, 0, 1e-12 * of_parts);
  world.begin(0.02);
  const std::vector<Vectors> f = world.forces(world.v);
  CHECK(world.inner(f, f) == 0);
}

void impacts_gain_no_energy(double friction) {
  World world;
  world.is_rigid = true;
  world.law.stiffness = 100;
  world.law.friction = friction;
  world.add(sphere<double>(0, 0, 0), 1);
  world.add(sphere<double>(2.1, 0.5, 0.1), 2);
  for (auto& velocity : world.v[0]) velocity = Vec3<double>(1, 0, 0);
  const double before = world.kinetic();
  double highest = 0;
  for (int step = 0; step < 100; ++step) {
    world.step(0.02);
    highest = std::max(highest, world.kinetic());
  }
  CHECK(highest <= before * (1 + 1e-12));
  CHECK(world.kinetic() < 0.9 * before);
  double momentum[3] = {0, 0, 0}, of_parts = 0;
  sum_momentum(world, momentum, of_parts);
  CHECK_NEAR(momentum[0], 1, 1e-12);
}

/** A box whose faces are finely cut, lying on a wide sheet, gravity being tilted. */
double way_down_a_slope(double friction, double slope, double seconds) {
  World world;
  world.is_rigid = true;
  world.law.stiffness = 1e5;
  world.law.friction = friction;
  world.add(box(0.4, 8), 10);
  world.surfaces[0] = box(0.4, 8);
  Surface<double> sheet;
  for (const double x : {-50.0, 50.0})
    for (const double y : {-50.0, 50.0}) sheet.x.emplace_back(x, y, -0.199);
  sheet.triangles = {{0, 2, 1}, {1, 2, 3}};
  world.add(sheet, infinity, true);
  world.gravity = {9.81 * std::sin(slope), 0, -9.81 * std::cos(slope)};
  const auto first = world.surfaces[0].x[0][0];
  const double dt = 1.0 / 120;
  for (int step = 0; step < int(seconds / dt + 0.5); ++step) world.step(dt);
  return world.surfaces[0].x[0][0] - first;
}

void friction_holds_and_lets_slide() {
  CHECK(std::abs(way_down_a_slope(0.5, 0.2, 1)) < 0.002);
  const double expected = 9.81 * (std::sin(0.2) - 0.1 * std::cos(0.2)) / 2;
  CHECK_NEAR(way_down_a_slope(0.1, 0.2, 1), expected, 0.05 * expected);
}

/** Bodies with solvers of their own, stiffer than an explicit step bears: apart, with their momentum, never too fast.
 */
void separate_forces_do_not_explode() {
  for (const double stiffness : {10.0, 1000.0}) {
    World world;
    world.is_rigid = true;
    world.law.stiffness = stiffness;
    world.law.friction = 0.3;
    for (const auto& centre : {Vec3<double>(0, 0, 0), Vec3<double>(1.5, 0.25, 0), Vec3<double>(3, 0, 0.25)})
      world.add(sphere<double>(centre[0], centre[1], centre[2]), 1);
    const double dt = 0.02;
    double fastest = 0;
    const auto step = [&] {
      world.choose_pairs();
      std::vector<Vectors> f = world.zeros();
      const int iterations = world.response.addSeparateForce(world.stage, dt, World::views<Vectors>(f),
                                                             world.positions(), world.velocities(), weightless);
      CHECK(iterations < Response::most_iterations);
      world.project(f);
      world.for_each([&](std::size_t body, std::size_t i, int axis) {
        world.v[body][i][axis] += dt * f[body][i][axis] / world.masses[body];
        world.surfaces[body].x[i][axis] += dt * world.v[body][i][axis];
      });
      world.response.finish(world.velocities());
      fastest = std::max(fastest, world.kinetic());
      return world.inner(f, f);
    };
    for (int k = 0; k < 200; ++k) step();
    CHECK(step() == 0);
    // No faster than out of one another within one step.
    CHECK(fastest < 3 * 0.5 * std::pow(0.5 / dt, 2));
    double momentum[3] = {0, 0, 0}, of_parts = 0;
    sum_momentum(world, momentum, of_parts);
    for (const double component : momentum) CHECK_NEAR(component, 0, 1e-10 * of_parts);
  }
}

void mistakes_are_named() {
  World world = three_spheres(0);
  const auto status_of = [](auto call) {
    try {
      call();
    } catch (const raycontact::Error& error) {
      return error.status();
    }
    return RAYC_STATUS_OK;
  };
  std::vector<Vectors> f = world.zeros();
  CHECK(status_of([&] { world.response.addForce(World::views<Vectors>(f), world.velocities()); }) ==
        RAYC_STATUS_OUT_OF_ORDER);
  CHECK(status_of([&] { world.response.addForce({}, {}); }) == RAYC_STATUS_WRONG_COUNT);
  world.v[1][7][2] = std::nan("");
  CHECK(status_of([&] { world.begin(0.01); }) == RAYC_STATUS_NOT_FINITE);
  CHECK(!world.response.isUnderWay());
  try {
    world.begin(0.01);
  } catch (const raycontact::Error& error) {
    CHECK(std::string(error.what()).find("velocity of model 1: node 7") != std::string::npos);
  }
  world.v[1][7][2] = 0;
  world.v[2].pop_back();
  CHECK(status_of([&] { world.begin(0.01); }) == RAYC_STATUS_WRONG_COUNT);
  world.v[2].emplace_back(0, 0, 0);
  world.begin(0.01);
  CHECK(world.response.isUnderWay());
}

}  // namespace

int main() {
  forces_are_the_gradient_and_products_their_derivative(0);
  forces_are_the_gradient_and_products_their_derivative(0.5);
  bodies_come_apart_and_keep_their_momentum();
  impacts_gain_no_energy(0);
  impacts_gain_no_energy(0.5);
  friction_holds_and_lets_slide();
  separate_forces_do_not_explode();
  mistakes_are_named();
  return check_result();
}
