// SPDX-License-Identifier: MIT OR Apache-2.0
#include "../scene/program.hpp"

int main(int argc, char** argv) {
  return demo::run_program(
      argc, argv,
      "Two boxes of twelve triangles fall onto one another edge across edge; no vertex of one enters the other.",
      [](const std::vector<std::string>&) {
        demo::Scene scene;
        scene.name = "boxes_edge_on_edge";
        for (int i = 0; i < 2; ++i) {
          demo::Surface box = demo::box({{2, 0.7, 0.7}});
          demo::rotate(box, {{1, 0, 0}}, 0.7853981633974483);
          if (i == 1) demo::rotate(box, {{0, 1, 0}}, 1.5707963267948966);
          demo::move(box, {{0, i == 0 ? 0.0 : 0.9, 0}});
          scene.bodies.push_back({"box", demo::caged(box, 4), 30 * demo::volume(box)});
        }
        scene.bodies[0].velocity = btVector3(0, 1, 0);
        scene.bodies[1].velocity = btVector3(0, -1, 0);
        scene.duration = 2;
        scene.passed_through = [](const demo::State& state) {
          return demo::State::centre(state.now[1])[1] < demo::State::centre(state.now[0])[1];
        };
        return scene;
      });
}
