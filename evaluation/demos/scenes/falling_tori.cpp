// SPDX-License-Identifier: MIT OR Apache-2.0
#include <cmath>

#include "../scene/program.hpp"

int main(int argc, char** argv) {
  return demo::run_program(
      argc, argv, "Figure 11: ten tori of 1600 triangles in 6 x 5 x 2 cages fall onto a floor and one another.",
      [](const std::vector<std::string>&) {
        demo::Scene scene;
        scene.name = "falling_tori";
        scene.youngs_modulus = 2e4;
        scene.gravity = btVector3(0, btScalar(-9.81), 0);
        scene.has_floor = true;
        scene.friction = 0.3;
        scene.inside_tolerance = 0.005;
        scene.duration = 2;
        scene.iterations = 25;  // fewer than a full solve needs: they damp impacts, for every method alike
        scene.depth_tolerance = 0.1;
        for (int i = 0; i < 10; ++i) {
          demo::Surface torus = demo::torus();
          demo::move(torus, {{0.001 * std::sin(2.0 * i), 0.6 + i, 0.001 * std::cos(3.0 * i)}});
          scene.bodies.push_back({torus.name, demo::caged_torus(torus), 3 * demo::volume(torus)});
        }
        scene.passed_through = [](const demo::State& state) {
          double below = 0;
          for (const std::vector<double>& body : state.now) {
            const double height = demo::State::centre(body)[1];
            if (height < below) return true;
            below = height;
          }
          return false;
        };
        return scene;
      });
}
