// SPDX-License-Identifier: MIT OR Apache-2.0
#include <cmath>
#include <cstdlib>
#include <stdexcept>

#include "../scene/program.hpp"

namespace {

double offset_of(const std::vector<std::string>& arguments) {
  if (arguments.empty()) return 0.2;
  char* end = nullptr;
  const double offset = std::strtod(arguments[0].c_str(), &end);
  if (arguments.size() > 1 || *end != '\0' || !(offset >= 0 && offset < 0.5))
    throw std::invalid_argument("the offset must be one number from 0 to below 0.5, not \"" + arguments[0] + "\"");
  return offset;
}

}  // namespace

int main(int argc, char** argv) {
  return demo::run_program(
      argc, argv,
      "Five boxes on one another, each set off against the one below, to and fro; argument: by how much of an edge\n"
      "(0.2). They must stay.",
      [](const std::vector<std::string>& arguments) {
        const double offset = offset_of(arguments);
        demo::Scene scene;
        scene.name = "offset_stack";
        for (int i = 0; i < 5; ++i) {
          demo::Surface box = demo::box({{1, 0.5, 1}}, 4);
          demo::move(box, {{i % 2 == 0 ? 0 : offset, 0.25 + 0.5 * i, 0}});
          scene.bodies.push_back({"box", demo::caged(box, 2), 3 * demo::volume(box)});
        }
        scene.has_floor = true;
        scene.gravity = btVector3(0, btScalar(-9.81), 0);
        scene.youngs_modulus = 2e4;
        scene.friction = 0.5;
        scene.duration = 10;
        scene.sample_spacing = 0.4;
        scene.depth_tolerance = 0.05;
        scene.inside_tolerance = 0.01;
        scene.passed_through = [offset](const demo::State& state) {
          for (std::size_t i = 0; i < state.now.size(); ++i) {
            const auto centre = demo::State::centre(state.now[i]);
            const double there = i % 2 == 0 ? 0 : offset;
            if (centre[1] < 0.5 * static_cast<double>(i) || std::fabs(centre[0] - there) > 0.1) return true;
          }
          return false;
        };
        return scene;
      });
}
