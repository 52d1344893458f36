// SPDX-License-Identifier: MIT OR Apache-2.0
#include <cmath>

#include "../scene/program.hpp"

int main(int argc, char** argv) {
  return demo::run_program(
      argc, argv, "Thirty bodies of mixed shapes fall into a pile; arguments: closed surfaces (.obj) to mix in.",
      [](const std::vector<std::string>& arguments) {
        demo::Scene scene;
        scene.name = "mixed_pile";
        std::vector<demo::Surface> shapes = {demo::torus(24, 12), demo::ball(1, 16), demo::box({{2, 1.2, 1.6}}, 6),
                                             demo::spike(0.8, 2, 12)};
        for (const std::string& path : arguments) shapes.push_back(demo::read_obj(path));
        for (int i = 0; i < 30; ++i) {
          demo::Surface body = shapes[static_cast<std::size_t>(i) % shapes.size()];
          demo::normalise(body, 1);
          demo::rotate(body, {{std::sin(1.0 * i), std::cos(2.0 * i), 0.5}}, 1.3 * i);
          demo::move(body,
                     {{1.1 * (i % 3 - 1) + 0.05 * std::sin(5.0 * i), 0.8 + 1.1 * (i / 6), 1.1 * (i / 3 % 2) - 0.5}});
          scene.bodies.push_back({body.name, demo::caged(body, 4), 30 * demo::volume(body)});
        }
        scene.has_floor = true;
        scene.gravity = btVector3(0, btScalar(-9.81), 0);
        scene.youngs_modulus = 2e4;
        scene.friction = 0.3;
        scene.iterations = 50;
        scene.duration = 3;
        scene.depth_tolerance = 0.05;
        scene.inside_tolerance = 0.01;
        scene.passed_through = [](const demo::State& state) {
          for (const auto& body : state.now)
            if (demo::State::centre(body)[1] < 0) return true;
          return false;
        };
        return scene;
      });
}
