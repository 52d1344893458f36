// SPDX-License-Identifier: MIT OR Apache-2.0
/** Contact of flexes as an engine plugin, which an XML model switches on without code. */
#ifndef RAYCONTACT_MUJOCO_PLUGIN_HPP
#define RAYCONTACT_MUJOCO_PLUGIN_HPP

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <sstream>
#include <stdexcept>
#include <string>

#include "raycontact/mujoco/callback.hpp"

namespace raycontact::mujoco {

/** The plugin's name in XML. */
constexpr const char* plugin_name = "raycontact.flex_contact";

/** Its attributes: the numbers and names of ContactOptions. */
constexpr std::array<const char*, 12> plugin_attributes{{"flexes", "pressure", "depth", "damping_time", "friction",
                                                         "self_collision", "close_holes", "sampling",
                                                         "sampling_value", "threads", "solves", "tolerance"}};

namespace detail {

/** An attribute's number; `otherwise` where it is not set. */
inline double plugin_number(const mjModel* m, int instance, const char* name, double otherwise) {
  const char* text = mj_getPluginConfig(m, instance, name);
  if (text == nullptr || *text == '\0') return otherwise;
  char* end = nullptr;
  const double value = std::strtod(text, &end);
  while (*end == ' ') ++end;
  if (end == text || *end != '\0')
    throw std::invalid_argument(std::string("raycontact: ") + name + "=\"" + text + "\" is no number");
  return value;
}

/** The same for whole numbers. */
inline int plugin_count(const mjModel* m, int instance, const char* name, int otherwise) {
  const double value = plugin_number(m, instance, name, otherwise);
  if (!(value >= 0 && value <= 1024) || value != std::floor(value))
    throw std::invalid_argument(std::string("raycontact: ") + name + " must be a whole number from 0 to 1024");
  return static_cast<int>(value);
}

/** An attribute that names a rayc_sampling. */
inline rayc_sampling plugin_sampling(const mjModel* m, int instance, rayc_sampling otherwise) {
  const char* text = mj_getPluginConfig(m, instance, "sampling");
  const std::string name = text == nullptr ? "" : text;
  if (name.empty()) return otherwise;
  if (name == "accuracy") return RAYC_SAMPLING_ACCURACY;
  if (name == "spacing") return RAYC_SAMPLING_SPACING;
  if (name == "vertices") return RAYC_SAMPLING_VERTICES;
  throw std::invalid_argument("raycontact: sampling=\"" + name +
                              "\" is none; it is accuracy, spacing or vertices");
}

inline ContactOptions plugin_options(const mjModel* m, int instance) {
  ContactOptions options;
  if (const char* names = mj_getPluginConfig(m, instance, "flexes"); names != nullptr) {
    std::istringstream words(names);
    for (std::string name; words >> name;) options.flexes.push_back(name);
  }
  options.pressure = plugin_number(m, instance, "pressure", options.pressure);
  options.depth = plugin_number(m, instance, "depth", options.depth);
  options.damping_time = plugin_number(m, instance, "damping_time", options.damping_time);
  options.friction = plugin_number(m, instance, "friction", options.friction);
  options.self_collision = plugin_count(m, instance, "self_collision", 0) != 0;
  options.close_holes = plugin_number(m, instance, "close_holes", options.close_holes);
  options.sampling = plugin_sampling(m, instance, options.sampling);
  options.sampling_value = plugin_number(m, instance, "sampling_value", options.sampling_value);
  options.threads = static_cast<uint32_t>(plugin_count(m, instance, "threads", 1));
  options.solves = plugin_count(m, instance, "solves", options.solves);
  options.tolerance = plugin_number(m, instance, "tolerance", options.tolerance);
  return options;
}

inline GuardedContact* plugin_contact(const mjData* d, int instance) {
  return reinterpret_cast<GuardedContact*>(d->plugin_data[instance]);
}

/** What is refused is said as a warning, and flexes then pass through one another: a status would end the program. */
inline int plugin_init(const mjModel* m, mjData* d, int instance) noexcept {
  d->plugin_data[instance] = 0;
  try {
    for (int other = 0; other < instance; ++other)
      if (m->plugin[other] == m->plugin[instance])
        throw std::invalid_argument("raycontact: the model has two instances of the plugin; name all flexes in one");
    d->plugin_data[instance] = reinterpret_cast<uintptr_t>(new GuardedContact(m, plugin_options(m, instance)));
  } catch (const std::exception& refused) {
    mju_warning("%s. There is no contact between flexes.", refused.what());
  }
  return 0;
}

inline void plugin_destroy(mjData* d, int instance) noexcept {
  delete plugin_contact(d, instance);
  d->plugin_data[instance] = 0;
}

inline void plugin_reset(const mjModel*, mjtNum*, void* data, int) noexcept {
  if (data != nullptr) static_cast<GuardedContact*>(data)->reset();
}

/** A copy begins without a memory of what friction held on to. */
inline void plugin_copy(mjData* to, const mjModel*, const mjData*, int instance) noexcept {
  if (GuardedContact* contact = plugin_contact(to, instance)) contact->reset();
}

inline void plugin_compute(const mjModel* m, mjData* d, int instance, int) noexcept {
  if (GuardedContact* contact = plugin_contact(d, instance)) contact->add_forces(m, d);
}

}  // namespace detail

/** Registers the plugin with MuJoCo: from mjPLUGIN_LIB_INIT in a shared library, or from a program. */
inline void register_plugin() {
  mjpPlugin plugin;
  mjp_defaultPlugin(&plugin);
  plugin.name = plugin_name;
  plugin.nattribute = static_cast<int>(plugin_attributes.size());
  plugin.attributes = plugin_attributes.data();
  plugin.capabilityflags = mjPLUGIN_PASSIVE;
  plugin.nstate = [](const mjModel*, int) { return 0; };
  plugin.init = detail::plugin_init;
  plugin.destroy = detail::plugin_destroy;
  plugin.copy = detail::plugin_copy;
  plugin.reset = detail::plugin_reset;
  plugin.compute = detail::plugin_compute;
  mjp_registerPlugin(&plugin);
}

}  // namespace raycontact::mujoco

#endif  // RAYCONTACT_MUJOCO_PLUGIN_HPP
