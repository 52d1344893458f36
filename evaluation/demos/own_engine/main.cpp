// SPDX-License-Identifier: MIT OR Apache-2.0
#include <cstdio>
#include <map>
#include <string>

#include "../command_line.hpp"
#include "../../../examples/own_engine/engine.hpp"

namespace {

struct Options {
  std::string scene;
  double dt = 1.0 / 60, aside = 0.2, friction = 0.5;
  bool is_guarded = false;
};

constexpr double tilt = 0.2;

/** A lattice of cells each way, its boundary two triangles a square, springs between all corners of a cell. */
own::Body box(std::size_t cells, double edge, const own::Vector& middle) {
  own::Body body;
  using Place = std::array<std::size_t, 3>;
  const std::size_t side = cells + 1, count = side * side * side;
  const auto place = [&](std::size_t n) { return Place{{n % side, n / side % side, n / side / side}}; };
  const auto number = [&](const Place& at) { return static_cast<uint32_t>(at[0] + side * (at[1] + side * at[2])); };
  const auto is_near = [](std::size_t a, std::size_t b) { return a <= b + 1 && b <= a + 1; };
  for (std::size_t a = 0; a < count; ++a) {
    const Place at = place(a);
    body.nodes.push_back(middle);
    for (std::size_t k = 0; k < 3; ++k)
      body.nodes.back()[k] += edge * (static_cast<double>(at[k]) - 0.5 * static_cast<double>(cells));
    for (std::size_t b = a + 1; b < count; ++b) {
      const Place other = place(b);
      if (is_near(at[0], other[0]) && is_near(at[1], other[1]) && is_near(at[2], other[2]))
        body.springs.push_back({{a, b}});
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t square = 0; square < 2 * cells * cells; ++square) {
      const bool is_far = square >= cells * cells;
      const auto corner = [&](std::size_t u, std::size_t v) {
        Place at{};
        at[axis] = is_far ? cells : 0;
        at[(axis + 1) % 3] = square % cells + u;
        at[(axis + 2) % 3] = square / cells % cells + v;
        return number(at);
      };
      const uint32_t a = corner(0, 0), b = corner(is_far, !is_far), c = corner(1, 1), d = corner(!is_far, is_far);
      body.triangles.insert(body.triangles.end(), {a, b, c, a, c, d});
    }
  return body;
}

/** Radii 1 and 0.4; within, a ring of nodes from which spokes go to the surface. */
own::Body torus(std::size_t around, std::size_t across, const own::Vector& middle) {
  own::Body body;
  const double turn = 2 * std::acos(-1.0);
  const std::size_t ring = around * across;
  for (std::size_t n = 0; n < ring + around; ++n) {
    const std::size_t i = n < ring ? n / across : n - ring;
    const double u = turn * static_cast<double>(i) / static_cast<double>(around);
    const double v = turn * static_cast<double>(n % across) / static_cast<double>(across);
    const double tube = n < ring ? 0.4 : 0, r = 1 + tube * std::cos(v);
    body.nodes.push_back({{middle[0] + r * std::cos(u), middle[1] + r * std::sin(u), middle[2] + tube * std::sin(v)}});
  }
  for (std::size_t i = 0; i < around; ++i) {
    const std::size_t next = (i + 1) % around;
    body.springs.push_back({{ring + i, ring + next}});
    for (std::size_t j = 0; j < across; ++j) {
      const std::size_t a = i * across + j, b = next * across + j, up = (j + 1) % across;
      const std::size_t c = next * across + up, d = i * across + up;
      for (const std::size_t other : {b, c, d, ring + i, ring + next}) body.springs.push_back({{a, other}});
      for (const std::size_t corner : {a, b, c, a, c, d}) body.triangles.push_back(static_cast<uint32_t>(corner));
    }
  }
  return body;
}

own::Engine engine_for(const Options& options) {
  own::Engine engine;
  engine.is_guarded = options.is_guarded;
  return engine;
}

int verdict(const char* scene, bool is_good, const std::string& figures) {
  std::printf("%s: %s, %s\n", scene, is_good ? "ok" : "failed", figures.c_str());
  return is_good ? 0 : 1;
}

std::string with_unit(const char* what, double value, const char* unit) {
  char text[100];
  std::snprintf(text, sizeof text, "%s %.4g %s", what, value, unit);
  return text;
}

/** Five boxes, each set off against the one below by a part of its edge, to and fro: they stay. */
int stack(const Options& options) {
  own::Engine engine = engine_for(options);
  engine.gravity = {{0, 0, -9.81}};
  // Softer, and the column buckles at its joints.
  rayc_material material = raycontact::bearing_material(1e5, 0.05);
  material.friction = options.friction;
  engine.add_floor({{0, 0, 1}}, material);
  for (int i = 0; i < 5; ++i)
    engine.add(box(3, 1.0 / 6, {{i % 2 == 0 ? 0 : 0.5 * options.aside, 0, 0.25 + 0.5 * i}}), 10, 2e4, material);
  for (double time = 0; time < 8; time += options.dt) engine.step(options.dt);
  const own::Vector before = engine.centre(4);
  for (double time = 0; time < 2; time += options.dt) engine.step(options.dt);
  const own::Vector top = engine.centre(4);
  const double drift = std::hypot(top[0] - before[0], top[1] - before[1], top[2] - before[2]) / 2;
  return verdict("stack", top[2] > 2.1 && drift < 1e-3 && engine.fastest() < 0.05,
                 with_unit("top at", top[2], "m") + ", " + with_unit("drift", 1e3 * drift, "mm/s") + ", " +
                     with_unit("fastest node", engine.fastest(), "m/s"));
}

/** Two tori that start deep inside one another: they part. */
int tori(const Options& options) {
  own::Engine engine = engine_for(options);
  const rayc_material material = raycontact::bearing_material(500, 0.05);
  engine.add(torus(30, 12, {{0, 0, 0}}), 30, 500, material);
  engine.add(torus(30, 12, {{0.25, 0.1, 0.3}}), 30, 500, material);
  const std::size_t start = engine.contact_count();
  double parted = 0;
  for (double time = 0; time < 5; time += options.dt) {
    engine.step(options.dt);
    if (engine.contact_count() > 0) parted = time + options.dt;
  }
  const own::Vector a = engine.velocity(0), b = engine.velocity(1);
  const double momentum = 30 * std::hypot(a[0] + b[0], a[1] + b[1], a[2] + b[2]);
  const std::size_t end = engine.contact_count();
  return verdict("tori", start > 0 && end == 0 && momentum < 1e-6,
                 std::to_string(start) + " contacts at the start, " + std::to_string(end) + " at the end, " +
                     with_unit("apart after", parted, "s") + ", " + with_unit("momentum", momentum, "kg m/s"));
}

/** A box on a floor that is tilted by 0.2: friction holds it, or it slides as fast as the textbook says. */
int ramp(const Options& options) {
  own::Engine engine = engine_for(options);
  // The floor lies level, and gravity is tilted.
  engine.gravity = {{9.81 * std::sin(tilt), 0, -9.81 * std::cos(tilt)}};
  rayc_material material = raycontact::bearing_material(1e5, 0.05);
  material.friction = options.friction;
  engine.add_floor({{0, 0, 1}}, material);
  engine.add(box(3, 1.0 / 6, {{0, 0, 0.25}}), 10, 2e4, material);
  const double slope = std::sin(tilt) - options.friction * std::cos(tilt);
  for (double time = 0; time < 2; time += options.dt) engine.step(options.dt);
  const double x = engine.centre(0)[0], speed = engine.velocity(0)[0];
  int steps = 0;
  for (double time = 0; time < 2; time += options.dt, ++steps) engine.step(options.dt);
  const double creep = (engine.centre(0)[0] - x) / (steps * options.dt);
  if (slope < 0) return verdict("ramp", std::fabs(creep) < 1e-3, with_unit("creep", 1e3 * creep, "mm/s"));
  const double acceleration = (engine.velocity(0)[0] - speed) / (steps * options.dt);
  return verdict("ramp", std::fabs(acceleration / (9.81 * slope) - 1) < 0.01,
                 with_unit("slides with", acceleration, "m/s^2") + ", " + with_unit("textbook", 9.81 * slope, "m/s^2"));
}

void print_usage(FILE* out) {
  std::fputs(
      "usage: own_engine SCENE [options]\n\n"
      "An engine of points and springs, implicit Euler and conjugate gradients, on raycontact's contact system\n"
      "alone.\n\n"
      "  stack           five boxes, each set off against the one below, for 10 s: they stay\n"
      "  tori            two tori that start deep inside one another, for 5 s: they part\n"
      "  ramp            a box on a floor tilted by 0.2: friction holds it, or it slides as the textbook says\n\n"
      "  --dt SECONDS    time step (1/60)\n"
      "  --aside PART    of a box's edge, by which boxes of the stack are set off (0.2)\n"
      "  --friction MU   Coulomb's coefficient (0.5)\n"
      "  --guarded       steps whose energy would rise are cut short\n"
      "  --help          this text\n\n"
      "Prints one line of figures. Exit status: 0 as it should be, 1 not, 2 wrong usage.\n",
      out);
}

}  // namespace

int main(int argc, char** argv) try {
  Options options;
  const std::map<std::string, double*> numbers = {
      {"--dt", &options.dt}, {"--aside", &options.aside}, {"--friction", &options.friction}};
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--help" || argument == "-h") return print_usage(stdout), 0;
    if (demo::take_number(numbers, argc, argv, i)) continue;
    if (argument == "--guarded") {
      options.is_guarded = true;
      continue;
    }
    if (argument[0] == '-' || !options.scene.empty()) {
      throw demo::WrongUsage("unknown argument '" + argument + "'");
    } else {
      options.scene = argument;
    }
  }
  const std::map<std::string, int (*)(const Options&)> scenes = {{"stack", stack}, {"tori", tori}, {"ramp", ramp}};
  const auto scene = scenes.find(options.scene);
  if (scene == scenes.end()) throw demo::WrongUsage("name a scene: stack, tori or ramp");
  if (!(options.dt > 0 && options.dt <= 1)) throw demo::WrongUsage("--dt must be above 0 and at most 1");
  return scene->second(options);
} catch (...) {
  return demo::report_failure("own_engine", print_usage);
}
