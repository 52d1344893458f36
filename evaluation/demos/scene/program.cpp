// SPDX-License-Identifier: MIT OR Apache-2.0
#include "program.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <exception>
#include <map>
#include <memory>
#include <stdexcept>

#include "../terminal.hpp"
#include "../vtp_file.hpp"
#include "engine.hpp"
#include "measure.hpp"

namespace demo {

namespace {

class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct ProgramOptions {
  double dt = 0, steps = 0, most_steps = 0, frames = 60, iterations = 0, threads = 1, passes = 6;
  Setting setting;
  std::string out;
  std::vector<std::string> arguments;
  bool help = false, prints_stiffness = false;
};

void print_usage(FILE* file, const char* program, const char* description) {
  std::string methods;
  for (const std::string& name : method_names()) methods += (methods.empty() ? "" : ", ") + name;
  std::fprintf(file,
               "usage: %s [options]\n\n%s\n\n"
               "  --dt SECONDS       time step\n"
               "  --steps N          how many; by default the scene's own duration\n"
               "  --most-steps N     not more, whatever the duration\n"
               "  --method NAME      %s (ours)\n"
               "  --stiffness N/m    of the contact, for each surface vertex; by default what the bodies suggest\n"
               "  --damping SECONDS  damping time of the contact, ours only (0.05)\n"
               "  --friction MU      Coulomb's coefficient; by default the scene's\n"
               "  --depth-cap EDGES  depth that one step asks for, in cell edges, ours only (0.25)\n"
               "  --iterations N     of the linear solver at most; by default Bullet's 300\n"
               "  --passes N         detections and solves in a step at most, ours only (6)\n"
               "  --threads N        for detection; 0 = one for each core (1)\n"
               "  --stock            Bullet's own elasticity, without its elements' own rotations and the faster "
               "matrix product\n"
               "  --out FOLDER       writes ParaView files there, about 60 frames\n"
               "  --suggested-stiffness  prints it, runs nothing\n"
               "  --help             this text\n\n"
               "Prints one line: scene,method,dt,stiffness,inside_start,inside_end,inverted,peak_speed,energy_end,\n"
               "momentum_drift,links_kept,verdict. Exit status: 0 ok, 1 another verdict, 2 wrong usage or input.\n",
               program, description, methods.c_str());
}

double parse_number(const std::string& option, const std::string& text, bool is_whole, double low) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !std::isfinite(value) || value < low || (is_whole && value != std::floor(value)))
    throw UsageError(option + " needs a " + (is_whole ? "whole " : "") + "number of at least " + std::to_string(low) +
                     ", not \"" + text + "\"");
  return value;
}

Method parse_method(const std::string& name) {
  const auto& names = method_names();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) throw UsageError("unknown method \"" + name + "\"");
  return static_cast<Method>(found - names.begin());
}

ProgramOptions parse(int argc, char** argv) {
  ProgramOptions o;
  struct Number {
    double* value;
    bool is_whole;
    double low;
  };
  const std::map<std::string, Number> numbers = {
      {"--dt", {&o.dt, false, 1e-5}},
      {"--steps", {&o.steps, true, 1}},
      {"--most-steps", {&o.most_steps, true, 1}},
      {"--stiffness", {&o.setting.stiffness, false, 1e-9}},
      {"--damping", {&o.setting.damping_time, false, 0}},
      {"--friction", {&o.setting.friction, false, 0}},
      {"--depth-cap", {&o.setting.depth_cap, false, 1e-6}},
      {"--iterations", {&o.iterations, true, 1}},
      {"--threads", {&o.threads, true, 0}},
      {"--passes", {&o.passes, true, 1}},
  };
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    const auto number = numbers.find(argument);
    const bool takes_value = number != numbers.end() || argument == "--out" || argument == "--method";
    if (takes_value && i + 1 == argc) throw UsageError(argument + " needs a value");
    if (argument == "--help" || argument == "-h")
      o.help = true;
    else if (argument == "--suggested-stiffness")
      o.prints_stiffness = true;
    else if (argument == "--stock")
      o.setting.stock_elasticity = true;
    else if (argument == "--out")
      o.out = argv[++i];
    else if (argument == "--method")
      o.setting.method = parse_method(argv[++i]);
    else if (takes_value)
      *number->second.value = parse_number(argument, argv[++i], number->second.is_whole, number->second.low);
    else if (!argument.empty() && argument[0] == '-')
      throw UsageError("unknown option " + argument);
    else
      o.arguments.push_back(argument);
  }
  o.setting.iterations = static_cast<int>(o.iterations);
  o.setting.passes = static_cast<int>(o.passes);
  o.setting.threads = static_cast<uint32_t>(o.threads);
  return o;
}

