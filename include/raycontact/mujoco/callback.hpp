// SPDX-License-Identifier: MIT OR Apache-2.0
/** Contact of flexes through MuJoCo's callback for passive forces. */
#ifndef RAYCONTACT_MUJOCO_CALLBACK_HPP
#define RAYCONTACT_MUJOCO_CALLBACK_HPP

#include <exception>
#include <map>
#include <memory>
#include <mutex>
#include <shared_mutex>
#include <stdexcept>
#include <string>
#include <utility>

#include "raycontact/mujoco/flex_contact.hpp"

namespace raycontact::mujoco {

namespace detail {

/** A contact, and the first error that it had: no exception passes into MuJoCo. */
class GuardedContact {
 public:
  GuardedContact(const mjModel* m, const ContactOptions& options) : contact(m, options) {}

  FlexContact contact;
  std::string error;

  void add_forces(const mjModel* m, mjData* d) noexcept {
    if (error.empty()) guard([&] { contact.add_forces(m, d, d->qfrc_passive); });
  }

  void reset() noexcept {
    error.clear();
    guard([&] { contact.reset(); });
  }

 private:
  template <class Call>
  void guard(Call&& call) noexcept {
    try {
      call();
    } catch (const std::exception& thrown) {
      try {
        error = thrown.what();
      } catch (...) {
        error.assign(1, '?');  // fits without memory
      }
      mju_warning("%s; from now on flexes pass through one another", error.c_str());
    }
  }
};

/** Which mjData has which contact, and whose callback was there before. */
struct CallbackRegistry {
  std::shared_mutex mutex;
  std::map<const mjData*, GuardedContact*> contacts;
  mjfGeneric before = nullptr;

  static CallbackRegistry& get() {
    static CallbackRegistry registry;
    return registry;
  }
};

inline void passive_callback(const mjModel* m, mjData* d) {
  CallbackRegistry& registry = CallbackRegistry::get();
  GuardedContact* contact = nullptr;
  mjfGeneric before = nullptr;
  {
    const std::shared_lock lock(registry.mutex);
    before = registry.before;
    const auto found = registry.contacts.find(d);
    if (found != registry.contacts.end()) contact = found->second;
  }
  // Forces of the program's own come first, so that contact knows them.
  if (before != nullptr) before(m, d);
  if (contact != nullptr) contact->add_forces(m, d);
}

}  // namespace detail

/**
 * As long as it lives, mj_step(m, d) has contact between the model's flexes: it sits in mjcb_passive, and calls what
 * the program had put there before. Several mjData may have one each, also on threads of their own; each must outlive
 * its contact. Install a callback of your own before the first of them is made.
 */
class AttachedContact {
 public:
  /** Throws as FlexContact does, and std::invalid_argument where d has a contact already. */
  AttachedContact(const mjModel* m, const mjData* d, const ContactOptions& options = {})
      : data_(d), guarded_(std::make_unique<detail::GuardedContact>(m, options)) {
    detail::CallbackRegistry& registry = detail::CallbackRegistry::get();
    const std::unique_lock lock(registry.mutex);
    if (!registry.contacts.emplace(d, guarded_.get()).second)
      throw std::invalid_argument("raycontact: this mjData has a contact already; attach one alone");
    if (mjcb_passive != detail::passive_callback) {
      registry.before = mjcb_passive;
      mjcb_passive = detail::passive_callback;
    }
  }

  ~AttachedContact() {
    detail::CallbackRegistry& registry = detail::CallbackRegistry::get();
    const std::unique_lock lock(registry.mutex);
    registry.contacts.erase(data_);
    if (registry.contacts.empty() && mjcb_passive == detail::passive_callback)
      mjcb_passive = std::exchange(registry.before, nullptr);
  }

  AttachedContact(const AttachedContact&) = delete;
  AttachedContact& operator=(const AttachedContact&) = delete;

  /** To ask for figures and materials. */
  const FlexContact& contact() const { return guarded_->contact; }
  /** What went wrong within a step; empty where nothing has. There is no contact from then on. */
  const std::string& error() const { return guarded_->error; }

 private:
  const mjData* data_;
  std::unique_ptr<detail::GuardedContact> guarded_;
};

}  // namespace raycontact::mujoco

#endif  // RAYCONTACT_MUJOCO_CALLBACK_HPP
