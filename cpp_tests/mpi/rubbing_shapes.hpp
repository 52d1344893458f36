// Which bodies rub on a floor and on one another in rubbing_bodies.hpp, what each is made of, and how it begins.
#ifndef RUBBING_SHAPES_HPP
#define RUBBING_SHAPES_HPP

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "raycontact.h"
#include "torus.hpp"

namespace rubbing {

constexpr uint32_t body_count = 18;
enum Kind { SOFT, CAGED, RIGID, MOVED };

/** With these bodies are faster and touch one another sooner than their caps allow. */
inline double first_speed = 0.5, depth_cap = 0.05;

inline uint64_t key_of(uint32_t number) { return (number * 7919u % 65536u) * 0x100000001ull + 5; }
inline Kind kind_of(uint32_t number) {
  const Kind kinds[] = {SOFT, RIGID, SOFT, CAGED, SOFT, SOFT};
  return number == 0 ? MOVED : kinds[number % 6];
}
inline bool is_small(uint32_t number) { return number % 6 == 5; }

inline rayc_material material(uint32_t number) {
  rayc_material material{};
  material.struct_size = sizeof material;
  material.stiffness = 4000 + 500 * (number % 3);
  material.damping_time = 0.01;
  material.friction = 0.4 + 0.1 * (number % 4);
  material.depth_cap = depth_cap;
  return material;
}

constexpr std::array<double, 3> floor_normal = {0, 0, 1};
constexpr double floor_offset = -0.3;

/** About the body's middle. */
inline Torus shape_of(uint32_t number) {
  Torus shape = is_small(number) ? torus(8, 5) : torus(14, 7);
  if (is_small(number))
    for (double& x : shape.positions) x *= 0.15;
  return shape;
}

/** What the host knows of a body, all of which moves with it. */
struct Body {
  uint32_t number = 0;
  std::vector<double> x, v;  // of its nodes
  rayc_motion motion{{0, 0, 0}, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0}, {0}};

  std::size_t unknown_count() const { return kind_of(number) == RIGID ? 6 : x.size(); }
};

inline double node_mass(uint32_t number) { return kind_of(number) == CAGED ? 2.5 : is_small(number) ? 0.05 : 0.2; }
constexpr double rigid_mass = 20;
constexpr std::array<double, 9> rigid_inertia = {12, 0, 0, 0, 12, 0, 0, 0, 20};

/** Nodes about the middle: the corners of a box for a body in a cage. */
inline std::vector<double> nodes_of(uint32_t number) {
  if (kind_of(number) == SOFT) return shape_of(number).positions;
  std::vector<double> nodes;
  if (kind_of(number) == CAGED)
    for (int i = 0; i < 8; ++i)
      for (double x : {1.5 * (2 * (i & 1) - 1), 1.5 * (2 * (i >> 1 & 1) - 1), 0.5 * (2 * (i >> 2) - 1)})
        nodes.push_back(x);
  return nodes;
}

struct Table {
  std::vector<uint32_t> offsets{0}, nodes;
  std::vector<double> weights;
};

/** Trilinear weights. */
inline Table table_of(uint32_t number) {
  Table table;
  const Torus shape = shape_of(number);
  for (std::size_t i = 0; i < shape.positions.size(); i += 3) {
    const double part[] = {shape.positions[i] / 3 + 0.5, shape.positions[i + 1] / 3 + 0.5,
                           shape.positions[i + 2] + 0.5};
    for (uint32_t corner = 0; corner < 8; ++corner) {
      double weight = 1;
      for (uint32_t axis = 0; axis < 3; ++axis) weight *= (corner >> axis & 1) != 0 ? part[axis] : 1 - part[axis];
      table.nodes.push_back(corner);
      table.weights.push_back(weight);
    }
    table.offsets.push_back(static_cast<uint32_t>(table.nodes.size()));
  }
  return table;
}

inline Body first_state(uint32_t number) {
  Body body;
  body.number = number;
  const uint32_t place = is_small(number) ? number - 1 : number;
  const double at[] = {1.5 * (place % 3) + (is_small(number) ? 1.0 : 0.0), 1.6 * (place / 3 % 3), 0.65 * (place / 9)};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double speed = is_small(number) ? 0 : first_speed * std::sin(1.7 * number + 2.1 * static_cast<double>(axis));
    body.motion.position[axis] = at[axis];
    body.motion.velocity[axis] = body.motion.free_velocity[axis] = kind_of(number) == MOVED ? 0 : speed;
  }
  if (kind_of(number) == MOVED) body.motion.velocity[5] = body.motion.free_velocity[5] = 0.5;
  body.x = nodes_of(number);
  for (std::size_t i = 0; i < body.x.size(); ++i) {
    body.x[i] += at[i % 3];
    body.v.push_back(body.motion.velocity[i % 3]);
  }
  return body;
}

}  // namespace rubbing

#endif
