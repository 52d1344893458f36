// SPDX-License-Identifier: MIT OR Apache-2.0
#include "judge.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace flexes {

namespace {

using Matrix = std::array<double, 9>;

double determinant(const Matrix& a) {
  return a[0] * (a[4] * a[8] - a[5] * a[7]) - a[1] * (a[3] * a[8] - a[5] * a[6]) + a[2] * (a[3] * a[7] - a[4] * a[6]);
}

Matrix inverse(const Matrix& a) {
  const double s = 1 / determinant(a);
  return {{s * (a[4] * a[8] - a[5] * a[7]), s * (a[2] * a[7] - a[1] * a[8]), s * (a[1] * a[5] - a[2] * a[4]),
           s * (a[5] * a[6] - a[3] * a[8]), s * (a[0] * a[8] - a[2] * a[6]), s * (a[2] * a[3] - a[0] * a[5]),
           s * (a[3] * a[7] - a[4] * a[6]), s * (a[1] * a[6] - a[0] * a[7]), s * (a[0] * a[4] - a[1] * a[3])}};
}

/** The edges from the first corner, by columns. */
Matrix edges(const std::array<const double*, 4>& x) {
  Matrix a{};
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t c = 0; c < 3; ++c) a[3 * k + c] = x[c + 1][k] - x[0][k];
  return a;
}

/** The triangles that belong to one tetrahedron alone, outward. */
std::vector<uint32_t> boundary(const Shape& shape) {
  std::map<std::array<int, 3>, std::array<int, 4>> faces;  // sorted corners: corners and the one across
  std::map<std::array<int, 3>, int> counts;
  for (std::size_t e = 0; e < shape.elements.size(); e += 4)
    for (std::size_t across = 0; across < 4; ++across) {
      std::array<int, 4> face{};
      std::size_t n = 0;
      for (std::size_t k = 0; k < 4; ++k)
        if (k != across) face[n++] = shape.elements[e + k];
      face[3] = shape.elements[e + across];
      std::array<int, 3> key{{face[0], face[1], face[2]}};
      std::sort(key.begin(), key.end());
      faces[key] = face;
      ++counts[key];
    }
  std::vector<uint32_t> triangles;
  for (const auto& [key, face] : faces) {
    if (counts[key] != 1) continue;
    std::array<const double*, 4> x{};
    for (std::size_t k = 0; k < 4; ++k) x[k] = shape.points[static_cast<std::size_t>(face[k])].data();
    const bool is_outward = determinant(edges(x)) < 0;
    for (const int corner : {face[0], face[is_outward ? 1 : 2], face[is_outward ? 2 : 1]})
      triangles.push_back(static_cast<uint32_t>(corner));
  }
  return triangles;
}

}  // namespace

Judge::Judge(const mjModel* m, const Model& model) : m_(m) {
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const Shape& shape = model.bodies[b].shape;
    Surface surface;
    surface.triangles =
        shape.dim == 3 ? boundary(shape) : std::vector<uint32_t>(shape.elements.begin(), shape.elements.end());
    surface.is_outside.resize(shape.points.size());
    for (const uint32_t corner : surface.triangles) surface.is_outside[corner] = true;
    surface.mesh = std::make_unique<raycontact::Mesh>(raycontact::vectors(shape.points), surface.triangles);
    surface.octree = std::make_unique<raycontact::Octree>(*surface.mesh);
    surfaces_.push_back(std::move(surface));
    if (shape.dim != 3) continue;
    const double young = model.bodies[b].young, poisson = 0.3;
    for (std::size_t e = 0; e < shape.elements.size(); e += 4) {
      Tetrahedron t{};
      std::array<const double*, 4> x{};
      for (std::size_t k = 0; k < 4; ++k) {
        const auto corner = static_cast<std::size_t>(shape.elements[e + k]);
        t.corners[k] = static_cast<std::size_t>(m->flex_vertadr[b]) + corner;
        x[k] = shape.points[corner].data();
      }
      const Matrix rest = edges(x);
      t.rest_inverse = inverse(rest);
      t.volume = std::fabs(determinant(rest)) / 6;
      t.shear = young / (2 * (1 + poisson));
      t.dilation = young * poisson / ((1 + poisson) * (1 - 2 * poisson));
      tetrahedra_.push_back(t);
    }
  }
}

