// SPDX-License-Identifier: MIT OR Apache-2.0
#include "../scene/program.hpp"

int main(int argc, char** argv) {
  return demo::run_program(
      argc, argv, "Figure 10: two tori of 1600 triangles and 2400 tetrahedra, started deep inside one another.",
      [](const std::vector<std::string>&) {
        demo::Scene scene;
        scene.name = "two_tori";
        for (int i = 0; i < 2; ++i) {
          demo::Surface torus = demo::torus();
          if (i == 1) demo::move(torus, {{0.25, 0.1, 0.3}});
          scene.bodies.push_back({torus.name, demo::filled_torus(torus), 30 * demo::volume(torus)});
        }
        return scene;
      });
}
