// SPDX-License-Identifier: MIT OR Apache-2.0
#include "measure.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "../inside_test.hpp"

namespace demo {

namespace {

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::vector<double> vertex_normals(const std::vector<double>& x, const std::vector<uint32_t>& triangles) {
  std::vector<double> normals(x.size(), 0);
  for (std::size_t t = 0; t < triangles.size(); t += 3) {
    const double *a = &x[3 * triangles[t]], *b = &x[3 * triangles[t + 1]], *c = &x[3 * triangles[t + 2]];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t u = (k + 1) % 3, v = (k + 2) % 3;
      const double n = (b[u] - a[u]) * (c[v] - a[v]) - (b[v] - a[v]) * (c[u] - a[u]);
      for (std::size_t corner = 0; corner < 3; ++corner) normals[3 * triangles[t + corner] + k] += n;
    }
  }
  for (std::size_t i = 0; i < normals.size(); i += 3) {
    const double length = std::hypot(normals[i], normals[i + 1], normals[i + 2]);
    for (std::size_t k = 0; k < 3 && length > 0; ++k) normals[i + k] /= length;
  }
  return normals;
}

struct Motion {
  double momentum[3] = {0, 0, 0}, motion = 0, energy = 0, height = 0, peak_speed = 0;  // J of motion and of height
  bool is_finite = true;
};

Motion motion_of(const Scene& scene, const Engine& engine) {
  Motion m;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const Nodes nodes = engine.nodes(b);
    for (std::size_t n = 0; n < nodes.masses.size(); ++n) {
      const double *x = &nodes.positions[3 * n], *v = &nodes.velocities[3 * n], mass = nodes.masses[n];
      for (std::size_t a = 0; a < 3; ++a)
        if (!std::isfinite(x[a]) || !std::isfinite(v[a])) m.is_finite = false;
      if (!std::isfinite(mass)) continue;
      const double speed = std::hypot(v[0], v[1], v[2]);
      for (std::size_t a = 0; a < 3; ++a) {
        m.momentum[a] += mass * v[a];
        m.height -= mass * double(scene.gravity[static_cast<int>(a)]) * x[a];
      }
      m.motion += mass * speed;
      m.energy += 0.5 * mass * speed * speed;
      m.peak_speed = std::max(m.peak_speed, speed);
    }
  }
  return m;
}

int inverted_tetrahedra(const Cage& cage, const Nodes& nodes) {
  int count = 0;
  for (const auto& tetrahedron : cage.tetrahedra) {
    const auto at = [&](std::size_t k) { return &nodes.positions[3 * static_cast<std::size_t>(tetrahedron[k])]; };
    double edges[3][3];
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t a = 0; a < 3; ++a) edges[k][a] = at(k + 1)[a] - at(0)[a];
    double volume = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      const std::size_t u = (a + 1) % 3, v = (a + 2) % 3;
      volume += edges[0][a] * (edges[1][u] * edges[2][v] - edges[1][v] * edges[2][u]);
    }
    if (!(volume > 0)) ++count;
  }
  return count;
}

double share(const std::vector<std::vector<uint8_t>>& flags) {
  double count = 0, sum = 0;
  for (const auto& body : flags) {
    count += static_cast<double>(body.size());
    for (uint8_t f : body) sum += f;
  }
  return count > 0 ? sum / count : 0;
}

}  // namespace

Positions skin_positions(const Scene& scene, const Engine& engine) {
  Positions all;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const Nodes nodes = engine.nodes(b);
    std::vector<double> x;
    for (const raycontact::SkinPoint& point : scene.bodies[b].cage.skin.points)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        double sum = 0;
        for (std::size_t k = 0; k < 4; ++k)
          sum += point.weights[k] * nodes.positions[3 * static_cast<std::size_t>(point.nodes[k]) + axis];
        x.push_back(sum);
      }
    all.push_back(std::move(x));
  }
  return all;
}

std::vector<std::vector<uint8_t>> inside_flags(const Scene& scene, const Positions& positions, double tolerance) {
  const std::size_t count = positions.size();
  std::vector<InsideTest> tests;
  std::vector<std::array<double, 6>> boxes(count);
  for (std::size_t b = 0; b < count; ++b) {
    tests.emplace_back(positions[b], scene.bodies[b].cage.skin.triangles);
    for (std::size_t k = 0; k < 3; ++k) boxes[b][k] = boxes[b][k + 3] = positions[b][k];
    for (std::size_t i = 0; i < positions[b].size(); ++i) {
      boxes[b][i % 3] = std::min(boxes[b][i % 3], positions[b][i]);
      boxes[b][i % 3 + 3] = std::max(boxes[b][i % 3 + 3], positions[b][i]);
    }
  }
  std::vector<std::vector<uint8_t>> flags(count);
  for (std::size_t b = 0; b < count; ++b) {
    const std::vector<double> normals = vertex_normals(positions[b], scene.bodies[b].cage.skin.triangles);
    flags[b].assign(positions[b].size() / 3, 0);
    for (std::size_t v = 0; v < flags[b].size(); ++v) {
      const double* x = &positions[b][3 * v];
      // Inward from the vertex: out of the other body at once where the overlap is shallow.
      double deeper[3];
      for (std::size_t k = 0; k < 3; ++k) deeper[k] = x[k] - tolerance * normals[3 * v + k];
      for (std::size_t o = 0; o < count && flags[b][v] == 0; ++o) {
        if (o == b) continue;
        bool in_box = true;
        for (std::size_t k = 0; k < 3; ++k) in_box = in_box && x[k] >= boxes[o][k] && x[k] <= boxes[o][k + 3];
        if (in_box && tests[o].contains(x) && tests[o].contains(deeper)) flags[b][v] = 1;
      }
    }
  }
  return flags;
}

