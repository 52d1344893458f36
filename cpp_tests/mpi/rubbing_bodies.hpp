// Bodies that fall on a floor and on one another, for a contact system of one process and for a distributed one: soft
// tori, one of which is in a cage, rigid ones, one that the host turns, and small ones inside others, which escape. All
// rub. A small simulator: implicit Euler, conjugate gradients that know contact by its forces and products alone.
#ifndef RUBBING_BODIES_HPP
#define RUBBING_BODIES_HPP

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <vector>

#include "../../demos/distributed/number_bits.hpp"
#include "raycontact/mpi.hpp"
#include "torus.hpp"

namespace rubbing {

constexpr double dt = 1.0 / 60.0;
constexpr uint32_t body_count = 18;
constexpr int iterations = 6, solves = 2;
enum Kind { SOFT, CAGED, RIGID, MOVED };

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
  material.depth_cap = 0.05;
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
    const double speed = is_small(number) ? 0 : 0.5 * std::sin(1.7 * number + 2.1 * static_cast<double>(axis));
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

/** Turns the body on by an angle vector. */
inline void turn(rayc_motion& motion, const double* angle) {
  const double size = std::sqrt(angle[0] * angle[0] + angle[1] * angle[1] + angle[2] * angle[2]);
  if (size == 0) return;
  const double a[] = {angle[0] / size, angle[1] / size, angle[2] / size}, c = std::cos(size), s = std::sin(size);
  const rayc_motion before = motion;
  for (int column = 0; column < 3; ++column) {
    const double p[] = {before.rotation[0][column], before.rotation[1][column], before.rotation[2][column]};
    const double along = a[0] * p[0] + a[1] * p[1] + a[2] * p[2];
    const double cross[] = {a[1] * p[2] - a[2] * p[1], a[2] * p[0] - a[0] * p[2], a[0] * p[1] - a[1] * p[0]};
    for (int row = 0; row < 3; ++row)
      motion.rotation[row][column] = p[row] * c + cross[row] * s + a[row] * along * (1 - c);
  }
}

/** R I R^T w. */
inline std::array<double, 3> momentum(const rayc_motion& motion, const double* w) {
  std::array<double, 3> own{}, world{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k) own[i] += motion.rotation[k][i] * w[k];
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k) world[i] += motion.rotation[i][k] * rigid_inertia[4 * k] * own[k];
  return world;
}

using Host = std::map<uint64_t, Body>;
using Numbers = std::vector<double>;

/** Mass times a vector, for the bodies that are here. */
inline void add_inertia(const Host& host, double factor, const Numbers& v, Numbers& result) {
  std::size_t at = 0;
  for (const auto& [key, body] : host) {
    if (kind_of(body.number) == RIGID) {
      const std::array<double, 3> angular = momentum(body.motion, &v[at + 3]);
      for (std::size_t k = 0; k < 3; ++k) {
        result[at + k] += factor * rigid_mass * v[at + k];
        result[at + 3 + k] += factor * angular[k];
      }
    } else {
      for (std::size_t k = 0; k < body.x.size(); ++k) result[at + k] += factor * node_mass(body.number) * v[at + k];
    }
    at += body.unknown_count();
  }
}

/** Velocities without contact: gravity, and springs that hold each node where it belongs about its body's middle. */
inline void fill(const Host& host, Numbers& x, Numbers& v, Numbers& free) {
  for (Numbers* numbers : {&x, &v, &free}) numbers->clear();
  for (const auto& [key, body] : host) {
    if (kind_of(body.number) == RIGID) {
      for (std::size_t k = 0; k < 6; ++k) {
        x.push_back(0);
        v.push_back(body.motion.velocity[k]);
        free.push_back(body.motion.free_velocity[k]);
      }
      continue;
    }
    const std::vector<double> rest = nodes_of(body.number);
    double middle[3] = {}, drift[3] = {};
    const double count = static_cast<double>(body.x.size() / 3);
    for (std::size_t i = 0; i < body.x.size(); ++i) {
      middle[i % 3] += body.x[i] / count;
      drift[i % 3] += body.v[i] / count;
    }
    for (std::size_t i = 0; i < body.x.size(); ++i) {
      const double pull = 600 * (middle[i % 3] + rest[i] - body.x[i]) + 20 * (drift[i % 3] - body.v[i]);
      x.push_back(body.x[i]);
      v.push_back(body.v[i]);
      free.push_back(body.v[i] + dt * (pull + (i % 3 == 2 ? -9.81 : 0)));
    }
  }
}

