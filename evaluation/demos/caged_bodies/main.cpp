// SPDX-License-Identifier: MIT OR Apache-2.0
#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "../engine/creatures.hpp"
#include "../engine/engine.hpp"
#include "../command_line.hpp"

namespace {

struct Options {
  double cells = 8, youngs_modulus = 2e4, dt = 1.0 / 60, duration = 5, friction = 0.5;
  bool soft_floor = false;
  std::vector<std::string> files;
};

using caged::Vector;

/** A box around the origin, each face cut into squares. */
demo::Surface box(const Vector& edges, std::size_t cuts) {
  demo::Surface surface{"box", {}, {}};
  std::map<std::array<std::size_t, 3>, uint32_t> numbers;
  const auto number = [&](const std::array<std::size_t, 3>& at) {
    const auto [place, is_new] = numbers.insert({at, static_cast<uint32_t>(numbers.size())});
    for (std::size_t k = 0; k < 3 && is_new; ++k)
      surface.positions.push_back(edges[k] * (static_cast<double>(at[k]) / static_cast<double>(cuts) - 0.5));
    return place->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const std::size_t end : {std::size_t{0}, cuts})
      for (std::size_t i = 0; i < cuts * cuts; ++i) {
        const auto corner = [&](std::size_t u, std::size_t v) {
          std::array<std::size_t, 3> at{};
          at[axis] = end;
          at[(axis + 1) % 3] = i % cuts + u;
          at[(axis + 2) % 3] = i / cuts + v;
          return number(at);
        };
        const uint32_t a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
        if (end == 0)
          surface.triangles.insert(surface.triangles.end(), {a, c, b, a, d, c});
        else
          surface.triangles.insert(surface.triangles.end(), {a, b, c, a, c, d});
      }
  return surface;
}

/** Three bodies on the floor, one held by its uppermost nodes; a box falls onto them. All come to rest. */
int run(const Options& options) {
  // A third of all weight on the feet of one body, 50 cm^2, and how far an even pressure may press them in: a tenth of
  // what is allowed, since feet do not press evenly.
  constexpr double pressure = 7e4, sinking = 0.001;
  caged::Engine engine;
  rayc_material floor = raycontact::bearing_material(10 * pressure, 10 * sinking);
  floor.friction = options.friction;
  engine.add_floor(floor);
  std::vector<demo::Surface> surfaces = options.files.empty() ? caged::creatures(50) : std::vector<demo::Surface>{};
  for (const std::string& file : options.files) surfaces.push_back(demo::read_obj(file));
  const Vector places[3] = {{{-0.8, 0, 0}}, {{0.8, 0, 0}}, {{0, 0, 0.9}}};
  for (std::size_t b = 0; b < 3; ++b) {
    demo::Surface& surface = surfaces[b];
    demo::normalise(surface, 1);
    double low = 0;
    for (std::size_t k = 1; k < surface.positions.size(); k += 3) low = std::min(low, surface.positions[k]);
    demo::move(surface, {{places[b][0], 0.02 - low, places[b][2]}});
    const auto cage = raycontact::make_cage(surface.positions, surface.triangles, static_cast<int>(options.cells));
    rayc_material material = raycontact::bearing_material(options.youngs_modulus / 4, cage.cell_edge / 4);
    material.friction = options.friction;
    double top = 0;
    for (const Vector& x : cage.nodes) top = std::max(top, x[1]);
    const auto held = [&](const Vector& x) { return b == 1 && x[1] > top - 0.5 * cage.cell_edge; };
    engine.add(cage, 20, options.youngs_modulus, material, options.soft_floor ? nullptr : &floor, held);
  }
  rayc_material hard = raycontact::bearing_material(4e4, 0.1);
  hard.friction = options.friction;
  const Vector edges{{1.6, 0.3, 1.2}};
  engine.add_box(box(edges, 8), edges, 50, {{0, 1.5, 0.3}}, hard);

  const int steps = static_cast<int>(std::lround(options.duration / options.dt));
  const int second = static_cast<int>(std::lround(1 / options.dt));
  for (int step = 1; step <= steps; ++step) {
    engine.step(options.dt);
    const caged::Fastest& f = engine.fastest();
    if (step % second == 0 && step < steps)
      std::printf("after %d s: %.2g m/s, a node of %.2g kg; elements %.2g N/m, contacts %.2g N/m; %.2g mm deep\n",
                  step / second, f.speed, f.mass, f.elements, f.contacts, 1e3 * engine.depth());
  }
  const bool is_good = engine.fastest().speed < 0.05 && engine.depth() < 0.01;
  std::printf("caged_bodies: %s, fastest node %.2g m/s, %.2g mm deep in the floor\n", is_good ? "ok" : "failed",
              engine.fastest().speed, 1e3 * engine.depth());
  return is_good ? 0 : 1;
}

void print_usage(FILE* out) {
  std::fputs(
      "usage: caged_bodies [options] [A.obj B.obj C.obj]\n\n"
      "Three closed surfaces of 20 kg in cages stand on a floor, one held by its uppermost nodes, and a rigid box of\n"
      "50 kg falls onto them. They come to rest: no node faster than 0.05 m/s, none deeper in the floor than 1 cm.\n"
      "Without files, bodies of 2900 vertices with four legs.\n\n"
      "  --cells N            along the longest side of each body (8)\n"
      "  --youngs-modulus PA  of their elements (20000)\n"
      "  --dt SECONDS         time step (1/60)\n"
      "  --duration SECONDS   (5)\n"
      "  --friction MU        Coulomb's coefficient (0.5)\n"
      "  --soft-floor         bodies and floor are springs in series: the bodies' stiffness decides\n"
      "  --help               this text\n\n"
      "Prints a line of figures after each second. Exit status: 0 as it should be, 1 not, 2 wrong usage.\n",
      out);
}

}  // namespace

int main(int argc, char** argv) try {
  Options options;
  const std::map<std::string, double*> numbers = {{"--cells", &options.cells},
                                                  {"--youngs-modulus", &options.youngs_modulus},
                                                  {"--dt", &options.dt},
                                                  {"--duration", &options.duration},
                                                  {"--friction", &options.friction}};
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--help" || argument == "-h") return print_usage(stdout), 0;
    if (demo::take_number(numbers, argc, argv, i)) continue;
    if (argument == "--soft-floor") {
      options.soft_floor = true;
    } else if (argument[0] == '-') {
      throw demo::WrongUsage("unknown argument '" + argument + "'");
    } else {
      options.files.push_back(argument);
    }
  }
  if (!options.files.empty() && options.files.size() != 3) throw demo::WrongUsage("give three files, or none");
  if (!(options.dt > 0 && options.dt <= 1)) throw demo::WrongUsage("--dt must be above 0 and at most 1");
  if (!(options.cells >= 1 && options.cells <= 100)) throw demo::WrongUsage("--cells must be from 1 to 100");
  if (!(options.youngs_modulus > 0)) throw demo::WrongUsage("--youngs-modulus must be above 0");
  return run(options);
} catch (...) {
  return demo::report_failure("caged_bodies", print_usage);
}
