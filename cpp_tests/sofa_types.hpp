// Vectors that offer what SOFA's do, and spheres of them.
#ifndef RAYCONTACT_CPP_TESTS_SOFA_TYPES_HPP
#define RAYCONTACT_CPP_TESTS_SOFA_TYPES_HPP

#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>
#include <vector>

/** As sofa::type::Vec: numbers behind an operator, no conversion to a pointer. */
template <class Scalar>
class Vec3 {
 public:
  Vec3() = default;
  Vec3(Scalar x, Scalar y, Scalar z) : numbers_{x, y, z} {}
  Scalar& operator[](int axis) { return numbers_[axis]; }
  const Scalar& operator[](int axis) const { return numbers_[axis]; }

 private:
  Scalar numbers_[3];  // not set, as SOFA's
};

template <class Scalar>
struct Vec3Types {
  using Coord = Vec3<Scalar>;
  using Deriv = Vec3<Scalar>;
  using VecCoord = std::vector<Coord>;
  using VecDeriv = std::vector<Deriv>;
};

using Triangle = std::array<std::size_t, 3>;

template <class Scalar>
struct Surface {
  std::vector<Vec3<Scalar>> x;
  std::vector<Triangle> triangles;
};

/** Radius 1 around a centre. */
template <class Scalar>
Surface<Scalar> sphere(double cx, double cy, double cz) {
  Surface<Scalar> surface;
  const int around = 16, rings = 8;
  const double pi = std::acos(-1.0);
  const auto add = [&](double x, double y, double z) {
    surface.x.emplace_back(Scalar(cx + x), Scalar(cy + y), Scalar(cz + z));
  };
  add(0, 0, -1);
  for (int ring = 1; ring < rings; ++ring)
    for (int i = 0; i < around; ++i) {
      const double latitude = pi * ring / rings - pi / 2, longitude = 2 * pi * i / around;
      add(std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude), std::sin(latitude));
    }
  add(0, 0, 1);
  const auto at = [&](int ring, int i) { return static_cast<std::size_t>(1 + (ring - 1) * around + i % around); };
  const std::size_t top = surface.x.size() - 1;
  for (int i = 0; i < around; ++i) {
    surface.triangles.push_back({0, at(1, i + 1), at(1, i)});
    surface.triangles.push_back({top, at(rings - 1, i), at(rings - 1, i + 1)});
    for (int ring = 1; ring + 1 < rings; ++ring) {
      surface.triangles.push_back({at(ring, i), at(ring, i + 1), at(ring + 1, i + 1)});
      surface.triangles.push_back({at(ring, i), at(ring + 1, i + 1), at(ring + 1, i)});
    }
  }
  return surface;
}

/** Edge `edge`, each face cut into n by n squares, around the origin; corners and edges belong to all their faces. */
inline Surface<double> box(double edge, int n) {
  Surface<double> surface;
  std::map<std::array<int, 3>, std::size_t> known;
  const auto at = [&](const std::array<int, 3>& cell) {
    const auto [place, is_new] = known.insert({cell, surface.x.size()});
    if (is_new) {
      const auto along = [&](int axis) { return edge * (double(cell[axis]) / n - 0.5); };
      surface.x.emplace_back(along(0), along(1), along(2));
    }
    return place->second;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {0, n})
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const auto corner = [&](int a, int b) {
            std::array<int, 3> cell{};
            cell[axis] = side, cell[(axis + 1) % 3] = i + a, cell[(axis + 2) % 3] = j + b;
            return at(cell);
          };
          std::array<std::size_t, 4> ring = {corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)};
          if (side == 0) std::swap(ring[1], ring[3]);
          surface.triangles.push_back({ring[0], ring[1], ring[2]});
          surface.triangles.push_back({ring[0], ring[2], ring[3]});
        }
  return surface;
}

template <class Scalar>
double dot(const Vec3<Scalar>& a, const Vec3<Scalar>& b) {
  return double(a[0]) * double(b[0]) + double(a[1]) * double(b[1]) + double(a[2]) * double(b[2]);
}

#endif  // RAYCONTACT_CPP_TESTS_SOFA_TYPES_HPP