VtpSurface frame(const Scene& scene, const Positions& positions) {
  VtpSurface f;
  const auto inside = inside_flags(scene, positions, 0);
  for (std::size_t b = 0; b < positions.size(); ++b) {
    const int32_t first = static_cast<int32_t>(f.body.size());
    f.points.insert(f.points.end(), positions[b].begin(), positions[b].end());
    for (uint32_t v : scene.bodies[b].cage.skin.triangles) f.triangles.push_back(first + static_cast<int32_t>(v));
    f.body.insert(f.body.end(), inside[b].size(), static_cast<uint8_t>(b));
    f.inside.insert(f.inside.end(), inside[b].begin(), inside[b].end());
  }
  return f;
}

Result simulate(const Scene& scene, const ProgramOptions& o, double dt, int steps) {
  const std::unique_ptr<Engine> engine = Engine::make(scene, o.setting);
  Measurement measurement(scene, *engine);
  std::unique_ptr<PvdSeries> series;
  if (!o.out.empty()) {
    series = std::make_unique<PvdSeries>(o.out, scene.name);
    series->add(0, frame(scene, skin_positions(scene, *engine)));
  }
  const int every = std::max(1, static_cast<int>(std::lround(steps / o.frames)));
  const ProgressBar progress;
  for (int s = 1; s <= steps; ++s) {
    // Of the processor: other programs on the machine do not count.
    const std::clock_t start = std::clock();
    bool goes_on = true;
    try {
      engine->step(dt);
    } catch (const raycontact::Error& error) {
      if (error.status() != RAYC_STATUS_NOT_FINITE) throw;
      goes_on = false;
    }
    const double ms = 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    goes_on = measurement.observe(*engine, dt, ms) && goes_on;
    if (!goes_on) break;
    if (series && (s % every == 0 || s == steps)) series->add(s * dt, frame(scene, skin_positions(scene, *engine)));
    progress.show(double(s) / steps,
                  "step " + std::to_string(s) + ", " + std::to_string(engine->contact_count()) + " contacts");
  }
  return measurement.result(*engine);
}

std::string number(double value) {
  if (!std::isfinite(value)) return "";
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

int run(const Scene& scene, const ProgramOptions& o) {
  const double dt = o.dt > 0 ? o.dt : scene.time_step;
  int steps = o.steps > 0 ? static_cast<int>(o.steps) : std::max(1, static_cast<int>(std::lround(scene.duration / dt)));
  if (o.most_steps > 0) steps = std::min(steps, static_cast<int>(o.most_steps));
  if (o.prints_stiffness) {
    std::printf("%s\n", number(scene.stiffness()).c_str());
    return 0;
  }
  const Result r = simulate(scene, o, dt, steps);
  const std::string& method = method_names()[static_cast<std::size_t>(o.setting.method)];
  const double stiffness = o.setting.stiffness > 0 ? o.setting.stiffness : scene.stiffness();
  std::fprintf(stderr,
               "%s, %s: %zu bodies, %d elements, %d steps of %g s, at most %.0f contacts, median %.2f ms of processor "
               "time a step, "
               "detection %.2f ms\n",
               scene.name.c_str(), method.c_str(), scene.bodies.size(), r.elements, r.steps, dt, r.most_contacts,
               r.step_ms, r.detection_ms);
  if (r.steps > scene.settling_steps && scene.settling_steps > 0)
    std::fprintf(stderr, "since step %d: drift %.2g m, energy gained %.2g J\n", scene.settling_steps, r.drift,
                 r.energy_gained);
  std::printf("%s,%s,%s,%s,%s,%s,%d,%s,%s,%s,%s,%s\n", scene.name.c_str(), method.c_str(), number(dt).c_str(),
              number(stiffness).c_str(), number(r.inside_start).c_str(), number(r.inside_end).c_str(), r.inverted,
              number(r.peak_speed).c_str(), number(r.energy_end).c_str(), number(r.momentum_drift).c_str(),
              scene.links > 0 ? std::to_string(r.links_kept).c_str() : "", r.verdict.c_str());
  return r.verdict == "ok" ? 0 : 1;
}

}  // namespace

int run_program(int argc, char** argv, const char* description, const MakeScene& make) {
  const std::string path = argv[0];
  const std::string name = path.substr(path.find_last_of('/') + 1);
  try {
    const ProgramOptions options = parse(argc, argv);
    if (options.help) {
      print_usage(stdout, name.c_str(), description);
      return 0;
    }
    return run(make(options.arguments), options);
  } catch (const UsageError& error) {
    std::fprintf(stderr, "%s: %s\n\n", name.c_str(), error.what());
    print_usage(stderr, name.c_str(), description);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", name.c_str(), error.what());
  }
  return 2;
}

}  // namespace demo
