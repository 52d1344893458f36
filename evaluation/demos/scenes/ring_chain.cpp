// SPDX-License-Identifier: MIT OR Apache-2.0
#include <cmath>

#include "../scene/program.hpp"

int main(int argc, char** argv) {
  return demo::run_program(
      argc, argv, "Figure 12: a chain of four rings, the topmost held at its top, falls into its links.",
      [](const std::vector<std::string>&) {
        demo::Scene scene;
        scene.name = "ring_chain";
        scene.youngs_modulus = 2e4;
        scene.gravity = btVector3(0, btScalar(-9.81), 0);
        scene.damping_alpha = 0.5;
        scene.depth_tolerance = 0.1;
        scene.inside_tolerance = 0.01;
        scene.links = 3;
        scene.time_step = 0.05;
        scene.duration = 3;
        const double quarter = std::acos(0.0);
        for (int i = 0; i < 4; ++i) {
          demo::Surface torus = demo::torus();
          demo::rotate(torus, {{1, 0, 0}}, quarter);
          if (i % 2 == 1) demo::rotate(torus, {{0, 1, 0}}, quarter);
          demo::move(torus, {{0, -1.1 * i, 0}});
          scene.bodies.push_back({torus.name, demo::filled_torus(torus), 3 * demo::volume(torus)});
        }
        const auto& nodes = scene.bodies[0].cage.nodes;
        for (std::size_t n = 0; n < nodes.size(); ++n)
          if (nodes[n][1] > 1.1) scene.bodies[0].pinned.push_back(static_cast<int>(n));
        scene.links_kept = [](const demo::State& state) {
          int kept = 0;
          for (std::size_t i = 0; i + 1 < state.now.size(); ++i)
            kept +=
                demo::linking_number(demo::middle_line(state.now[i]), demo::middle_line(state.now[i + 1])) != 0 ? 1 : 0;
          return kept;
        };
        return scene;
      });
}
