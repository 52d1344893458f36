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

#include "../../evaluation/demos/distributed/number_bits.hpp"
#include "raycontact/mpi.hpp"
#include "rubbing_shapes.hpp"

namespace rubbing {

constexpr double dt = 1.0 / 60.0;
constexpr int iterations = 6, solves = 2;

/** What a step does besides; one of each kind of system may do without one of these, and its bits must be others. */
struct Uses {
  bool looks_again = false, has_materials = false, has_half_spaces = false, has_collision = false, has_escape = false;
  bool has_energy = false, has_blocks = false;  // hashed too
  bool has_ropes = false;                       // rigid bodies fly away unless ropes hold them, which the solve knows
};

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

/** The bits of forces and of where bodies are, and of what is one number for all. */
inline uint64_t bits_of(const Host& host, const Numbers& forces, const Numbers& common) {
  uint64_t sum = 0;
  std::size_t at = 0;
  for (const auto& [key, body] : host) {
    demo::NumberBits bits(key);
    bits.add(forces.data() + at, body.unknown_count());
    bits.add(body.x.data(), body.x.size());
    bits.add(body.v.data(), body.v.size());
    bits.add(body.motion.position, 3);
    bits.add(body.motion.velocity, 6);
    bits.add(common.data(), common.size());
    sum += bits.hash();
    at += body.unknown_count();
  }
  return sum;
}

/** The bits of a matrix: each block is named by the bodies of its row and column. */
inline uint64_t bits_of(const Host& host, const raycontact::DistributedBlocks& blocks) {
  uint64_t sum = 0;
  auto body = host.begin();
  std::size_t start = 0;
  for (std::size_t i = 0; i < blocks.rows.size(); ++i) {
    while (blocks.rows[i] >= start + body->second.unknown_count() / 3) start += (body++)->second.unknown_count() / 3;
    demo::NumberBits bits(body->first);
    const double places[] = {double(blocks.rows[i] - start), double(blocks.keys[i]), double(blocks.columns[i])};
    bits.add(places, 3);
    bits.add(&blocks.numbers[9 * i], 9);
    sum += bits.hash();
  }
  return sum;
}

/** The product of a matrix's own columns with a vector, for a host that has all bodies. */
inline Numbers product_of(const Host& host, const raycontact::DistributedBlocks& blocks, const Numbers& v) {
  std::map<uint64_t, std::size_t> starts;
  std::size_t start = 0;
  for (const auto& [key, body] : host) {
    starts[key] = start;
    start += body.unknown_count();
  }
  Numbers product(v.size());
  for (std::size_t i = 0; i < blocks.rows.size(); ++i)
    for (std::size_t row = 0; row < 3; ++row)
      for (std::size_t column = 0; column < 3; ++column)
        product[3 * std::size_t{blocks.rows[i]} + row] +=
            blocks.numbers[9 * i + 3 * row + column] * v[starts.at(blocks.keys[i]) + 3 * blocks.columns[i] + column];
  return product;
}

/** Says of pairs what is different from some steps on. */
template <class System>
void say(int number, const Uses& uses, System& system) {
  const auto key = [](uint32_t body) { return key_of(body); };
  const rayc_material sticky = [] {
    rayc_material own = material(0);
    own.friction = 1.5;
    own.stiffness = 9000;
    return own;
  }();
  if (uses.has_materials && number == 1)
    for (uint32_t body : {1u, 3u, 7u, 9u, 13u}) system.set_pair_material(key(body + 1), key(body), &sticky);
  if (uses.has_materials && number == 16) system.set_pair_material(key(1), key(2), nullptr);
  if (uses.has_half_spaces && number == 1)
    for (uint32_t body = 1; body < body_count; body += 3) system.set_half_space_material(key(body), 0, &sticky);
  if (uses.has_half_spaces && number == 18) system.set_half_space_material(key(1), 0, nullptr);
  if (uses.has_escape && number == 2)
    for (uint32_t body : {4u, 10u}) system.allow_escape(key(body), key(body + 1), false);
  if (uses.has_escape && number == 17) system.allow_escape(key(5), key(4), true);
  if (uses.has_collision && number == 3)
    for (uint32_t body : {2u, 3u, 8u, 12u}) system.set_pair_collision(key(body), key(body + 1), false);
  if (uses.has_collision && number == 14) system.set_pair_collision(key(3), key(2), true);
}

/** How often contacts were looked for again, and found to be more. */
struct Looks {
  uint64_t more = 0, wrong_products = 0;
};

/** A step of the simulator; gives the bits of its numbers. `System` is one of either kind. */
template <class System>
uint64_t step(Host& host, System& system, const Uses& uses, Looks* looks = nullptr) {
  Numbers x, v, free, forces, right, direction, product, common;
  uint64_t bits = 0;
  fill(host, x, v, free);
  for (auto& [key, body] : host) {
    set_free_motion(body);
    const Kind kind = kind_of(body.number);
    if (uses.has_ropes && kind == RIGID) body.motion.free_velocity[2] += 100;
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
    std::size_t at = 0;
    for (const auto& [key, body] : host) {
      for (std::size_t k = at; k < at + 6 && uses.has_ropes && kind_of(body.number) == RIGID; ++k) end[k] = v[k];
      at += body.unknown_count();
    }
    system.linearise(end);
    if (uses.looks_again) {
      const bool is_more = system.detect_again(end);
      common.push_back(is_more ? 1 : 0);
      if (looks != nullptr) looks->more += is_more ? 1 : 0;
    }
  }
  forces.assign(end.size(), 0);
  system.add_forces(end, forces);
  if (uses.has_energy) {
    common.push_back(system.energy(end));
  }
  if (uses.has_blocks) {
    raycontact::DistributedBlocks blocks;
    system.copy_blocks_to(dt, blocks);
    bits = bits_of(host, blocks);
    if (looks != nullptr) {
      product.assign(end.size(), 0);
      system.add_product(dt, end, product);
      const Numbers by_blocks = product_of(host, blocks, end);
      double square = 0, wrong = 0;
      for (std::size_t k = 0; k < end.size(); ++k) {
        square += product[k] * product[k];
        wrong += (by_blocks[k] - product[k]) * (by_blocks[k] - product[k]);
      }
      looks->wrong_products += wrong <= 1e-20 * square ? 0 : 1;
    }
  }
  system.finish(end);
  move(host, end);
  return bits + bits_of(host, forces, common);
}

/** The same with symplectic Euler and short steps. */
template <class System>
uint64_t explicit_step(Host& host, System& system, double* longest) {
  constexpr double seconds = 1.0 / 2000;
  Numbers x, v, free, forces;
  for (auto& [key, body] : host) {
    const Kind kind = kind_of(body.number);
    if (kind == RIGID || kind == MOVED) system.set_motion(key, body.motion);
  }
  fill(host, x, v, free);
  forces.assign(v.size(), 0);
  *longest = system.explicit_step(seconds, x, v, forces);
  std::size_t at = 0;
  for (auto& [key, body] : host) {
    const Kind kind = kind_of(body.number);
    // Turning needs no more of a judge than moving does.
    for (std::size_t k = 0; k < 3 && kind == RIGID; ++k)
      body.motion.velocity[k] += seconds * (forces[at + k] / rigid_mass - (k == 2 ? 9.81 : 0));
    for (std::size_t k = 0; k < body.x.size(); ++k) {
      body.v[k] += seconds * ((free[at + k] - v[at + k]) / dt + forces[at + k] / node_mass(body.number));
      body.x[k] += seconds * body.v[k];
    }
    if (kind == RIGID || kind == MOVED)
      for (std::size_t k = 0; k < 3; ++k) body.motion.position[k] += seconds * body.motion.velocity[k];
    at += body.unknown_count();
  }
  return bits_of(host, forces, {*longest});
}

}  // namespace rubbing

#endif
