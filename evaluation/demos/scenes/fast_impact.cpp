// SPDX-License-Identifier: MIT OR Apache-2.0
#include "../scene/program.hpp"

int main(int argc, char** argv) {
  return demo::run_program(argc, argv,
                           "Two balls that meet at a speed that carries them half their diameter in a step of 0.1 s.",
                           [](const std::vector<std::string>&) {
                             demo::Scene scene;
                             scene.name = "fast_impact";
                             for (int i = 0; i < 2; ++i) {
                               demo::Surface ball = demo::ball(0.5, 24);
                               demo::move(ball, {{i == 0 ? -0.6 : 0.6, 0, 0.05 * i}});
                               scene.bodies.push_back({"ball", demo::caged(ball, 5), 30 * demo::volume(ball)});
                               scene.bodies.back().velocity = btVector3(i == 0 ? btScalar(2.5) : btScalar(-2.5), 0, 0);
                             }
                             scene.youngs_modulus = 2e4;
                             scene.time_step = 0.1;
                             scene.duration = 2;
                             scene.passed_through = [](const demo::State& state) {
                               return demo::State::centre(state.now[1])[0] < demo::State::centre(state.now[0])[0];
                             };
                             return scene;
                           });
}
