// SPDX-License-Identifier: MIT OR Apache-2.0
#include "system_engine.hpp"

#include <algorithm>
#include <array>

#include "../engine/engine.hpp"

namespace demo {

namespace {

class SystemEngine : public Engine {
 public:
  SystemEngine(const Scene& scene, const Setting& setting) : engine_(setting.threads) {
    for (std::size_t k = 0; k < 3; ++k) engine_.gravity[k] = double(scene.gravity[static_cast<int>(k)]);
    engine_.solves = setting.passes;
    engine_.drag = scene.damping_alpha;
    // Two equal surfaces, as springs in series, are half as stiff as either; on the floor the body decides.
    const double stiffness = (setting.stiffness > 0 ? setting.stiffness : scene.stiffness()) / scene.area_per_vertex();
    rayc_material floor = material(scene, setting, stiffness);
    if (scene.has_floor) engine_.add_floor(floor);
    for (const SceneBody& body : scene.bodies) {
      const auto is_held = [&](const caged::Vector& x) {
        return std::any_of(body.pinned.begin(), body.pinned.end(),
                           [&](int node) { return body.cage.nodes[static_cast<std::size_t>(node)] == x; });
      };
      engine_.add(body.cage, body.mass, scene.youngs_modulus, material(scene, setting, 2 * stiffness),
                  scene.has_floor ? &floor : nullptr, is_held);
      engine_.set_velocity({{double(body.velocity[0]), double(body.velocity[1]), double(body.velocity[2])}});
      if (body.self_collision) engine_.touch_itself();
    }
  }

  void step(double dt) override { engine_.step(dt); }
  std::size_t contact_count() const override { return engine_.contact_count(); }

  Nodes nodes(std::size_t body) const override {
    return {engine_.positions(body), engine_.velocities(body), engine_.masses(body)};
  }

 private:
  static rayc_material material(const Scene& scene, const Setting& setting, double stiffness) {
    rayc_material m = raycontact::bearing_material(1, 1);
    m.stiffness = stiffness;
    m.damping_time = setting.damping_time;
    m.friction = setting.friction >= 0 ? setting.friction : scene.friction;
    m.depth_cap = setting.depth_cap * std::max(scene.edge(), scene.youngs_modulus / stiffness);
    return m;
  }

  caged::Engine engine_;
};

}  // namespace

std::unique_ptr<Engine> make_system_engine(const Scene& scene, const Setting& setting) {
  return std::make_unique<SystemEngine>(scene, setting);
}

}  // namespace demo
