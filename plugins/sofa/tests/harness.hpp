// SPDX-License-Identifier: MIT OR Apache-2.0
// What the tests that run in SOFA share: checks, the log, scenes of cubes in cages.
#pragma once

#include <SofaRaycontact/RaycontactForceField.h>
#include <sofa/core/behavior/BaseMass.h>
#include <sofa/helper/logging/MessageDispatcher.h>
#include <sofa/helper/logging/MessageHandler.h>
#include <sofa/simulation/Node.h>
#include <sofa/simulation/Simulation.h>
#include <sofa/simulation/common/SceneLoaderXML.h>

#include <cstdint>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

using sofa::simulation::Node;
using sofaraycontact::RaycontactForceField;
using sofaraycontact::State;
using Vectors = std::vector<sofa::type::Vec3>;
namespace vec_id = sofa::core::vec_id;

inline int failures = 0;

inline void check(bool is_well, const char* what, double number = 0, double expected = 0) {
  std::printf("%s: %s (%g, %g)\n", is_well ? "ok" : "FAILED", what, number, expected);
  failures += is_well ? 0 : 1;
}

/** Keeps what SOFA is told. */
class Log : public sofa::helper::logging::MessageHandler {
 public:
  std::vector<std::string> errors, warnings;
  void process(sofa::helper::logging::Message& message) override {
    using sofa::helper::logging::Message;
    if (message.type() == Message::Error) errors.push_back(message.messageAsString());
    if (message.type() == Message::Warning) warnings.push_back(message.messageAsString());
  }
  std::string getName() const override { return "Log"; }
  static bool has(const std::vector<std::string>& messages, const std::string& part) {
    for (const std::string& message : messages)
      if (message.find(part) != std::string::npos) return true;
    return false;
  }
};

inline Log the_log;

/** A scene without gravity, unless it is said, of cubes in cages under one solver. */
inline std::string scene_of(const std::string& bodies, const std::string& contact,
                            const std::string& gravity = "0 0 0") {
  return "<Node name='root' dt='0.01' gravity='" + gravity +
         "'><DefaultAnimationLoop/><CollisionPipeline/><BruteForceBroadPhase/>"
         "<RaycontactNarrowPhase name='narrowPhase'/><NewProximityIntersection alarmDistance='0.02' "
         "contactDistance='0'/>"
         "<CollisionResponse response='PenalityContactForceField'/><Node name='Bodies'><EulerImplicitSolver "
         "rayleighStiffness='0' rayleighMass='0'/><CGLinearSolver iterations='500' tolerance='1e-14' "
         "threshold='1e-14'/>"
         "<RaycontactForceField name='contact' " +
         contact + "/>" + bodies + "</Node></Node>";
}

inline std::string cube(const std::string& folder, const std::string& name, const std::string& place) {
  return "<Node name='" + name + "'><MechanicalObject name='nodes' translation='" + place +
         "'/><UniformMass totalMass='10'/>"
         "<RegularGridTopology nx='4' ny='4' nz='4' min='-0.2 -0.2 -0.2' max='0.2 0.2 "
         "0.2'/><RegularGridSpringForceField "
         "stiffness='20000' damping='20'/><Node name='Surface'><MeshOBJLoader name='file' filename='" +
         folder +
         "/meshes/box.obj'/><MeshTopology src='@file'/><MechanicalObject src='@file'/>"
         "<TriangleCollisionModel/><BarycentricMapping/></Node></Node>";
}

inline std::string floor_of(const std::string& folder) {
  return "<Node name='Floor'><MeshOBJLoader name='file' filename='" + folder +
         "/meshes/floor.obj'/><MeshTopology src='@file'/><MechanicalObject src='@file'/>"
         "<TriangleCollisionModel simulated='0' moving='0'/></Node>";
}

inline std::string two_cubes(const std::string& folder) {
  return cube(folder, "A", "0 0 0") + cube(folder, "B", "0.3 0.13 0.07");
}

struct Scene {
  Node::SPtr root;
  explicit Scene(const std::string& text)
      : Scene(sofa::simulation::SceneLoaderXML::loadFromMemory("memory", text.c_str())) {}
  explicit Scene(const Node::SPtr& loaded) : root(loaded) {
    if (root != nullptr) sofa::simulation::node::initRoot(root.get());
  }
  ~Scene() {
    if (root != nullptr) sofa::simulation::node::unload(root);
  }
  void run(int steps) {
    for (int step = 0; step < steps; ++step) sofa::simulation::node::animate(root.get(), root->getDt());
  }
  RaycontactForceField* field() { return root->getTreeObjects<RaycontactForceField>().at(0); }

  /** Of collision models. */
  std::vector<State*> surfaces() {
    std::vector<State*> all;
    for (auto* model : root->getTreeObjects<sofaraycontact::Triangles>()) all.push_back(model->getMechanicalState());
    return all;
  }
  /** Of nodes that the solver moves. */
  std::vector<State*> bodies() {
    std::vector<State*> all;
    for (auto* mass : root->getTreeObjects<sofa::core::behavior::BaseMass>())
      all.push_back(dynamic_cast<State*>(mass->getContext()->getMechanicalState()));
    return all;
  }

  /** What contact acts on. */
  std::vector<State*> pushed() { return field()->d_foldMappings.getValue() ? bodies() : surfaces(); }
};

inline uint64_t bits_of(Scene& scene) {
  uint64_t hash = 14695981039346656037u;
  for (State* state : scene.bodies())
    for (const auto& point : state->read(vec_id::read_access::position)->getValue())
      for (int axis = 0; axis < 3; ++axis) {
        uint64_t bits;
        std::memcpy(&bits, &point[axis], sizeof bits);
        hash = (hash ^ bits) * 1099511628211u;
      }
  return hash;
}

// The tests of the other files; folder: the plugin's examples.
void self_collision(const std::string& folder);
void threads(const std::string& folder);
void topology_changes(const std::string& folder);
