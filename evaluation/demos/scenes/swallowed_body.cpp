// SPDX-License-Identifier: MIT OR Apache-2.0
#include "../scene/program.hpp"

int main(int argc, char** argv) {
  return demo::run_program(argc, argv, "A small ball starts wholly inside a large box, off its middle.",
                           [](const std::vector<std::string>&) {
                             demo::Scene scene;
                             scene.name = "swallowed_body";
                             demo::Surface box = demo::box({{2, 2, 2}}, 8), ball = demo::ball(0.4, 16);
                             demo::move(ball, {{0.3, 0.1, -0.2}});
                             scene.bodies.push_back({"box", demo::caged(box, 4), 30 * demo::volume(box)});
                             scene.bodies.push_back({"ball", demo::caged(ball, 3), 30 * demo::volume(ball)});
                             return scene;
                           });
}
