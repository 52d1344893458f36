// SPDX-License-Identifier: MIT OR Apache-2.0
#include "measure.hpp"

#include <BulletSoftBody/btSoftBody.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "../inside_test.hpp"
#include "raycontact/bullet/body_check.hpp"

namespace demo {

namespace rb = raycontact::bullet;

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
  double momentum[3] = {0, 0, 0}, motion = 0, energy = 0, peak_speed = 0;
  bool is_finite = true;
};

Motion motion_of(const Engine& engine) {
  Motion m;
  for (const btSoftBody* body : engine.bodies())
    for (int n = 0; n < body->m_nodes.size(); ++n) {
      const btSoftBody::Node& node = body->m_nodes[n];
      for (int a = 0; a < 3; ++a)
        if (!std::isfinite(double(node.m_x[a])) || !std::isfinite(double(node.m_v[a]))) m.is_finite = false;
      if (!(node.m_im > 0)) continue;
      const double mass = 1 / double(node.m_im), speed = double(node.m_v.length());
      for (int a = 0; a < 3; ++a) m.momentum[a] += mass * double(node.m_v[a]);
      m.motion += mass * speed;
      m.energy += 0.5 * mass * speed * speed;
      m.peak_speed = std::max(m.peak_speed, speed);
    }
  return m;
}

// Of motion and height.
double energy_of(const Engine& engine, const btVector3& gravity) {
  double energy = motion_of(engine).energy;
  for (const btSoftBody* body : engine.bodies())
    for (int n = 0; n < body->m_nodes.size(); ++n)
      if (body->m_nodes[n].m_im > 0)
        for (int a = 0; a < 3; ++a)
          energy -= double(gravity[a]) * double(body->m_nodes[n].m_x[a]) / double(body->m_nodes[n].m_im);
  return energy;
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
    std::vector<btScalar> x;
    rb::skin_positions(*engine.bodies()[b], scene.bodies[b].cage.skin, x);
    all.emplace_back(x.begin(), x.end());
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
  const Motion m = motion_of(engine);
  std::copy(m.momentum, m.momentum + 3, momentum_start_);
  for (const SceneBody& body : scene.bodies) result_.elements += static_cast<int>(body.cage.tetrahedra.size());
}

bool Measurement::observe(const Engine& engine, double dt, double step_ms) {
  const Motion m = motion_of(engine);
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
  const double energy = energy_of(engine, scene_.gravity);
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
  const Motion m = motion_of(engine);
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
  for (const btSoftBody* body : engine.bodies()) result_.inverted += rb::inverted_tetrahedra(*body);
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
