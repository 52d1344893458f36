// SPDX-License-Identifier: MIT OR Apache-2.0
// The hairpin of self_collision.scn folds onto itself, and its arms stay apart.
#include <algorithm>
#include <cmath>
#include <limits>

#include "harness.hpp"
#include "inverted_cells.hpp"

namespace {

/** The faces of the two arms that look at each other, by where they are in the mesh. */
struct Arms {
  std::vector<sofa::Index> upper;
  std::vector<sofaraycontact::TriangleList::value_type> lower;

  explicit Arms(const sofaraycontact::Triangles& model) {
    const auto& x = model.getX();
    const auto is_at = [&](sofa::Index vertex, double height) {
      return x[vertex][0] > -1e-6 && std::abs(x[vertex][1] - height) < 1e-3;
    };
    for (sofa::Index vertex = 0; vertex < x.size(); ++vertex)
      if (is_at(vertex, 0.51)) upper.push_back(vertex);
    for (const auto& triangle : model.getTriangles())
      if (is_at(triangle[0], 0.21) && is_at(triangle[1], 0.21) && is_at(triangle[2], 0.21)) lower.push_back(triangle);
  }

  /** The least height of the upper face over the lower one, where one is over the other. */
  double gap(const sofaraycontact::Triangles& model) const {
    double least = std::numeric_limits<double>::infinity();
    const auto& x = model.getX();
    for (const sofa::Index vertex : upper)
      for (const auto& t : lower) {
        const auto area = [](const auto& a, const auto& b, const auto& c) {
          return (b[0] - a[0]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[0] - a[0]);
        };
        const auto &p = x[vertex], &a = x[t[0]], &b = x[t[1]], &c = x[t[2]];
        const double whole = area(a, b, c), u = area(p, b, c) / whole, v = area(a, p, c) / whole, w = 1 - u - v;
        if (u >= 0 && v >= 0 && w >= 0) least = std::min(least, p[1] - (u * a[1] + v * b[1] + w * c[1]));
      }
    return least;
  }
};

}  // namespace

void self_collision(const std::string& folder) {
  const Node::SPtr root = sofa::simulation::node::load(folder + "/self_collision.scn");
  sofa::simulation::node::initRoot(root.get());
  const auto* model = root->getTreeObjects<sofaraycontact::Triangles>().at(0);
  const Arms arms(*model);
  const double open = arms.gap(*model);
  double least = open, fastest = 0;
  int inverted = 0;
  for (int step = 0; step < 200; ++step) {
    sofa::simulation::node::animate(root.get(), root->getDt());
    least = std::min(least, arms.gap(*model));
    inverted += inverted_cells(root.get());
  }
  for (const auto& v : model->getMechanicalState()->read(vec_id::read_access::velocity)->getValue())
    fastest = std::max(fastest, double(v.norm()));
  check(std::abs(open - 0.3) < 1e-3, "the hairpin is open at the start", open, 0.3);
  check(arms.gap(*model) < 0.005, "it folds onto itself", arms.gap(*model), 0.005);
  check(least > -0.02, "its arms stay apart: a tenth of their thickness at most", least, -0.02);
  check(inverted == 0, "no cell is inverted", inverted);
  check(fastest < 0.05, "it comes to rest", fastest, 0.05);
  sofa::simulation::node::unload(root);
}
