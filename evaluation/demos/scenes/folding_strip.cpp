// SPDX-License-Identifier: MIT OR Apache-2.0
#include <cmath>

#include "../scene/program.hpp"

int main(int argc, char** argv) {
  return demo::run_program(argc, argv,
                           "A strip whose ends fly towards one another folds around a ball and onto itself.",
                           [](const std::vector<std::string>&) {
                             demo::Scene scene;
                             scene.name = "folding_strip";
                             demo::Surface strip = demo::box({{4, 0.16, 0.8}}, 40), ball = demo::ball(0.35, 20);
                             demo::move(ball, {{0, 0.5, 0}});
                             demo::SceneBody folding{"strip", demo::caged(strip, 20), 30 * demo::volume(strip)};
                             folding.self_collision = true;
                             // Its middle is held below, and gravity points the ends' way.
                             for (std::size_t n = 0; n < folding.cage.nodes.size(); ++n)
                               if (std::fabs(folding.cage.nodes[n][0]) < 0.15)
                                 folding.pinned.push_back(static_cast<int>(n));
                             scene.bodies.push_back(folding);
                             scene.bodies.push_back({"ball", demo::caged(ball, 3), 30 * demo::volume(ball)});
                             scene.bodies[1].velocity = btVector3(0, -1, 0);
                             scene.gravity = btVector3(0, btScalar(-9.81), 0);
                             scene.youngs_modulus = 2e4;
                             scene.duration = 3;
                             scene.depth_tolerance = 0.05;
                             scene.inside_tolerance = 0.01;
                             return scene;
                           });
}
