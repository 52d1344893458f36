// SPDX-License-Identifier: MIT OR Apache-2.0
#include "run.hpp"

#include <time.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "raycontact/mujoco.hpp"

namespace flexes {

namespace {

/** What the thread has had of the processor, s: other programs do not count. */
double processor_time() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// How long the adapter takes: its callback, called through one that looks at the clock.
mjfGeneric timed_callback = nullptr;
double adapter_time = 0;

void measure(const mjModel* m, mjData* d) {
  const double start = processor_time();
  timed_callback(m, d);
  adapter_time += processor_time() - start;
}

}  // namespace

Scene scene_named(const std::string& name, const std::vector<std::string>& files) {
  const auto tetrahedra = [](double x, double y, double z) { return Body{torus(30, 12), {{x, y, z}}}; };
  if (name == "tori") {
    Scene scene{"tori", "two tetrahedral tori, 0.19 m deep at the start", {}};
    scene.model.bodies = {tetrahedra(0, 0, 0), tetrahedra(0.1, 0.05, 0.6)};
    return scene;
  }
  if (name == "impact") {
    Scene scene{"impact", "a tetrahedral torus meets another at 2 m/s", {}};
    scene.model.bodies = {tetrahedra(0, 0, 0), tetrahedra(0.1, 0.05, 0.82)};
    for (Body& body : scene.model.bodies) body.friction = 1;
    scene.closing_speed = 2;
    return scene;
  }
  if (name == "skins") {
    Scene scene{"skins", "two skins in 4^3 trilinear cells, deep at the start", {}};
    const bool has_files = !files.empty();
    scene.model.bodies = {{has_files ? from_obj(files[0]) : lumpy_ball(4, 0), {{0, 0, 0}}},
                          {has_files ? from_obj(files[1]) : lumpy_ball(4, 2), {{0.8, 0.1, 0.2}}}};
    return scene;
  }
  if (name == "pile") {
    Scene scene{"pile", "ten tetrahedral tori fall in a pile", {}, 1.5};
    for (int i = 0; i < 10; ++i)
      scene.model.bodies.push_back(
          {torus(20, 8), {{0.2 * std::sin(2.0 * i), 0.2 * std::cos(3.0 * i), 0.6 + 0.9 * i}}, 30, 5e4, 0.5});
    scene.model.gravity = 9.81;
    scene.model.has_floor = true;
    return scene;
  }
  throw std::invalid_argument("there is no scene '" + name + "'");
}

struct Run::Contacts {
  raycontact::mujoco::AttachedContact attached;
};

Run::Run(const Scene& scene, Contact contact, double timestep) : bodies_(scene.model.bodies.size()) {
  Model model = scene.model;
  model.timestep = timestep;
  const std::string xml = xml_of(model, contact);
  char message[1000] = "";
  const std::unique_ptr<mjSpec, void (*)(mjSpec*)> spec(
      mj_parseXMLString(xml.c_str(), nullptr, message, sizeof message), mj_deleteSpec);
  if (spec == nullptr) throw std::runtime_error(std::string("MuJoCo does not read the model: ") + message);
  m_.reset(mj_compile(spec.get(), nullptr));
  if (m_ == nullptr)
    throw std::runtime_error(std::string("MuJoCo does not compile the model: ") + mjs_getError(spec.get()));
  d_.reset(mj_makeData(m_.get()));
  if (scene.closing_speed > 0)
    for (int dof = m_->nv / 2; dof < m_->nv; ++dof) d_->qvel[dof] = dof % 3 == 2 ? -scene.closing_speed : 0;
  mj_forward(m_.get(), d_.get());
  judge_ = std::make_unique<Judge>(m_.get(), model);
  if (contact == Contact::raycontact)
    contacts_.reset(new Contacts{raycontact::mujoco::AttachedContact(m_.get(), d_.get())});
  last_step_ = static_cast<int>(std::lround(scene.seconds / timestep));
  figures_.start_depth = judge_->depth(d_.get());
  figures_.start_energy = judge_->energy(d_.get());
  figures_.most_energy = least_energy_ = figures_.start_energy;
  start_momentum_ = judge_->momentum(d_.get());
  figures_.apart = figures_.start_depth > 0 ? -1 : 0;
}

Run::~Run() = default;

void Run::step() {
  if (contacts_ != nullptr) {
    timed_callback = mjcb_passive;
    mjcb_passive = measure;
    adapter_time = 0;
  }
  const double start = processor_time();
  mj_step(m_.get(), d_.get());
  // The first step also builds what is searched in later; it is not counted.
  if (steps_ > 0) figures_.step_time += processor_time() - start;
  if (contacts_ != nullptr) {
    mjcb_passive = timed_callback;
    if (steps_ > 0) figures_.adapter_time += adapter_time;
  }
  ++steps_;
  look();
}

void Run::look() {
  // Kinematics of the state that the step ends with.
  mj_kinematics(m_.get(), d_.get());
  mj_comPos(m_.get(), d_.get());
  mj_flex(m_.get(), d_.get());
  figures_.last_depth = judge_->depth(d_.get());
  figures_.deepest = std::max(figures_.deepest, figures_.last_depth);
  figures_.last_energy = judge_->energy(d_.get());
  figures_.most_energy = std::max(figures_.most_energy, figures_.last_energy);
  least_energy_ = std::min(least_energy_, figures_.last_energy);
  figures_.largest_rise = std::max(figures_.largest_rise, figures_.last_energy - least_energy_);
  if (figures_.last_depth > 0) {
    figures_.apart = -1;
  } else if (figures_.apart < 0) {
    figures_.apart = d_->time;
    energy_apart_ = figures_.last_energy;
    figures_.energy_gain = 0;
  } else if (energy_apart_ > 0) {
    figures_.energy_gain = std::max(figures_.energy_gain, figures_.last_energy / energy_apart_ - 1);
  }
  figures_.most_inverted = std::max(figures_.most_inverted, judge_->inverted(d_.get()));
  const std::array<double, 3> momentum = judge_->momentum(d_.get());
  for (std::size_t k = 0; k < 3; ++k)
    figures_.drift = std::max(figures_.drift, std::fabs(momentum[k] - start_momentum_[k]));
}

Figures Run::figures() const {
  Figures figures = figures_;
  if (steps_ > 1) {
    figures.step_time /= steps_ - 1;
    figures.adapter_time /= steps_ - 1;
  }
  figures.lowest = 1e300;
  for (std::size_t b = 0; b < bodies_; ++b) {
    const std::vector<double> positions = judge_->positions(d_.get(), b);
    for (std::size_t k = 2; k < positions.size(); k += 3) figures.lowest = std::min(figures.lowest, positions[k]);
  }
  if (contacts_ != nullptr) figures.error = contacts_->attached.error();
  return figures;
}

}  // namespace flexes
