// SPDX-License-Identifier: MIT OR Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "../command_line.hpp"
#include "../engine/creatures.hpp"
#include "../engine/engine.hpp"

namespace {

struct Options {
  double bodies = 200, triangles = 2000, cells = 3, duration = 3, threads = 1, seed = 1;
  double spacing = 0, accuracy = 0;
};

constexpr double size = 0.3, mass = 1, youngs_modulus = 2e4, dt = 1.0 / 60;

/** A tower of bodies, each turned as chance will have it, in a room of floor and four walls. */
void fill_room(const Options& options, caged::Engine& engine) {
  const auto count = static_cast<std::size_t>(options.bodies);
  const auto side = static_cast<std::size_t>(std::ceil(std::cbrt(options.bodies / 2)));
  const double room = 1.05 * size * static_cast<double>(side);
  // A column of bodies on two feet may press so much.
  rayc_material wall = raycontact::bearing_material(2e4, 0.02);
  wall.friction = 0.5;
  engine.add_floor(wall);
  engine.add_wall({{1, 0, 0}}, 0, wall);
  engine.add_wall({{-1, 0, 0}}, -room, wall);
  engine.add_wall({{0, 0, 1}}, 0, wall);
  engine.add_wall({{0, 0, -1}}, -room, wall);
  const auto rings = static_cast<uint32_t>(std::lround(std::sqrt(options.triangles / 2.32)));
  const std::vector<demo::Surface> kinds = caged::creatures(std::max(rings, 3U));
  std::mt19937 random(static_cast<uint32_t>(options.seed));
  std::normal_distribution<double> normal;
  for (std::size_t b = 0; b < count; ++b) {
    demo::Surface surface = kinds[b % kinds.size()];
    const caged::Vector turn{{normal(random), normal(random), normal(random)}};
    const caged::Matrix rotation = caged::rotation(turn);
    for (std::size_t v = 0; v < surface.positions.size(); v += 3) {
      const caged::Vector x{{surface.positions[v], surface.positions[v + 1], surface.positions[v + 2]}};
      for (std::size_t k = 0; k < 3; ++k) surface.positions[v + k] = caged::dot(rotation[k], x);
    }
    demo::normalise(surface, size);
    const double level = static_cast<double>(b / (side * side)), step = 1.05 * size;
    demo::move(surface, {{step * (0.5 + static_cast<double>(b % side)), step * (0.55 + level),
                          step * (0.5 + static_cast<double>(b / side % side))}});
    const auto cage = raycontact::make_cage(surface.positions, surface.triangles, static_cast<int>(options.cells));
    rayc_material material = raycontact::bearing_material(youngs_modulus / 4, cage.cell_edge / 4);
    material.friction = 0.5;
    engine.add(cage, mass, youngs_modulus, material, &wall, [](const caged::Vector&) { return false; });
  }
}

double median(std::vector<double> numbers) {
  std::sort(numbers.begin(), numbers.end());
  return numbers[numbers.size() / 2];
}

int run(const Options& options) {
  caged::Engine engine(static_cast<int>(options.threads));
  if (options.spacing > 0) engine.set_sampling(RAYC_SAMPLING_SPACING, options.spacing);
  if (options.accuracy > 0) engine.set_sampling(RAYC_SAMPLING_ACCURACY, options.accuracy);
  fill_room(options, engine);
  const int steps = static_cast<int>(std::lround(options.duration / dt)), half_second = 30;
  std::vector<double> all, detection, products, elements;
  for (int step = 1; step <= steps; ++step) {
    const auto begin = std::chrono::steady_clock::now();
    engine.step(dt);
    all.push_back(1e3 * std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    detection.push_back(1e3 * engine.spent().detection);
    products.push_back(1e3 * engine.spent().products);
    elements.push_back(1e3 * engine.spent().elements);
    if (step % half_second != 0 && step != steps) continue;
    std::printf("%4.1f s: %7zu contacts; ms a step: %6.1f = detection and rows %6.1f, products %6.1f, "
                "elements %6.1f; %.2g m/s, %.2g mm deep\n",
                step * dt, engine.contact_count(), median(all), median(detection), median(products), median(elements),
                engine.fastest().speed, 1e3 * engine.depth());
    std::fflush(stdout);
    for (std::vector<double>* times : {&all, &detection, &products, &elements}) times->clear();
  }
  const bool is_good = engine.depth() < 0.2 * size && engine.fastest().speed < 10;
  std::printf("caged_pile: %s\n", is_good ? "ok" : "failed");
  return is_good ? 0 : 1;
}

void print_usage(FILE* out) {
  std::fputs(
      "usage: caged_pile [options]\n\n"
      "Soft bodies with legs, each a fine skin in a coarse cage, fall into a room and pile up. Prints a line of\n"
      "medians for each half second.\n"
      "Exit status: 0; 1 when a body is 6 cm deep in the floor at the end or as fast as 10 m/s; 2 for wrong usage.\n\n"
      "  --bodies N           (200)\n"
      "  --triangles N        of each skin, about (2000)\n"
      "  --cells N            along the longest side of each cage (3)\n"
      "  --duration SECONDS   (3), in steps of 1/60 s\n"
      "  --threads N          of the engine, lent to the library (1)\n"
      "  --spacing METRES     between samples, in place of the default; a body is 0.3 m long\n"
      "  --accuracy PART      of the force of each pair, in place of the default\n"
      "  --seed N             for how the bodies are turned (1)\n"
      "  --help               this text\n",
      out);
}

}  // namespace

int main(int argc, char** argv) try {
  Options options;
  const std::map<std::string, double*> numbers = {
      {"--bodies", &options.bodies},     {"--triangles", &options.triangles}, {"--cells", &options.cells},
      {"--duration", &options.duration}, {"--threads", &options.threads},     {"--spacing", &options.spacing},
      {"--accuracy", &options.accuracy}, {"--seed", &options.seed}};
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--help" || argument == "-h") return print_usage(stdout), 0;
    if (!demo::take_number(numbers, argc, argv, i)) throw demo::WrongUsage("unknown argument '" + argument + "'");
  }
  if (!(options.bodies >= 1 && options.bodies <= 10000)) throw demo::WrongUsage("--bodies must be from 1 to 10000");
  if (!(options.threads >= 1 && options.threads <= 1000)) throw demo::WrongUsage("--threads must be from 1 to 1000");
  if (!(options.triangles >= 20 && options.triangles <= 1e6))
    throw demo::WrongUsage("--triangles must be from 20 to 1000000");
  if (!(options.cells >= 1 && options.cells <= 100)) throw demo::WrongUsage("--cells must be from 1 to 100");
  return run(options);
} catch (...) {
  return demo::report_failure("caged_pile", print_usage);
}