Measurement::Measurement(const Scene& scene, const Engine& engine)
    : scene_(scene), start_(skin_positions(scene, engine)) {
  result_.inside_start = share(inside_flags(scene, start_, 0));
  const Motion m = motion_of(scene, engine);
  std::copy(m.momentum, m.momentum + 3, momentum_start_);
  for (const SceneBody& body : scene.bodies) result_.elements += static_cast<int>(body.cage.tetrahedra.size());
}

bool Measurement::observe(const Engine& engine, double dt, double step_ms) {
  const Motion m = motion_of(scene_, engine);
  time_ += dt;
  ++result_.steps;
  step_ms_.push_back(step_ms);
  detection_ms_.push_back(engine.detection_ms());
  result_.most_contacts = std::max(result_.most_contacts, static_cast<double>(engine.contact_count()));
  result_.is_finite = result_.is_finite && m.is_finite;
  if (!result_.is_finite) return false;
  result_.peak_speed = std::max(result_.peak_speed, m.peak_speed);
  motion_most_ = std::max(motion_most_, m.motion);
  if (scene_.settling_steps > 0 && result_.steps >= scene_.settling_steps) watch_rest(engine);
  return m.peak_speed < 1e3 * scene_.speed_limit;
}

void Measurement::watch_rest(const Engine& engine) {
  const Positions now = skin_positions(scene_, engine);
  const Motion m = motion_of(scene_, engine);
  const double energy = m.energy + m.height;
  if (settled_.empty()) {
    settled_ = now;
    energy_settled_ = energy;
  }
  for (std::size_t b = 0; b < now.size(); ++b)
    for (std::size_t i = 0; i < now[b].size(); i += 3)
      result_.drift = std::max(result_.drift, std::hypot(now[b][i] - settled_[b][i], now[b][i + 1] - settled_[b][i + 1],
                                                         now[b][i + 2] - settled_[b][i + 2]));
  result_.energy_gained = std::max(result_.energy_gained, energy - energy_settled_);
}

Result Measurement::result(const Engine& engine) {
  const Motion m = motion_of(scene_, engine);
  result_.energy_end = m.energy;
  result_.momentum_drift = std::numeric_limits<double>::quiet_NaN();
  if (scene_.keeps_momentum()) {
    double mass = 0, sum = 0;
    for (const SceneBody& body : scene_.bodies) mass += body.mass;
    for (int a = 0; a < 3; ++a) {
      const double gained = m.momentum[a] - momentum_start_[a] - mass * double(scene_.gravity[a]) * time_;
      sum += gained * gained;
    }
    result_.momentum_drift = motion_most_ > 0 ? std::sqrt(sum) / motion_most_ : 0;
  }
  result_.step_ms = median(step_ms_);
  result_.detection_ms = median(detection_ms_);
  judge(engine);
  return result_;
}

void Measurement::judge(const Engine& engine) {
  if (!result_.is_finite || result_.peak_speed > scene_.speed_limit) {
    result_.inside_end = std::numeric_limits<double>::quiet_NaN();
    result_.verdict = "exploded";
    if (!result_.is_finite) return;
  }
  for (std::size_t b = 0; b < scene_.bodies.size(); ++b)
    result_.inverted += inverted_tetrahedra(scene_.bodies[b].cage, engine.nodes(b));
  const Positions now = skin_positions(scene_, engine);
  result_.inside_end = share(inside_flags(scene_, now, scene_.depth_tolerance));
  const State state{start_, now};
  if (scene_.links_kept) result_.links_kept = scene_.links_kept(state);
  result_.passed_through = (scene_.passed_through && scene_.passed_through(state)) || result_.links_kept < scene_.links;
  if (!result_.verdict.empty()) return;
  if (result_.passed_through)
    result_.verdict = "passed_through";
  else if (result_.inside_end > scene_.inside_tolerance)
    result_.verdict = "overlapping";
  else if (600 * result_.inverted > result_.elements)
    result_.verdict = "inverted";
  else if (result_.drift > scene_.drift_tolerance)
    result_.verdict = "drifting";
  else
    result_.verdict = "ok";
}

}  // namespace demo
