// SPDX-License-Identifier: MIT OR Apache-2.0
/** An engine of one's own on raycontact's contact system: points and springs, implicit Euler, conjugate gradients. */
#ifndef RAYCONTACT_DEMOS_OWN_ENGINE_HPP
#define RAYCONTACT_DEMOS_OWN_ENGINE_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "conjugate_gradients.hpp"
#include "raycontact.hpp"

namespace own {

using Vector = std::array<double, 3>;
using Numbers = std::vector<double>;

struct Body {
  std::vector<Vector> nodes;
  std::vector<uint32_t> triangles;                  // outward
  std::vector<std::array<std::size_t, 2>> springs;  // between nodes
};

class Engine {
 public:
  Vector gravity{{0, 0, 0}};
  int solves = 6;           // in a step at most
  bool is_guarded = false;  // steps whose energy would rise are cut short

  void add_floor(const Vector& normal, const rayc_material& material) { contacts_.add_half_space(normal, 0, material); }

  void add(const Body& body, double mass, double spring_stiffness, const rayc_material& material) {
    const std::size_t first = masses_.size();
    for (const Vector& x : body.nodes) x_.insert(x_.end(), x.begin(), x.end());
    masses_.resize(first + body.nodes.size(), mass / static_cast<double>(body.nodes.size()));
    v_.resize(x_.size(), 0);
    first_nodes_.push_back(first);
    for (const auto& [a, b] : body.springs) {
      const Vector way = difference(x_, first + a, first + b);
      springs_.push_back({first + a, first + b, length(way), spring_stiffness});
    }
    // All nodes are vertices of the mesh, also those that no triangle has.
    const uint32_t number = scene_.add({raycontact::vectors(&x_[3 * first], body.nodes.size()), body.triangles});
    contacts_.set_node_masses(masses_);
    contacts_.add_deformable(scene_, number, static_cast<uint32_t>(first), static_cast<uint32_t>(body.nodes.size()),
                             material);
  }

  /** Implicit Euler: M (v' - v) = dt (springs + contact + gravity at the end of the step). */
  void step(double dt) {
    Numbers free = v_, own(x_.size()), v = v_;
    for (std::size_t k = 0; k < free.size(); ++k) free[k] += dt * gravity[k % 3];
    add_spring_forces(own);
    contacts_.begin(scene_, dt, x_, v_, free);
    for (int solve = 1;; ++solve) {
      Numbers right(x_.size());
      contacts_.add_forces(v, right);
      add_spring_product(-dt, v, right);
      for (std::size_t k = 0; k < right.size(); ++k)
        right[k] = dt * (right[k] + own[k]) - masses_[k / 3] * (v[k] - free[k]);
      solve_for_change(dt, right, v);
      const bool is_wrong = contacts_.linearise(v) > 0.01;
      if (solve == solves) break;
      if (!contacts_.detect_again(scene_, v) && !is_wrong) break;
    }
    const auto [part, kept] = is_guarded ? guarded(dt, v) : std::array<double, 2>{{1, 1}};
    contacts_.finish(v);
    x_ = moved(part * dt, v);
    for (std::size_t k = 0; k < v.size(); ++k) v_[k] = kept * v[k];
  }

  std::size_t body_count() const { return first_nodes_.size(); }
  /** Contacts between bodies where they are. */
  std::size_t contact_count() {
    for (std::size_t b = 0; b < body_count(); ++b)
      scene_.set_positions(static_cast<uint32_t>(b),
                           raycontact::vectors(&x_[3 * first_nodes_[b]], end(b) - first_nodes_[b]));
    raycontact::Contacts found;
    scene_.query(found);
    return found.size();
  }
  Vector centre(std::size_t body) const { return mean(x_, body); }
  Vector velocity(std::size_t body) const { return mean(v_, body); }
  double fastest() const {
    double most = 0;
    for (std::size_t n = 0; n < masses_.size(); ++n)
      most = std::max(most, std::hypot(v_[3 * n], v_[3 * n + 1], v_[3 * n + 2]));
    return most;
  }

 private:
  struct Spring {
    std::size_t a, b;
    double length, stiffness;
  };

  static double length(const Vector& x) { return std::hypot(x[0], x[1], x[2]); }
  static Vector difference(const Numbers& x, std::size_t a, std::size_t b) {
    return {{x[3 * b] - x[3 * a], x[3 * b + 1] - x[3 * a + 1], x[3 * b + 2] - x[3 * a + 2]}};
  }