inline void set_free_motion(Body& body) {
  for (std::size_t k = 0; k < 6; ++k) body.motion.free_velocity[k] = body.motion.velocity[k];
  if (kind_of(body.number) == RIGID) body.motion.free_velocity[2] -= 9.81 * dt;
}

inline void move(Host& host, const Numbers& v) {
  std::size_t at = 0;
  for (auto& [key, body] : host) {
    const Kind kind = kind_of(body.number);
    for (std::size_t k = 0; k < 6 && kind == RIGID; ++k) body.motion.velocity[k] = v[at + k];
    for (std::size_t k = 0; k < body.x.size(); ++k) {
      body.v[k] = v[at + k];
      body.x[k] += dt * v[at + k];
    }
    if (kind == RIGID || kind == MOVED) {
      const double angle[] = {dt * body.motion.velocity[3], dt * body.motion.velocity[4], dt * body.motion.velocity[5]};
      for (std::size_t k = 0; k < 3; ++k) body.motion.position[k] += dt * body.motion.velocity[k];
      turn(body.motion, angle);
    }
    at += body.unknown_count();
  }
}

/** The bits of forces and of where bodies are. */
inline uint64_t bits_of(const Host& host, const Numbers& forces) {
  uint64_t sum = 0;
  std::size_t at = 0;
  for (const auto& [key, body] : host) {
    demo::NumberBits bits(key);
    bits.add(forces.data() + at, body.unknown_count());
    bits.add(body.x.data(), body.x.size());
    bits.add(body.v.data(), body.v.size());
    bits.add(body.motion.position, 3);
    bits.add(body.motion.velocity, 6);
    sum += bits.hash();
    at += body.unknown_count();
  }
  return sum;
}

/** A step of the simulator; gives the bits of its numbers. `System` is one of either kind. */
template <class System>
uint64_t step(Host& host, System& system) {
  Numbers x, v, free, forces, right, direction, product;
  fill(host, x, v, free);
  for (auto& [key, body] : host) {
    set_free_motion(body);
    const Kind kind = kind_of(body.number);
    if (kind == RIGID || kind == MOVED) system.set_motion(key, body.motion);
  }
  fill(host, x, v, free);
  system.begin(dt, x, v, free);
  Numbers end = v;
  for (int solve = 0; solve < solves; ++solve) {
    forces.assign(end.size(), 0);
    system.add_forces(end, forces);
    // (M + dt K) change = dt f(end) - M (end - free)
    Numbers residual(end.size()), lag(end.size());
    for (std::size_t k = 0; k < end.size(); ++k) lag[k] = end[k] - free[k];
    add_inertia(host, -1, lag, residual);
    for (std::size_t k = 0; k < end.size(); ++k) residual[k] += dt * forces[k];
    direction = residual;
    double square = system.dot(residual, residual);
    for (int iteration = 0; iteration < iterations && square > 0; ++iteration) {
      product.assign(end.size(), 0);
      add_inertia(host, 1, direction, product);
      system.add_product(dt, direction, product);
      const double along = square / system.dot(direction, product);
      for (std::size_t k = 0; k < end.size(); ++k) {
        end[k] += along * direction[k];
        residual[k] -= along * product[k];
      }
      const double next = system.dot(residual, residual);
      for (std::size_t k = 0; k < end.size(); ++k) direction[k] = residual[k] + next / square * direction[k];
      square = next;
    }
    system.linearise(end);
  }
  forces.assign(end.size(), 0);
  system.add_forces(end, forces);
  system.finish(end);
  move(host, end);
  return bits_of(host, forces);
}

}  // namespace rubbing

#endif
