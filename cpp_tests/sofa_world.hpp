// Bodies of loose points that a host of raycontact/sofa_response.hpp would solve for.
#ifndef RAYCONTACT_CPP_TESTS_SOFA_WORLD_HPP
#define RAYCONTACT_CPP_TESTS_SOFA_WORLD_HPP

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "raycontact/sofa_response.hpp"
#include "sofa_types.hpp"

using Vectors = std::vector<Vec3<double>>;
using Stage = raycontact::CollisionStage<Vec3Types<double>>;
using Response = raycontact::ContactResponse<Vec3Types<double>>;
using raycontact::ModelId;

inline const double infinity = std::numeric_limits<double>::infinity();
inline const double weightless[3] = {0, 0, 0};

/** Bodies of loose points on a common solver: backward Euler by conjugate gradients, on what a host asks of the
 * response. */
struct World {
  std::vector<Surface<double>> surfaces;
  std::vector<double> masses;  // of a vertex
  std::vector<Vectors> v;
  Stage stage;
  Response response;
  raycontact::ContactLaw law;
  std::array<double, 3> gravity = {0, 0, 0};
  /** Bodies move as rigid ones without turning: their points share one velocity. */
  bool is_rigid = false;

  void add(const Surface<double>& surface, double mass, bool is_open = false) {
    rayc_mesh_options options = raycontact::default_mesh_options();
    options.open = is_open;
    stage.addCollisionModel(surface.x, surface.triangles, options);
    surfaces.push_back(surface);
    masses.push_back(mass / double(surface.x.size()));
    v.emplace_back(surface.x.size(), Vec3<double>(0, 0, 0));
    response.addSurface(stage, masses.back(), law);
  }

  std::vector<const Vectors*> positions() const {
    std::vector<const Vectors*> x;
    for (const Surface<double>& surface : surfaces) x.push_back(&surface.x);
    return x;
  }

  std::vector<const Vectors*> velocities() const { return views<const Vectors>(v); }

  template <class Out, class In>
  static std::vector<Out*> views(In& arrays) {
    std::vector<Out*> all;
    for (auto& array : arrays) all.push_back(&array);
    return all;
  }

  std::vector<Vectors> zeros() const {
    std::vector<Vectors> all;
    for (const Vectors& one : v) all.emplace_back(one.size(), Vec3<double>(0, 0, 0));
    return all;
  }

  void choose_pairs() {
    stage.beginNarrowPhase();
    for (ModelId a = 0; a < surfaces.size(); ++a)
      for (ModelId b = a + 1; b < surfaces.size(); ++b) stage.addCollisionPair({a, b});
    stage.chooseCollisionPairs();
  }

  void begin(double dt) {
    choose_pairs();
    response.begin(stage, dt, positions(), velocities(), gravity.data());
  }

  std::vector<Vectors> forces(const std::vector<Vectors>& at) {
    std::vector<Vectors> f = zeros();
    response.addForce(views<Vectors>(f), views<const Vectors>(at));
    return f;
  }

  /** M d - dt B d. */
  std::vector<Vectors> system(double dt, const std::vector<Vectors>& d) {
    std::vector<Vectors> result = zeros();
    response.addDForce(views<Vectors>(result), views<const Vectors>(d), -dt);
    for_each([&](std::size_t body, std::size_t vertex, int axis) {
      if (std::isfinite(masses[body])) result[body][vertex][axis] += masses[body] * d[body][vertex][axis];
    });
    project(result);
    return result;
  }

  /** What moves as one: still bodies not at all, rigid ones by their mean. */
  void project(std::vector<Vectors>& numbers) const {
    for (std::size_t body = 0; body < numbers.size(); ++body) {
      const bool is_still = !std::isfinite(masses[body]);
      if (!is_still && !is_rigid) continue;
      for (int axis = 0; axis < 3; ++axis) {
        double mean = 0;
        for (const auto& vector : numbers[body]) mean += vector[axis] / double(numbers[body].size());
        for (auto& vector : numbers[body]) vector[axis] = is_still ? 0 : mean;
      }
    }
  }

  template <class Call>
  void for_each(Call call) const {
    for (std::size_t body = 0; body < v.size(); ++body)
      for (std::size_t vertex = 0; vertex < v[body].size(); ++vertex)
        for (int axis = 0; axis < 3; ++axis) call(body, vertex, axis);
  }

  double inner(const std::vector<Vectors>& a, const std::vector<Vectors>& b) const {
    double sum = 0;
    for_each([&](std::size_t body, std::size_t i, int axis) { sum += a[body][i][axis] * b[body][i][axis]; });
    return sum;
  }

  void step(double dt) {
    begin(dt);
    std::vector<Vectors> r = forces(v);
    for_each([&](std::size_t body, std::size_t i, int axis) {
      if (std::isfinite(masses[body])) r[body][i][axis] += masses[body] * gravity[axis];
      r[body][i][axis] *= dt;
    });
    project(r);
    std::vector<Vectors> d = zeros(), p = r;
    const double all = inner(r, r);
    for (double left = all; left > 1e-24 * all && left > 0;) {
      const std::vector<Vectors> ap = system(dt, p);
      const double alpha = left / inner(p, ap);
      for_each([&](std::size_t body, std::size_t i, int axis) {
        d[body][i][axis] += alpha * p[body][i][axis];
        r[body][i][axis] -= alpha * ap[body][i][axis];
      });
      const double now = inner(r, r), beta = now / left;
      left = now;
      for_each([&](std::size_t body, std::size_t i, int axis) {
        p[body][i][axis] = r[body][i][axis] + beta * p[body][i][axis];
      });
    }
    for_each([&](std::size_t body, std::size_t i, int axis) {
      v[body][i][axis] += d[body][i][axis];
      surfaces[body].x[i][axis] += dt * v[body][i][axis];
    });
    response.finish(velocities());
  }

  double kinetic() const {
    double sum = 0;
    for_each([&](std::size_t body, std::size_t i, int axis) {
      if (std::isfinite(masses[body])) sum += masses[body] * v[body][i][axis] * v[body][i][axis] / 2;
    });
    return sum;
  }
};

inline World three_spheres(double friction) {
  World world;
  world.law.stiffness = 100;
  world.law.friction = friction;
  for (const auto& centre : {Vec3<double>(0, 0, 0), Vec3<double>(1.5, 0.25, 0), Vec3<double>(3, 0, 0.25)})
    world.add(sphere<double>(centre[0], centre[1], centre[2]), 1);
  for (std::size_t body = 0; body < 3; ++body)
    for (std::size_t i = 0; i < world.v[body].size(); ++i)
      for (int axis = 0; axis < 3; ++axis) world.v[body][i][axis] = 0.1 * std::sin(double(i + 5 * body) + 2 * axis);
  return world;
}

#endif  // RAYCONTACT_CPP_TESTS_SOFA_WORLD_HPP