  void add_spring_forces(Numbers& forces) const {
    for (const Spring& s : springs_) {
      const Vector way = difference(x_, s.a, s.b);
      const double now = length(way), pull = s.stiffness * (now - s.length) / now;
      for (std::size_t k = 0; k < 3; ++k) {
        forces[3 * s.a + k] += pull * way[k];
        forces[3 * s.b + k] -= pull * way[k];
      }
    }
  }

  // result += factor * K * change; a compressed spring is taken for one at rest, so that K is positive semi-definite.
  void add_spring_product(double factor, const Numbers& change, Numbers& result) const {
    for (const Spring& s : springs_) {
      const Vector way = difference(x_, s.a, s.b), d = difference(change, s.a, s.b);
      const double now = length(way), across = std::max(0.0, 1 - s.length / now);
      const double along = (1 - across) * (way[0] * d[0] + way[1] * d[1] + way[2] * d[2]) / (now * now);
      for (std::size_t k = 0; k < 3; ++k) {
        const double force = factor * s.stiffness * (along * way[k] + across * d[k]);
        result[3 * s.a + k] -= force;
        result[3 * s.b + k] += force;
      }
    }
  }

  // (M + dt^2 K + dt C) change = right.
  void solve_for_change(double dt, Numbers& right, Numbers& v) {
    const auto add_product = [&](const Numbers& direction, Numbers& product) {
      add_spring_product(dt * dt, direction, product);
      contacts_.add_product(dt, direction, product);
      for (std::size_t k = 0; k < product.size(); ++k) product[k] += masses_[k / 3] * direction[k];
    };
    const auto in_turn = [](std::size_t count, const auto& work) {
      for (std::size_t index = 0; index < count; ++index) work(index);
    };
    demo::solve_by_conjugate_gradients(add_product, Numbers(v.size(), 1), 1e-16, 2000, right, v, in_turn);
  }

  /**
   * How much of the step can be taken before what is stored alone is more than all energy was, and the part of the
   * velocities for which that is enough.
   */
  std::array<double, 2> guarded(double dt, const Numbers& v) {
    if (!energy_) energy_ = kinetic(v_) + stored(x_) + contacts_.potential(scene_, v, 0);
    const auto after = [&](double part) { return stored(moved(part * dt, v)) + contacts_.potential(scene_, v, part); };
    double part = 1, rest = after(part);
    for (int tries = 1; rest > *energy_ && part > 0; ++tries) {
      part = tries < 9 ? part / 2 : 0;
      rest = after(part);
    }
    const double moving = kinetic(v), kept = std::sqrt(std::min(1.0, std::max(0.0, *energy_ - rest) / moving));
    energy_ = rest + (moving > 0 ? kept * kept * moving : 0);
    return {{part, moving > 0 ? kept : 1}};
  }

  Numbers moved(double time, const Numbers& v) const {
    Numbers x = x_;
    for (std::size_t k = 0; k < x.size(); ++k) x[k] += time * v[k];
    return x;
  }

  double kinetic(const Numbers& v) const {
    double sum = 0;
    for (std::size_t k = 0; k < v.size(); ++k) sum += masses_[k / 3] * v[k] * v[k] / 2;
    return sum;
  }

  // Of springs and height.
  double stored(const Numbers& x) const {
    double sum = 0;
    for (std::size_t k = 0; k < x.size(); ++k) sum -= masses_[k / 3] * gravity[k % 3] * x[k];
    for (const Spring& s : springs_) sum += s.stiffness * std::pow(length(difference(x, s.a, s.b)) - s.length, 2) / 2;
    return sum;
  }

  std::size_t end(std::size_t body) const { return body + 1 < body_count() ? first_nodes_[body + 1] : masses_.size(); }

  Vector mean(const Numbers& of, std::size_t body) const {
    const std::size_t first = first_nodes_[body], last = end(body);
    Vector sum{{0, 0, 0}};
    for (std::size_t k = 3 * first; k < 3 * last; ++k) sum[k % 3] += of[k] / static_cast<double>(last - first);
    return sum;
  }

  raycontact::Scene scene_;
  raycontact::ContactSystem contacts_;
  Numbers x_, v_, masses_;
  std::vector<Spring> springs_;
  std::vector<std::size_t> first_nodes_;
  std::optional<double> energy_;  // at the end of the last guarded step
};

}  // namespace own

#endif  // RAYCONTACT_DEMOS_OWN_ENGINE_HPP
