// SPDX-License-Identifier: MIT OR Apache-2.0
// Threads of SOFA's scheduler, and surfaces that change while the scene runs.
#include <sofa/core/topology/BaseTopology.h>
#include <sofa/simulation/task/MainTaskSchedulerFactory.h>
#include <sofa/simulation/task/TaskScheduler.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <sstream>

#include "harness.hpp"

namespace {

sofaraycontact::RaycontactNarrowPhase* narrow_phase(Scene& scene) {
  return scene.root->getTreeObjects<sofaraycontact::RaycontactNarrowPhase>().at(0);
}

/** A column of 2 x 4 x 2 cells of 0.1, six tetrahedra each, that collides as the triangles around them. */
class Column {
 public:
  static constexpr int x_nodes = 3, y_nodes = 5, z_nodes = 3;
  std::vector<std::array<int, 3>> nodes;
  std::vector<std::array<int, 4>> tetrahedra;

  Column() {
    for (int x = 0; x < x_nodes; ++x)
      for (int y = 0; y < y_nodes; ++y)
        for (int z = 0; z < z_nodes; ++z) nodes.push_back({x, y, z});
    for (int x = 0; x + 1 < x_nodes; ++x)
      for (int y = 0; y + 1 < y_nodes; ++y)
        for (int z = 0; z + 1 < z_nodes; ++z) add_cell({x, y, z});
  }

  std::string scene() const {
    std::ostringstream text;
    text << "<Node name='Column'><TetrahedronSetTopologyContainer name='tetrahedra' position='";
    for (const auto& node : nodes) text << 0.1 * node[0] << ' ' << 0.1 * node[1] << ' ' << 0.1 * node[2] << ' ';
    text << "' tetrahedra='";
    for (const auto& t : tetrahedra) text << t[0] << ' ' << t[1] << ' ' << t[2] << ' ' << t[3] << ' ';
    text << "'/><TetrahedronSetTopologyModifier name='modifier'/><TetrahedronSetGeometryAlgorithms template='Vec3'/>"
            "<MechanicalObject name='nodes' translation='0 0.05 0'/><UniformMass vertexMass='0.3'/>"
            "<TetrahedralCorotationalFEMForceField youngModulus='2e5' poissonRatio='0.3' method='large'/>"
            "<Node name='Surface'><TriangleSetTopologyContainer name='triangles'/>"
            "<TriangleSetTopologyModifier/><TriangleSetGeometryAlgorithms template='Vec3'/>"
            "<Tetra2TriangleTopologicalMapping input='@../tetrahedra' output='@triangles'/>"
            "<TriangleCollisionModel/></Node></Node>";
    return text.str();
  }

  /** Those that are below this layer of nodes. */
  sofa::type::vector<sofa::Index> below(int layer) const {
    sofa::type::vector<sofa::Index> all;
    for (std::size_t t = 0; t < tetrahedra.size(); ++t)
      if (std::all_of(tetrahedra[t].begin(), tetrahedra[t].end(), [&](int node) { return nodes[node][1] <= layer; }))
        all.push_back(static_cast<sofa::Index>(t));
    return all;
  }

 private:
  static int at(const std::array<int, 3>& node) { return (node[0] * y_nodes + node[1]) * z_nodes + node[2]; }

