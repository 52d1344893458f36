// Bodies that drift through one another, for a plain scene and for a distributed one: tori that touch their neighbours,
// some of which overlap themselves, with small ones inside them that must escape. They sway as they go, so that
// vertices have velocities of their own, and forces move them.
#ifndef DRIFTING_BODIES_HPP
#define DRIFTING_BODIES_HPP

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "../../evaluation/demos/distributed/number_bits.hpp"
#include "raycontact.hpp"
#include "torus.hpp"

constexpr double step_length = 1.0 / 60.0;

inline rayc_response_options response() {
  rayc_response_options response = raycontact::default_response_options();
  response.stiffness = 400;
  response.damping_time = 0.002;
  return response;
}

/** Keys are far apart and in another order than the bodies. */
inline uint64_t key_of(uint32_t number) { return (number * 7919u % 65536u) * 0x100000001ull + 5; }

/** What the host knows of a body; all of it moves with the body. */
struct Body {
  uint32_t number = 0;
  int32_t steps = 0;
  std::array<double, 3> offset{}, velocity{};
};

inline bool is_folded(const Body& body) { return body.number % 5 == 3; }

inline Torus rest_shape(const Body& body) {
  const bool is_small = body.number % 5 == 4;
  Torus shape = is_small ? torus(8, 5) : torus(16, 8);
  if (is_folded(body)) {
    // A second torus that crosses the first, in one mesh.
    const uint32_t count = static_cast<uint32_t>(shape.positions.size() / 3);
    const Torus first = shape;
    for (std::size_t i = 0; i < first.positions.size(); ++i)
      shape.positions.push_back(0.8 * first.positions[i] + (i % 3 == 0 ? 0.7 : 0.13));
    for (uint32_t vertex : first.triangles) shape.triangles.push_back(vertex + count);
  }
  if (is_small)
    for (double& number : shape.positions) number *= 0.15;
  return shape;
}

inline raycontact::Mesh mesh_of(const Torus& shape, rayc_scalar precision) {
  rayc_mesh_options options = raycontact::default_mesh_options();
  options.precision = precision;
  return {raycontact::vectors(shape.positions), shape.triangles, options};
}

inline rayc_scene_options scene_options(rayc_scalar precision) {
  rayc_scene_options options = raycontact::default_scene_options();
  options.precision = precision;
  return options;
}

inline Body first_state(uint32_t number) {
  Body body;
  body.number = number;
  const bool is_small = number % 5 == 4;
  // In a grid three wide; small ones in the tube of the body before them.
  const uint32_t place = is_small ? number - 1 : number;
  body.offset = {1.5 * (place % 3) + (is_small ? 1.0 : 0.0), 1.6 * (place / 3 % 3), 0.6 * (place / 9)};
  for (std::size_t axis = 0; axis < 3; ++axis)
    body.velocity[axis] = is_small ? 0 : 0.6 * std::sin(1.7 * number + 2.1 * static_cast<double>(axis));
  return body;
}

/** Where the vertices are, and how fast they move. */
inline void place(const Body& body, const Torus& rest, std::vector<double>& positions,
                  std::vector<double>& velocities) {
  const double time = body.steps * step_length, rate = 5 + body.number % 3;
  positions.resize(rest.positions.size());
  velocities.resize(rest.positions.size());
  for (std::size_t i = 0; i < rest.positions.size(); ++i) {
    const std::size_t axis = i % 3, other = i - axis + (axis + 1) % 3;
    const double sway = 0.06 * rest.positions[other];
    positions[i] = rest.positions[i] + sway * std::sin(rate * time) + body.offset[axis];
    velocities[i] = sway * rate * std::cos(rate * time) + body.velocity[axis];
  }
}

inline void move(Body& body, const double* forces, std::size_t count) {
  std::array<double, 3> sum{};
  for (std::size_t i = 0; i < count; ++i) sum[i % 3] += forces[i];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    body.velocity[axis] += step_length * sum[axis] / 20;
    body.offset[axis] += step_length * body.velocity[axis];
  }
  ++body.steps;
}

