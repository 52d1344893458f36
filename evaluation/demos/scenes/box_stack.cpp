// SPDX-License-Identifier: MIT OR Apache-2.0
#include "../scene/program.hpp"

int main(int argc, char** argv) {
  return demo::run_program(argc, argv,
                           "Ten boxes stacked at rest, for 10000 steps: they must neither drift nor gain energy.",
                           [](const std::vector<std::string>&) {
                             demo::Scene scene;
                             scene.name = "box_stack";
                             for (int i = 0; i < 10; ++i) {
                               demo::Surface box = demo::box({{1, 0.5, 1}}, 4);
                               demo::move(box, {{0, 0.25 + 0.5 * i, 0}});
                               scene.bodies.push_back({"box", demo::caged(box, 2), 3 * demo::volume(box)});
                             }
                             scene.has_floor = true;
                             scene.gravity = btVector3(0, btScalar(-9.81), 0);
                             scene.youngs_modulus = 2e4;
                             scene.friction = 0.5;
                             scene.duration = 200;
                             scene.sample_spacing = 0.4;
                             scene.settling_steps = 1500;
                             scene.drift_tolerance = 1e-4;
                             scene.depth_tolerance = 0.05;
                             scene.inside_tolerance = 0.01;
                             scene.passed_through = [](const demo::State& state) {
                               for (std::size_t i = 0; i < state.now.size(); ++i)
                                 if (demo::State::centre(state.now[i])[1] < 0.5 * static_cast<double>(i)) return true;
                               return false;
                             };
                             return scene;
                           });
}
