// Skins in cages, in SOFA's words: on the nodes of a cage acts what a mapping would carry up from its skin.
#include <algorithm>
#include <cmath>
#include <vector>

#include "check.h"
#include "sofa_world.hpp"

namespace {

/** Corners of a box that hold a surface by trilinear weights, and the same weights as a dense table. */
struct Cage {
  Vectors corners;
  raycontact::SurfaceCarriers carriers;

  explicit Cage(const Surface<double>& surface, const Vec3<double>& centre, double mass) {
    const double half = 1.25;
    carriers.node_masses.assign(8, mass / 8);
    for (int k = 0; k < 8; ++k)
      corners.emplace_back(centre[0] + (k & 1 ? half : -half), centre[1] + (k & 2 ? half : -half),
                           centre[2] + (k & 4 ? half : -half));
    for (const auto& point : surface.x) {
      carriers.offsets.push_back(static_cast<uint32_t>(carriers.nodes.size()));
      for (uint32_t k = 0; k < 8; ++k) {
        double weight = 1;
        for (int axis = 0; axis < 3; ++axis) {
          const double upper = (point[axis] - centre[axis] + half) / (2 * half);
          weight *= k >> axis & 1 ? upper : 1 - upper;
        }
        carriers.nodes.push_back(k);
        carriers.weights.push_back(weight);
      }
    }
    carriers.offsets.push_back(static_cast<uint32_t>(carriers.nodes.size()));
  }

  /** What a mapping does to velocities. */
  Vectors down(const Vectors& nodes) const {
    Vectors vertices(carriers.offsets.size() - 1, Vec3<double>(0, 0, 0));
    for (std::size_t e = 0; e < carriers.nodes.size(); ++e)
      for (int axis = 0; axis < 3; ++axis)
        vertices[e / 8][axis] += carriers.weights[e] * nodes[carriers.nodes[e]][axis];
    return vertices;
  }

  /** And to forces. */
  Vectors up(const Vectors& vertices) const {
    Vectors nodes(8, Vec3<double>(0, 0, 0));
    for (std::size_t e = 0; e < carriers.nodes.size(); ++e)
      for (int axis = 0; axis < 3; ++axis)
        nodes[carriers.nodes[e]][axis] += carriers.weights[e] * vertices[e / 8][axis];
    return nodes;
  }
};

/** On the nodes of cages act the mapped forces of their skins, and the mapped products. */
void carriers_are_a_mapping() {
  World world = three_spheres(0.5);
  Response response;
  std::vector<Cage> cages;
  std::vector<Vectors> v, x, d, f, product;
  for (std::size_t body = 0; body < 3; ++body) {
    const Vec3<double> centre(1.5 * double(body), body == 1 ? 0.25 : 0, body == 2 ? 0.25 : 0);
    cages.emplace_back(world.surfaces[body], centre, 1);
    response.addSurface(world.stage, cages[body].carriers, world.law);
    x.push_back(cages[body].corners);
    v.emplace_back(), d.emplace_back();
    for (int k = 0; k < 8; ++k) {
      v[body].emplace_back(0.1 * std::sin(k + 5.0 * double(body)), 0.1 * std::cos(3.0 * k), 0.05 * k);
      d[body].emplace_back(std::cos(7.0 * k + double(body)), std::sin(2.0 * k), 0.3);
    }
    f.emplace_back(8, Vec3<double>(0, 0, 0));
    world.v[body] = cages[body].down(v[body]);
  }
  product = f;
  // As many samples as the skins have by themselves.
  for (uint32_t body = 0; body < 3; ++body) world.stage.scene().set_carrier_spacing(body, 0);
  world.begin(0.02);
  const std::vector<Vectors> expected = world.forces(world.v);
  std::vector<Vectors> expected_product = world.zeros(), mapped = world.zeros();
  for (std::size_t body = 0; body < 3; ++body) mapped[body] = cages[body].down(d[body]);
  world.response.addDForce(World::views<Vectors>(expected_product), World::views<const Vectors>(mapped), 1);

  response.begin(world.stage, 0.02, World::views<const Vectors>(x), World::views<const Vectors>(v), weightless);
  response.addForce(World::views<Vectors>(f), World::views<const Vectors>(v));
  response.addDForce(World::views<Vectors>(product), World::views<const Vectors>(d), 1);
  double size = 0;
  for (std::size_t body = 0; body < 3; ++body) {
    const Vectors force = cages[body].up(expected[body]), change = cages[body].up(expected_product[body]);
    for (int k = 0; k < 8; ++k)
      for (int axis = 0; axis < 3; ++axis) {
        size = std::max(size, std::abs(force[k][axis]));
        CHECK_NEAR(f[body][k][axis], force[k][axis], 1e-9);
        CHECK_NEAR(product[body][k][axis], change[k][axis], 1e-9);
      }
  }
  CHECK(size > 0.1);
  CHECK(response.place(9).first == 1 && response.place(9).second == 1);
}

}  // namespace

int main() {
  carriers_are_a_mapping();
  return check_result();
}
