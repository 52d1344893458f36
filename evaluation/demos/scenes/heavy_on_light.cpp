// SPDX-License-Identifier: MIT OR Apache-2.0
#include "../scene/program.hpp"

int main(int argc, char** argv) {
  return demo::run_program(argc, argv, "A ball a thousand times as heavy as the box it falls onto.",
                           [](const std::vector<std::string>&) {
                             demo::Scene scene;
                             scene.name = "heavy_on_light";
                             demo::Surface box = demo::box({{2, 1, 2}}, 8), ball = demo::ball(0.6, 20);
                             demo::move(box, {{0, 0.5, 0}});
                             demo::move(ball, {{0.1, 1.8, 0.05}});
                             scene.bodies.push_back({"box", demo::caged(box, 5), 0.1});
                             scene.bodies.push_back({"ball", demo::caged(ball, 4), 100});
                             scene.has_floor = true;
                             scene.gravity = btVector3(0, btScalar(-9.81), 0);
                             scene.youngs_modulus = 2e4;
                             scene.duration = 2;
                             scene.friction = 0.3;
                             scene.depth_tolerance = 0.1;
                             scene.inside_tolerance = 0.01;
                             scene.passed_through = [](const demo::State& state) {
                               return demo::State::centre(state.now[1])[1] < demo::State::centre(state.now[0])[1];
                             };
                             return scene;
                           });
}
