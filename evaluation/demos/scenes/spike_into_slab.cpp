// SPDX-License-Identifier: MIT OR Apache-2.0
#include "../scene/program.hpp"

int main(int argc, char** argv) {
  return demo::run_program(
      argc, argv, "A spike flies point first into a slab on the floor.", [](const std::vector<std::string>&) {
        demo::Scene scene;
        scene.name = "spike_into_slab";
        demo::Surface slab = demo::box({{2, 0.5, 2}}, 12), spike = demo::spike(0.4, 1.2, 16);
        demo::move(slab, {{0, 0.25, 0}});
        demo::move(spike, {{0.05, 1.15, 0.03}});
        scene.bodies.push_back({"slab", demo::caged(slab, 6), 30 * demo::volume(slab)});
        scene.bodies.push_back({"spike", demo::caged(spike, 6), 30 * demo::volume(spike)});
        scene.bodies[1].velocity = btVector3(0, -3, 0);
        scene.has_floor = true;
        scene.gravity = btVector3(0, btScalar(-9.81), 0);
        scene.youngs_modulus = 2e4;
        scene.duration = 2;
        scene.depth_tolerance = 0.05;
        scene.inside_tolerance = 0.01;
        scene.passed_through = [](const demo::State& state) { return demo::State::centre(state.now[1])[1] < 0.2; };
        return scene;
      });
}
