// SPDX-License-Identifier: MIT OR Apache-2.0
/** A scene, with one of nine ways to handle contact. */
#ifndef RAYCONTACT_DEMOS_SCENE_ENGINE_HPP
#define RAYCONTACT_DEMOS_SCENE_ENGINE_HPP

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "scene.hpp"

namespace demo {

enum class Method {
  ours,            // raycontact as an implicit force with the paper's law
  pressure,        // the same with the pressure law, the default
  paper,           // the same, only what the paper describes
  classic,         // raycontact correcting Bullet's classic soft bodies
  vf_dd_implicit,  // Bullet's deformable bodies, its own contact: vertices against faces
  vf_dd_explicit,
  vf_ss,           // Bullet's classic soft bodies, its own contact: vertices against faces
  cl_ss,           // the same: clusters
  contact_system,  // an engine of its own, without Bullet, on the library's contact system, with its defaults
};

/** The names on the command line, in the order of the enumeration. */
const std::vector<std::string>& method_names();

struct Setting {
  Method method = Method::ours;
  double stiffness = 0;        // N/m for each surface vertex; 0 = what the scene suggests
  double damping_time = 0.05;  // s
  double friction = -1;        // Coulomb's coefficient; below 0 = the scene's
  double depth_cap = 0.25;     // in cell edges
  int iterations = 0;          // of the linear solver at most; 0 = as the engine has it
  uint32_t threads = 1;
  int passes = 6;  // detections and solves in a step at most, where bodies stop far from where they were going
  bool stock_elasticity = false;  // Bullet's own instead of CorotatedElasticity with the merged matrix product
};

/** A body's nodes now: x, y, z of each. */
struct Nodes {
  std::vector<double> positions, velocities;
  std::vector<double> masses;  // kg; infinity for one that is held
};

class Engine {
 public:
  static std::unique_ptr<Engine> make(const Scene& scene, const Setting& setting);
  virtual ~Engine() = default;
  virtual void step(double dt) = 0;
  virtual Nodes nodes(std::size_t body) const = 0;
  virtual std::size_t contact_count() const { return 0; }
  virtual double detection_ms() const { return 0; }
};

}  // namespace demo

#endif  // RAYCONTACT_DEMOS_SCENE_ENGINE_HPP
