// SPDX-License-Identifier: MIT OR Apache-2.0
/** Scenes of flexes, and runs of them, whoever makes the contact. */
#ifndef RAYCONTACT_DEMOS_MUJOCO_RUN_HPP
#define RAYCONTACT_DEMOS_MUJOCO_RUN_HPP

#include <memory>
#include <string>
#include <vector>

#include "judge.hpp"
#include "model.hpp"

namespace flexes {

struct Scene {
  const char* name;
  const char* what;
  Model model;
  double seconds = 0.3;
  double closing_speed = 0;  // m/s, with which the second body comes down on the first
};

/** tori, impact, skins, pile; throws std::invalid_argument for another. `files`: two surfaces in place of the skins. */
Scene scene_named(const std::string& name, const std::vector<std::string>& files);

/** What a run has shown. */
struct Figures {
  double start_depth = 0, deepest = 0, last_depth = 0;  // m; deepest: of all that follow the start
  double apart = -1;                                    // s, from which on nothing is in anything; -1: never
  int most_inverted = 0;                                // tetrahedra at once
  double start_energy = 0;                              // J
  double most_energy = 0;                               // J, at any step
  double energy_gain = 0;   // the largest rise over what it was when bodies came apart, as a part
  double largest_rise = 0;  // J, over the least energy so far: what contacts give back, at best
  double last_energy = 0;   // J
  double drift = 0;         // kg m/s, the largest change of momentum; without gravity
  double lowest = 0;        // m: of all vertices at the end
  double step_time = 0;     // s of the processor, mean of a step but the first
  double adapter_time = 0;  // of that, within the callback
  std::string error;
};

/** One model and its state, to be stepped beside others. */
class Run {
 public:
  /** Throws std::runtime_error with MuJoCo's message where the model does not load. */
  Run(const Scene& scene, Contact contact, double timestep);
  ~Run();
  bool is_done() const { return steps_ == last_step_; }
  void step();
  Figures figures() const;
  const mjData* data() const { return d_.get(); }
  const Judge& judge() const { return *judge_; }
  std::size_t body_count() const { return bodies_; }

 private:
  struct Delete {
    void operator()(mjModel* m) const { mj_deleteModel(m); }
    void operator()(mjData* d) const { mj_deleteData(d); }
  };
  void look();

  std::unique_ptr<mjModel, Delete> m_;
  std::unique_ptr<mjData, Delete> d_;
  std::unique_ptr<Judge> judge_;
  struct Contacts;
  std::unique_ptr<Contacts> contacts_;
  std::size_t bodies_ = 0;
  int steps_ = 0, last_step_ = 0;
  double energy_apart_ = 0, least_energy_ = 0;
  std::array<double, 3> start_momentum_{};
  Figures figures_;
};

}  // namespace flexes

#endif  // RAYCONTACT_DEMOS_MUJOCO_RUN_HPP
