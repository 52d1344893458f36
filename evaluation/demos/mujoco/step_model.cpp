// SPDX-License-Identifier: MIT OR Apache-2.0
#include <cstdio>
#include <exception>
#include <string>

#include "../command_line.hpp"
#include "raycontact/mujoco.hpp"

namespace {

// The page docs/mujoco.md shows this function.
void step(const mjModel* m, mjData* d, double seconds) {
  raycontact::mujoco::ContactOptions options;
  options.friction = 0.3;
  // As long as it lives, mj_step has contact between the model's flexes.
  const raycontact::mujoco::AttachedContact contact(m, d, options);
  for (const double end = d->time + seconds; d->time < end;) mj_step(m, d);
  if (!contact.error().empty()) std::fprintf(stderr, "%s\n", contact.error().c_str());
}

void print_usage(FILE* out) {
  std::fputs(
      "usage: mujoco_step MODEL.xml [--seconds SECONDS] [--plugin LIBRARY]\n\n"
      "Steps a model of MuJoCo's with raycontact between its flexes, or with the engine plugin in LIBRARY where the "
      "model\n"
      "switches it on, and prints where the centre of each flex's vertices ends.\n"
      "Exit status: 0, or 1 where the model is refused, 2 wrong usage.\n",
      out);
}

int run(const char* file, const char* library, double seconds) {
  if (library != nullptr) mj_loadPluginLibrary(library);
  char message[1000] = "";
  mjModel* m = mj_loadXML(file, nullptr, message, sizeof message);
  if (m == nullptr) return std::fprintf(stderr, "mujoco_step: %s\n", message), 1;
  mjData* d = mj_makeData(m);
  int status = 0;
  try {
    if (library == nullptr)
      step(m, d, seconds);
    else
      while (d->time < seconds) mj_step(m, d);
    for (int flex = 0; flex < m->nflex; ++flex) {
      mjtNum centre[3] = {0, 0, 0};
      const int count = m->flex_vertnum[flex];
      for (int v = 0; v < count; ++v)
        mju_addToScl3(centre, d->flexvert_xpos + 3 * (m->flex_vertadr[flex] + v), 1.0 / count);
      std::printf("flex %d at %.4f %.4f %.4f\n", flex, centre[0], centre[1], centre[2]);
    }
  } catch (const std::exception& refused) {
    std::fprintf(stderr, "mujoco_step: %s\n", refused.what());
    status = 1;
  }
  mj_deleteData(d);
  mj_deleteModel(m);
  return status;
}

}  // namespace

int main(int argc, char** argv) try {
  const char *file = nullptr, *library = nullptr;
  double seconds = 1;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--help" || argument == "-h") return print_usage(stdout), 0;
    if (demo::take_number({{"--seconds", &seconds}}, argc, argv, i)) continue;
    if (argument == "--plugin") {
      if (++i == argc) throw demo::WrongUsage("--plugin needs a library");
      library = argv[i];
    } else if (argument[0] == '-' || file != nullptr) {
      throw demo::WrongUsage("unknown argument '" + argument + "'");
    } else {
      file = argv[i];
    }
  }
  if (!(seconds > 0 && seconds < 1e6)) throw demo::WrongUsage("--seconds must be above 0 and below a million");
  if (file == nullptr) throw demo::WrongUsage("name a model");
  return run(file, library, seconds);
} catch (...) {
  return demo::report_failure("mujoco_step", print_usage);
}
