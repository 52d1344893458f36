// SPDX-License-Identifier: MIT OR Apache-2.0
#include <cmath>
#include <stdexcept>

#include "../scene/program.hpp"

int main(int argc, char** argv) {
  return demo::run_program(
      argc, argv, "Figure 13: a heap of tori that overlap their neighbours, 200 steps; one argument: how many (4).",
      [](const std::vector<std::string>& arguments) {
        const int count = arguments.empty() ? 4 : std::stoi(arguments[0]);
        if (count < 1) throw std::invalid_argument("give a number of tori above 0");
        demo::Scene scene;
        scene.name = "growing_tori";
        scene.time_step = 0.02;
        scene.duration = 4;
        scene.iterations = 25;
        for (int i = 0; i < count; ++i) {
          demo::Surface torus = demo::torus();
          demo::rotate(torus, {{0, 1, 0}}, 0.37 * i);
          demo::rotate(torus, {{1, 0, 0}}, 0.15 * std::sin(2.1 * i));
          demo::move(torus, {{0.13 * std::sin(i), 0.6 * i, 0.13 * std::cos(1.7 * i)}});
          scene.bodies.push_back({torus.name, demo::caged_torus(torus), 30 * demo::volume(torus)});
        }
        return scene;
      });
}
