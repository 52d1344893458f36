// SPDX-License-Identifier: MIT OR Apache-2.0
// Bullet's deformable examples, built anew, with Bullet's own contact and with raycontact's: a table.
#include <cstdio>
#include <cstring>
#include <ctime>
#include <functional>
#include <memory>
#include <string>

#include "scenes.hpp"

namespace {

struct Entry {
  const char* name;
  double seconds;
  int steps_a_frame;  // as in Bullet's example
  std::function<std::unique_ptr<demo::Example>(bool)> make;
};

const Entry entries[] = {
    {"PinchFriction", 4, 4, [](bool is_ours) { return demo::Pinched::friction(is_ours); }},
    {"Pinch", 4, 4, [](bool is_ours) { return demo::Pinched::alone(is_ours); }},
    {"VolumetricDeformable", 3, 4, [](bool is_ours) { return std::make_unique<demo::Buried>(is_ours); }},
    {"Collide", 1, 1, [](bool is_ours) { return std::make_unique<demo::Collided>(is_ours); }},
    {"GraspDeformable", 12, 4, [](bool is_ours) { return std::make_unique<demo::Grasped>(is_ours); }},
};

void run(const Entry& entry, bool is_ours) {
  const std::unique_ptr<demo::Example> example = entry.make(is_ours);
  const int frames = static_cast<int>(60 * entry.seconds);
  double deepest = 0, ms = 0;
  int inverted = 0, frame = 0;
  for (; frame < frames; ++frame) {
    const std::clock_t start = std::clock();
    for (int step = 0; step < entry.steps_a_frame; ++step) example->step(1.0 / 60 / entry.steps_a_frame);
    ms += 1000.0 * double(std::clock() - start) / CLOCKS_PER_SEC;
    if (std::isnan(example->fastest())) break;
    deepest = std::max(deepest, example->deepest());
    inverted = std::max(inverted, example->inverted());
  }
  std::printf("| %s | %s | ", entry.name, is_ours ? "raycontact" : "Bullet");
  if (frame < frames)
    std::printf("%.3g | – | %d | not finite after %.1f s | %.2g | – |\n", deepest, inverted, frame / 60.0,
                ms / (frame + 1));
  else
    std::printf("%.3g | %.3g | %d | %.2g | %.2g | %s |\n", deepest, example->deepest(), inverted, example->fastest(),
                ms / frames, example->outcome().c_str());
  std::fflush(stdout);
}

void usage(std::FILE* to) {
  std::fprintf(
      to,
      "usage: bullet_examples [scene]...\n\n"
      "Runs scenes with the sizes and materials of Bullet's deformable examples, each with Bullet's own contact\n"
      "and with raycontact's, and prints a table: the deepest node in another body at most and at the end, m;\n"
      "inverted elements at most; the fastest node at the end, m/s; ms of processor time a frame of 1/60 s; what came\n"
      "of it.\n"
      "Scenes, all unless named:");
  for (const Entry& entry : entries) std::fprintf(to, " %s", entry.name);
  std::fprintf(to, "\nExit status: 0 when all ran, 2 for a wrong command line.\n");
}

}  // namespace

int main(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--help") == 0 || std::strcmp(argv[i], "-h") == 0) return usage(stdout), 0;
    bool is_known = false;
    for (const Entry& entry : entries) is_known = is_known || std::strcmp(argv[i], entry.name) == 0;
    if (is_known) continue;
    usage(stderr);
    std::fprintf(stderr, "bullet_examples: there is no scene '%s'\n", argv[i]);
    return 2;
  }
  std::printf("| scene | contact | deepest, m | at the end | inverted | fastest, m/s | ms a frame | outcome |\n");
  std::printf("| --- | --- | --- | --- | --- | --- | --- | --- |\n");
  for (const Entry& entry : entries) {
    bool is_asked = argc == 1;
    for (int i = 1; i < argc; ++i) is_asked = is_asked || std::strcmp(argv[i], entry.name) == 0;
    if (!is_asked) continue;
    for (const bool is_ours : {false, true}) run(entry, is_ours);
  }
}