std::vector<double> Judge::positions(const mjData* d, std::size_t body) const {
  const mjtNum* first = d->flexvert_xpos + 3 * static_cast<std::size_t>(m_->flex_vertadr[body]);
  return {first, first + 3 * static_cast<std::size_t>(m_->flex_vertnum[body])};
}

double Judge::depth(const mjData* d) {
  for (std::size_t b = 0; b < surfaces_.size(); ++b) {
    surfaces_[b].positions = positions(d, b);
    surfaces_[b].mesh->set_positions(raycontact::vectors(surfaces_[b].positions));
    surfaces_[b].octree->update(*surfaces_[b].mesh);
    surfaces_[b].inside.assign(surfaces_[b].is_outside.size(), 0);
  }
  double most = 0;
  std::vector<int32_t> turns;
  std::vector<rayc_closest_point> closest;
  for (Surface& a : surfaces_)
    for (const Surface& b : surfaces_) {
      if (&a == &b) continue;
      const rayc_vectors points = raycontact::vectors(a.positions);
      turns.resize(points.count);
      closest.resize(points.count);
      b.octree->winding_numbers(*b.mesh, points, turns);
      b.octree->closest_points(*b.mesh, points, closest);
      for (std::size_t v = 0; v < points.count; ++v)
        if (turns[v] != 0 && a.is_outside[v]) {
          most = std::max(most, closest[v].distance);
          a.inside[v] = 1;
        }
    }
  return most;
}

int Judge::inverted(const mjData* d) const {
  int count = 0;
  for (const Tetrahedron& t : tetrahedra_) {
    std::array<const double*, 4> x{};
    for (std::size_t k = 0; k < 4; ++k) x[k] = d->flexvert_xpos + 3 * t.corners[k];
    count += determinant(edges(x)) * determinant(t.rest_inverse) <= 0;
  }
  return count;
}

double Judge::energy(const mjData* d) const {
  std::vector<double> momenta(static_cast<std::size_t>(m_->nv));
  mj_mulM(m_, d, momenta.data(), d->qvel);
  double sum = 0;
  for (std::size_t k = 0; k < momenta.size(); ++k) sum += momenta[k] * d->qvel[k] / 2;
  for (int body = 0; body < m_->nbody; ++body)
    sum -= m_->body_mass[body] * mju_dot3(m_->opt.gravity, d->xipos + 3 * body);
  for (const Tetrahedron& t : tetrahedra_) {
    std::array<const double*, 4> x{};
    for (std::size_t k = 0; k < 4; ++k) x[k] = d->flexvert_xpos + 3 * t.corners[k];
    const Matrix now = edges(x);
    Matrix gradient{};
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        for (std::size_t k = 0; k < 3; ++k) gradient[3 * i + j] += now[3 * i + k] * t.rest_inverse[3 * k + j];
    double square = 0, trace = 0;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) {
        double strain = i == j ? -0.5 : 0;
        for (std::size_t k = 0; k < 3; ++k) strain += gradient[3 * k + i] * gradient[3 * k + j] / 2;
        square += strain * strain;
        if (i == j) trace += strain;
      }
    sum += t.volume * (t.shear * square + t.dilation / 2 * trace * trace);
  }
  return sum;
}

std::array<double, 3> Judge::momentum(const mjData* d) const {
  // All of the demo's degrees of freedom are slides along the world's axes, three for each body.
  std::vector<double> momenta(static_cast<std::size_t>(m_->nv));
  mj_mulM(m_, d, momenta.data(), d->qvel);
  std::array<double, 3> sum{};
  for (std::size_t k = 0; k < momenta.size(); ++k) sum[k % 3] += momenta[k];
  return sum;
}

}  // namespace flexes
