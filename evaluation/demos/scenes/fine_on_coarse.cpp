// SPDX-License-Identifier: MIT OR Apache-2.0
#include "../scene/program.hpp"

int main(int argc, char** argv) {
  return demo::run_program(argc, argv,
                           "A ball whose triangles are a hundred times smaller than those of the box it falls onto.",
                           [](const std::vector<std::string>&) {
                             demo::Scene scene;
                             scene.name = "fine_on_coarse";
                             demo::Surface box = demo::box({{3, 1, 3}}), ball = demo::ball(0.5, 104);
                             demo::move(box, {{0, 0.5, 0}});
                             demo::move(ball, {{0.2, 1.7, 0.1}});
                             scene.bodies.push_back({"box", demo::caged(box, 6), 30 * demo::volume(box)});
                             scene.bodies.push_back({"ball", demo::caged(ball, 5), 30 * demo::volume(ball)});
                             scene.has_floor = true;
                             scene.gravity = btVector3(0, btScalar(-9.81), 0);
                             scene.youngs_modulus = 2e4;
                             scene.duration = 2;
                             scene.friction = 0.3;
                             scene.depth_tolerance = 0.05;
                             scene.inside_tolerance = 0.01;
                             return scene;
                           });
}
