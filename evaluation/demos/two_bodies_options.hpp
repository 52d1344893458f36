// SPDX-License-Identifier: MIT OR Apache-2.0
/** The command line of two_bodies. */
#ifndef RAYCONTACT_DEMOS_TWO_BODIES_OPTIONS_HPP
#define RAYCONTACT_DEMOS_TWO_BODIES_OPTIONS_HPP

#include <cmath>
#include <cstdlib>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace demo {

struct Options {
  std::vector<std::string> surfaces;  // none or two .obj files
  std::string out = "out";
  double dt = 0.02;              // s
  double steps = 500;            // at most
  double stiffness = 1;          // in units of E / h
  double damping = 0.05;         // s
  double depth_cap = 0.25;       // in units of h
  double youngs_modulus = 2000;  // Pa
  double density = 30;           // kg/m^3
  double cells = 5;              // along the longest side
  double around = 40;            // quads around each torus
  double spacing = 0;            // of the rays, m; 0 = at the vertices, -1 = by accuracy
  double accuracy = 0;           // with spacing -1: by which part the net force may be off; 0 = 0.01
  double threads = 1;
  double every = 2;  // steps between frames
  bool help = false;
};

inline const char* usage() {
  return "Usage: two_bodies [options] [a.obj b.obj]\n"
         "\n"
         "Starts two soft bodies deep inside one another and lets raycontact push them apart in Bullet's deformable\n"
         "world. Without files: two tori of 1600 triangles. With two closed surfaces: scaled to the same size.\n"
         "\n"
         "  --dt SECONDS          time step (0.02)\n"
         "  --steps N             at most so many steps (500); ends earlier, half a second after the bodies are apart\n"
         "  --out FOLDER          where two_bodies.pvd and its frames go, for ParaView (out)\n"
         "  --every N             steps between two frames (2)\n"
         "  --stiffness FACTOR    of the contact, in units of E/h, h = edge of a cage cell (1)\n"
         "  --damping SECONDS     damping time of the contact (0.05)\n"
         "  --depth-cap FACTOR    depth one step asks for at most, in units of h (0.25)\n"
         "  --young PASCAL        Young's modulus E of both bodies (2000)\n"
         "  --density KG_PER_M3   (30)\n"
         "  --cells N             cage cells along the longest side of an .obj surface (5)\n"
         "  --around N            quads around each torus, half as many across (40)\n"
         "  --spacing METRES      of the rays; 0 = at the vertices of the skins, -1 = by --accuracy (0)\n"
         "  --accuracy PART       with --spacing -1: by which part the net force may be off, at most 1; 0 = 0.01 (0)\n"
         "  --threads N           for detection; 0 = one for each core (1)\n"
         "  --help                this text\n"
         "\n"
         "Exit status: 0 separated, 1 not separated, 2 wrong usage or unusable input.\n";
}

class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

inline double parse_number(const std::string& option, const std::string& text, bool whole, double low) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !std::isfinite(value) || value < low ||
      (whole && (value != std::floor(value) || value > 1e6)))
    throw UsageError(option + " needs a " + (whole ? "whole number" : "number") + " of at least " +
                     std::to_string(low).substr(0, whole ? 1 : 6) + ", not \"" + text + "\"");
  return value;
}

inline Options parse_options(int argc, char** argv) {
  struct Number {
    double* value;
    bool whole;
    double low;
  };
  Options options;
  const double tiny = 1e-4;
  const std::map<std::string, Number> numbers = {
      {"--dt", {&options.dt, false, tiny}},
      {"--steps", {&options.steps, true, 1}},
      {"--every", {&options.every, true, 1}},
      {"--stiffness", {&options.stiffness, false, 0}},
      {"--damping", {&options.damping, false, 0}},
      {"--depth-cap", {&options.depth_cap, false, tiny}},
      {"--young", {&options.youngs_modulus, false, tiny}},
      {"--density", {&options.density, false, tiny}},
      {"--cells", {&options.cells, true, 1}},
      {"--threads", {&options.threads, true, 0}},
      {"--around", {&options.around, true, 6}},
      {"--spacing", {&options.spacing, false, -1}},
      {"--accuracy", {&options.accuracy, false, 0}},
  };
  // Whatever else is asked for.
  for (int i = 1; i < argc; ++i)
    if (std::string(argv[i]) == "--help" || std::string(argv[i]) == "-h") options.help = true;
  if (options.help) return options;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    const auto number = numbers.find(argument);
    if (number != numbers.end() || argument == "--out") {
      if (i + 1 == argc) throw UsageError(argument + " needs a value");
      const std::string value = argv[++i];
      if (argument == "--out")
        options.out = value;
      else
        *number->second.value = parse_number(argument, value, number->second.whole, number->second.low);
    } else if (!argument.empty() && argument[0] == '-') {
      throw UsageError("unknown option " + argument);
    } else {
      options.surfaces.push_back(argument);
    }
  }
  if (!options.surfaces.empty() && options.surfaces.size() != 2)
    throw UsageError("give two .obj files, or none for the two tori; got " + std::to_string(options.surfaces.size()));
  if (options.accuracy > 1) throw UsageError("--accuracy is at most 1, a part of the net force");
  if (options.accuracy > 0 && options.spacing >= 0) throw UsageError("--accuracy needs --spacing -1");
  return options;
}

}  // namespace demo

#endif  // RAYCONTACT_DEMOS_TWO_BODIES_OPTIONS_HPP