  /** Along the six ways from a corner to the opposite one. */
  void add_cell(const std::array<int, 3>& corner) {
    std::array<int, 3> order = {0, 1, 2};
    do {
      std::array<int, 3> node = corner;
      std::array<int, 4> tetrahedron = {at(node), 0, 0, 0};
      for (int k = 0; k < 3; ++k) ++node[order[k]], tetrahedron[k + 1] = at(node);
      const bool is_even = (order[1] - order[0] + 3) % 3 == 1;
      if (!is_even) std::swap(tetrahedron[2], tetrahedron[3]);
      tetrahedra.push_back(tetrahedron);
    } while (std::next_permutation(order.begin(), order.end()));
  }
};

/** Triangles are put in another order while the scene runs, without a new revision. */
void other_triangles(const std::string& folder) {
  const std::string linked = scene_of(two_cubes(folder), "stiffness='1e5'"), link = "<MeshTopology src='@file'/>";
  Scene other(linked);
  std::string in_order, in_another;
  for (const auto& t : other.root->getTreeObjects<sofaraycontact::Triangles>().at(1)->getTriangles()) {
    in_order += std::to_string(t[0]) + ' ' + std::to_string(t[1]) + ' ' + std::to_string(t[2]) + ' ';
    in_another = std::to_string(t[1]) + ' ' + std::to_string(t[2]) + ' ' + std::to_string(t[0]) + ' ' + in_another;
  }
  // What is linked to a loader would be shared with it.
  std::string own = linked;
  own.replace(own.rfind(link), link.size(), "<MeshTopology position='@file.position' triangles='" + in_order + "'/>");
  Scene scene(own);
  scene.run(10), other.run(10);
  const unsigned before = narrow_phase(scene)->generation();
  auto* topology = scene.root->getTreeObjects<sofaraycontact::Triangles>().at(1)->getCollisionTopology();
  const int revision = topology->getRevision();
  check(topology->findData("triangles")->read(in_another), "a topology's triangles can be replaced");
  check(topology->getRevision() == revision, "which leaves its revision as it was");
  scene.run(10), other.run(10);
  check(narrow_phase(scene)->generation() == before + 1, "replaced triangles make the surfaces anew, once",
        narrow_phase(scene)->generation(), before + 1);
  double apart = 0;
  for (int body = 0; body < 2; ++body) {
    const auto& a = scene.bodies()[body]->read(vec_id::read_access::position)->getValue();
    const auto& b = other.bodies()[body]->read(vec_id::read_access::position)->getValue();
    for (std::size_t k = 0; k < a.size(); ++k) apart = std::max(apart, double((a[k] - b[k]).norm()));
  }
  check(apart < 1e-9, "the same triangles in another order push the same", apart, 1e-9);
}

/** Low and high end of a body, and its fastest node. */
std::array<double, 3> state_of(Scene& scene) {
  std::array<double, 3> found = {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(), 0};
  const State* body = scene.bodies()[0];
  for (const auto& x : body->read(vec_id::read_access::position)->getValue())
    found[0] = std::min(found[0], double(x[1])), found[1] = std::max(found[1], double(x[1]));
  for (const auto& v : body->read(vec_id::read_access::velocity)->getValue())
    found[2] = std::max(found[2], double(v.norm()));
  return found;
}

/** A column that has fallen onto the floor loses its lowest layer and comes to stand on the next. */
void removed_tetrahedra(const std::string& folder) {
  const Column column;
  Scene scene(scene_of(column.scene() + floor_of(folder), "friction='0.5'", "0 -9.81 0"));
  scene.run(150);
  const auto stands = state_of(scene);
  check(std::abs(stands[0]) < 0.02 && stands[2] < 0.01, "a column stands on the floor", stands[0], stands[2]);
  const unsigned before = narrow_phase(scene)->generation();
  auto* modifier = scene.root->getTreeObjects<sofa::core::topology::TopologyModifier>().at(0);
  modifier->removeItems(column.below(1));
  scene.run(1);
  check(narrow_phase(scene)->generation() == before + 1, "removed tetrahedra make the surfaces anew, once",
        narrow_phase(scene)->generation(), before + 1);
  check(scene.bodies()[0]->getSize() == 36, "the removed layer's nodes are gone", double(scene.bodies()[0]->getSize()),
        36);
  scene.run(150);
  const auto stands_again = state_of(scene);
  check(std::abs(stands_again[0]) < 0.02 && stands_again[2] < 0.01, "what is left stands on the floor", stands_again[0],
        stands_again[2]);
  check(std::abs(stands[1] - stands_again[1] - 0.1) < 0.01, "it is lower by a layer", stands[1] - stands_again[1], 0.1);
}

}  // namespace

void threads(const std::string& folder) {
  auto* scheduler = sofa::simulation::MainTaskSchedulerFactory::createInRegistry();
  scheduler->init(3);
  check(scheduler->getThreadCount() >= 2, "the scheduler has threads", scheduler->getThreadCount(), 3);
  for (const std::string name : {"common_solver", "solver_each", "sofa_response"}) {
    uint64_t bits[2];
    for (const bool is_parallel : {false, true}) {
      const Node::SPtr root = sofa::simulation::node::load(folder + "/ten_tori_" + name + ".scn");
      root->getTreeObjects<sofaraycontact::RaycontactNarrowPhase>().at(0)->d_parallel.setValue(is_parallel);
      Scene scene(root);
      scene.run(40);
      bits[is_parallel] = bits_of(scene);
    }
    check(bits[0] == bits[1], ("the same bits with SOFA's threads, " + name).c_str());
  }
}

void topology_changes(const std::string& folder) {
  other_triangles(folder);
  removed_tetrahedra(folder);
}