/** Switches pairs off and on, and lets some not escape: `collide(a, b, is_on)` and `escape(a, b, is_allowed)` are told
 * the bodies' numbers. */
template <class Collide, class Escape>
void say(int step, uint32_t count, Collide collide, Escape escape) {
  for (uint32_t body = 0; body + 1 < count; ++body) {
    const bool holds_small = body % 5 == 3;
    if (step == 2 && holds_small && body % 10 == 3) escape(body + 1, body, false);
    if (step == 27 && holds_small && body % 20 == 3) escape(body, body + 1, true);
    if (step == 6 && body % 4 == 1) collide(body, body + 1, false);
    if (step == 22 && body % 8 == 1) collide(body + 1, body, true);
  }
}

/** The bits of a body's forces and its state; sums over bodies do not depend on their order. */
inline uint64_t digest(const Body& body, const double* forces, std::size_t count) {
  demo::NumberBits bits(key_of(body.number));
  bits.add(forces, count);
  bits.add(body.offset.data(), body.offset.size());
  bits.add(body.velocity.data(), body.velocity.size());
  return bits.hash();
}

struct Outcome {
  uint64_t hash = 0, contacts = 0, escapes = 0, self_contacts = 0, crowded = 0;

  void add(uint64_t step_hash, const rayc_statistics& statistics) {
    const auto estimated = static_cast<uint64_t>(1e15 * statistics.error_estimated);
    hash = (hash ^ (step_hash + statistics.contacts + 3 * statistics.rays + 5 * estimated)) * 0x100000001b3ull;
    contacts += statistics.contacts;
    escapes += statistics.escaping_pairs;
    self_contacts += statistics.self_contacts;
    crowded += statistics.crowded_pairs;
  }
};

/** The judge: one scene of one process, its forces summed pair by pair. */
inline Outcome run_plain(uint32_t count, int steps, rayc_scalar precision, bool says) {
  raycontact::Scene scene(scene_options(precision));
  raycontact::Contacts contacts;
  std::vector<Body> bodies;
  std::vector<Torus> rests;
  std::vector<std::vector<double>> velocities(count), forces(count);
  std::vector<double> positions;
  for (uint32_t number = 0; number < count; ++number) {
    bodies.push_back(first_state(number));
    rests.push_back(rest_shape(bodies.back()));
    const Torus& rest = rests.back();
    scene.add(mesh_of(rest, precision), key_of(number));
    scene.set_self_collision(number, is_folded(bodies.back()));
    forces[number].resize(rest.positions.size());
  }
  Outcome outcome;
  std::vector<rayc_pair_forces> pairs;
  std::vector<rayc_vertex_force> summed;
  for (int step = 0; step < steps; ++step) {
    if (says)
      say(
          step, count, [&](uint32_t a, uint32_t b, bool is_on) { scene.set_pair_collision(a, b, is_on); },
          [&](uint32_t a, uint32_t b, bool is_allowed) { scene.allow_escape(a, b, is_allowed); });
    std::vector<rayc_vectors> views;
    for (uint32_t number = 0; number < count; ++number) {
      place(bodies[number], rests[number], positions, velocities[number]);
      scene.set_positions(number, raycontact::vectors(positions));
      views.push_back(raycontact::vectors(velocities[number]));
      forces[number].assign(positions.size(), 0);
    }
    scene.query(contacts);
    contacts.sum_pair_forces_to(response(), pairs, summed, views);
    for (const rayc_pair_forces& pair : pairs)
      for (std::size_t i = 0; i < pair.first_count + pair.second_count; ++i) {
        const rayc_vertex_force& at = summed[pair.start + i];
        std::vector<double>& of_body = forces[i < pair.first_count ? pair.first : pair.second];
        for (std::size_t axis = 0; axis < 3; ++axis) of_body[3 * at.vertex + axis] += at.force[axis];
      }
    scene.advance(step_length);
    uint64_t hash = 0;
    for (uint32_t number = 0; number < count; ++number) {
      move(bodies[number], forces[number].data(), forces[number].size());
      hash += digest(bodies[number], forces[number].data(), forces[number].size());
    }
    outcome.add(hash, contacts.statistics());
  }
  return outcome;
}

#endif
