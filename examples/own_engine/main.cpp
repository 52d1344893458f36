// SPDX-License-Identifier: MIT OR Apache-2.0
/** Two boxes of springs fall onto a floor, the one onto the other, and come to rest. */
#include <cstdio>

#include "engine.hpp"

namespace {

/** Eight corners, a spring between each two of them, and two triangles a side. */
own::Body box(const own::Vector& lowest, double edge) {
  own::Body body;
  for (std::size_t n = 0; n < 8; ++n) {
    own::Vector corner = lowest;
    for (std::size_t axis = 0; axis < 3; ++axis) corner[axis] += (n >> axis & 1) != 0 ? edge : 0;
    body.nodes.push_back(corner);
    for (std::size_t other = 0; other < n; ++other) body.springs.push_back({{other, n}});
  }
  body.triangles = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                    2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
  return body;
}

}  // namespace

int main() {
  own::Engine engine;
  engine.gravity = {{0, 0, -9.81}};
  engine.is_guarded = true;
  // Bears 10 kPa where surfaces are 5 mm deep in one another.
  const rayc_material material = raycontact::bearing_material(1e4, 0.005);
  engine.add_floor({{0, 0, 1}}, material);
  engine.add(box({{0, 0, 0.1}}, 0.4), 10, 2e4, material);
  engine.add(box({{0.1, 0.1, 0.8}}, 0.4), 10, 2e4, material);
  for (int step = 0; step <= 180; ++step) {
    if (step % 30 == 0)
      std::printf("%.1f s: boxes at %.2f and %.2f m, fastest node %.2f m/s\n", step / 60.0, engine.centre(0)[2],
                  engine.centre(1)[2], engine.fastest());
    engine.step(1.0 / 60);
  }
}
