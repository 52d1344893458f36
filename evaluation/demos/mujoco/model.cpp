// SPDX-License-Identifier: MIT OR Apache-2.0
#include "model.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <utility>

#include "raycontact.hpp"

namespace flexes {

namespace {

std::string numbers(const double* values, std::size_t count) {
  std::string text;
  char number[32];
  for (std::size_t k = 0; k < count; ++k) {
    std::snprintf(number, sizeof number, "%.9g ", values[k]);
    text += number;
  }
  return text;
}

std::string attribute(const char* name, const std::string& value) {
  return std::string(" ") + name + "=\"" + value + "\"";
}

}  // namespace

const char* name_of(Contact contact) {
  switch (contact) {
    case Contact::raycontact:
      return "raycontact";
    case Contact::mujoco:
      return "mujoco";
    case Contact::passive:
      return "passive";
  }
  return "";
}

Shape torus(int around, int across) {
  Shape shape{3, {}, {}};
  const double turn = 2 * std::acos(-1.0);
  const int ring = across + 1;
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < ring; ++j) {
      const double u = turn * i / around, v = turn * j / across, tube = j == across ? 0 : 0.4;
      const double r = 1 + tube * std::cos(v);
      shape.points.push_back({{r * std::cos(u), r * std::sin(u), tube * std::sin(v)}});
    }
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j) {
      // A prism between two slices, cut by the order of its corners, so that neighbours are cut alike.
      const int a = i * ring, b = (i + 1) % around * ring, next = (j + 1) % across;
      const int low = std::min(j, next), high = std::max(j, next);
      for (const int corner : {a + low, a + high, a + across, b + low, a + high, a + across, b + low, b + high,
                               a + across, b + low, b + high, b + across})
        shape.elements.push_back(corner);
    }
  return shape;
}

Shape lumpy_ball(int times, double phase) {
  // An icosahedron, each of whose triangles is cut into four, again and again.
  const double g = (1 + std::sqrt(5.0)) / 2;
  Shape shape{2, {}, {}};
  for (const double s : {-1.0, 1.0})
    for (const double t : {-g, g})
      for (std::size_t k = 0; k < 3; ++k) {
        std::array<double, 3> point{};
        point[(k + 1) % 3] = s;
        point[(k + 2) % 3] = t;
        shape.points.push_back(point);
      }
  const auto is_near = [&](int a, int b) {
    double square = 0;
    for (std::size_t k = 0; k < 3; ++k) square += std::pow(shape.points[a][k] - shape.points[b][k], 2);
    return square < 4.1;
  };
  for (int a = 0; a < 12; ++a)
    for (int b = a + 1; b < 12; ++b)
      for (int c = b + 1; c < 12; ++c) {
        if (!is_near(a, b) || !is_near(b, c) || !is_near(a, c)) continue;
        const auto &x = shape.points[a], &y = shape.points[b], &z = shape.points[c];
        const double volume = x[0] * (y[1] * z[2] - y[2] * z[1]) + x[1] * (y[2] * z[0] - y[0] * z[2]) +
                              x[2] * (y[0] * z[1] - y[1] * z[0]);
        shape.elements.insert(shape.elements.end(), {a, volume > 0 ? b : c, volume > 0 ? c : b});
      }
  for (int time = 0; time < times; ++time) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [place, is_new] = middles.emplace(std::minmax(a, b), static_cast<int>(shape.points.size()));
      if (is_new) {
        std::array<double, 3> point{};
        for (std::size_t k = 0; k < 3; ++k) point[k] = (shape.points[a][k] + shape.points[b][k]) / 2;
        shape.points.push_back(point);
      }
      return place->second;
    };
    std::vector<int> finer;
    for (std::size_t e = 0; e < shape.elements.size(); e += 3) {
      const int a = shape.elements[e], b = shape.elements[e + 1], c = shape.elements[e + 2];
      const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {a, ab, ca, b, bc, ab, c, ca, bc, ab, bc, ca});
    }
    shape.elements = std::move(finer);
  }
  for (std::array<double, 3>& point : shape.points) {
    const double length = std::hypot(point[0], point[1], point[2]);
    for (double& x : point) x /= length;
    const double bumps =
        std::sin(4 * point[0] + phase) * std::sin(4 * point[1] + 2 * phase) * std::sin(4 * point[2] + 1);
    for (double& x : point) x *= 0.7 + 0.2 * bumps;
  }
  return shape;
}

Shape from_obj(const std::string& path) {
  const raycontact::Mesh mesh = raycontact::Mesh::from_obj(path);
  const std::vector<double> positions = mesh.positions();
  Shape shape{2, {}, {}};
  std::array<double, 3> low{{1e300, 1e300, 1e300}}, high{{-1e300, -1e300, -1e300}};
  for (std::size_t k = 0; k < positions.size(); ++k) {
    low[k % 3] = std::min(low[k % 3], positions[k]);
    high[k % 3] = std::max(high[k % 3], positions[k]);
  }
  const double scale = 1.7 / std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]});
  for (std::size_t v = 0; v < positions.size(); v += 3) {
    std::array<double, 3> point{};
    for (std::size_t k = 0; k < 3; ++k) point[k] = scale * (positions[v + k] - (low[k] + high[k]) / 2);
    shape.points.push_back(point);
  }
  for (const uint32_t corner : mesh.triangles()) shape.elements.push_back(static_cast<int>(corner));
  return shape;
}

std::string xml_of(const Model& model, Contact contact) {
  const double gravity[] = {0, 0, -model.gravity};
  std::string xml = "<mujoco>\n<option integrator=\"discrete\" iterations=\"500\"" +
                    attribute("timestep", numbers(&model.timestep, 1)) + attribute("gravity", numbers(gravity, 3)) +
                    "/>\n<size memory=\"500M\"/>\n<worldbody>\n";
  if (model.has_floor) xml += "<geom type=\"plane\" size=\"10 10 1\"/>\n";
  int number = 0;
  for (const Body& body : model.bodies) {
    std::string elements;
    for (const int corner : body.shape.elements) elements += std::to_string(corner) + " ";
    const bool is_skin = body.shape.dim == 2;
    xml += "<flexcomp type=\"direct\" radius=\"0.001\"" + attribute("name", "b" + std::to_string(number++)) +
           attribute("dim", std::to_string(body.shape.dim)) + attribute("mass", numbers(&body.mass, 1)) +
           attribute("pos", numbers(body.place.data(), 3)) + (is_skin ? " dof=\"trilinear\" cellcount=\"4 4 4\"" : "") +
           attribute("point", numbers(body.shape.points[0].data(), 3 * body.shape.points.size())) +
           attribute("element", elements) + ">\n<elasticity" + attribute("young", numbers(&body.young, 1)) +
           " poisson=\"0.3\" damping=\"0.005\"/>\n<contact selfcollide=\"none\"" +
           (body.friction > 0 ? attribute("friction", numbers(&body.friction, 1)) : " friction=\"0\" condim=\"1\"") +
           (contact == Contact::raycontact ? " contype=\"0\""
            : contact == Contact::passive  ? " passive=\"true\""
                                           : "") +
           "/>\n</flexcomp>\n";
  }
  return xml + "</worldbody>\n</mujoco>\n";
}

}  // namespace flexes
