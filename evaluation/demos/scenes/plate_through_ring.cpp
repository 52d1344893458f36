// SPDX-License-Identifier: MIT OR Apache-2.0
#include "../scene/program.hpp"

int main(int argc, char** argv) {
  return demo::run_program(argc, argv, "A thin plate starts across the edge of a ring's hole.",
                           [](const std::vector<std::string>&) {
                             demo::Scene scene;
                             scene.name = "plate_through_ring";
                             demo::Surface torus = demo::torus(), plate = demo::box({{1.2, 0.1, 1.2}}, 12);
                             demo::rotate(plate, {{0, 0, 1}}, 0.4);
                             demo::move(plate, {{0.75, 0.05, 0}});
                             scene.bodies.push_back({torus.name, demo::filled_torus(torus), 30 * demo::volume(torus)});
                             scene.bodies.push_back({"plate", demo::caged(plate, 6), 30 * demo::volume(plate)});
                             return scene;
                           });
}
