// SPDX-License-Identifier: MIT OR Apache-2.0
/** The bodies whose surfaces collide, and the detection of their contacts: what both ways into Bullet share. */
#ifndef RAYCONTACT_BULLET_SURFACE_SET_HPP
#define RAYCONTACT_BULLET_SURFACE_SET_HPP

#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <LinearMath/btTransformUtil.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "raycontact.hpp"
#include "raycontact/bullet/options.hpp"
#include "raycontact/bullet/rigid_surface.hpp"
#include "raycontact/bullet/skin.hpp"

namespace raycontact::bullet::detail {

/** A soft body with its skin, or a rigid one with its surface. */
struct ContactBody {
  btSoftBody* soft;
  btRigidBody* rigid;
  Skin skin;                        // of a soft body
  RigidSurface surface;             // of a rigid one
  uint32_t number;                  // in the scene
  bool in_world;                    // as of the last detection
  int first_node;                   // the number its first node has in the rows
  std::vector<btScalar> positions;  // of the surface's points, in the world
  std::vector<btScalar> areas;      // of a skin, at rest
  std::vector<btScalar> kept_positions{};
  BodyOptions options{};
};

/** The velocity that gravity adds to a rigid body in a step. */
inline btVector3 gravity_gain(const btRigidBody& body, btScalar time) {
  return body.isStaticOrKinematicObject() ? btVector3(0, 0, 0) : time * body.getGravity();
}

class SurfaceSet {
 public:
  explicit SurfaceSet(const ContactOptions& options) : scene_(options.threads) {
    require_library_of_same_precision();
    check_options(options);
    rayc_detection_options detection{};
    check(rayc_default_detection_options(sizeof detection, &detection));
    detection.law = options.law;
    detection.sampling = options.sampling;
    detection.sampling_value = options.sampling_value;
    detection.edges = options.edges ? 1 : 0;
    detection.escape = options.escape ? 1 : 0;
    check(rayc_scene_set_detection_options(scene_.get(), &detection));
    response_ = default_response_options();
    response_.stiffness = options.stiffness;
    response_.damping_time = options.damping_time;
    response_.weighting = options.weighting;
    pushes_whole_bodies_ = options.whole_body_escape;
  }

  void add_soft(btSoftBody& body, Skin skin, const BodyOptions& options) {
    refuse_twice(&body);
    check_skin(body, skin);
    ContactBody added{&body, nullptr, std::move(skin), {}, 0, false, 0, {}, {}};
    skin_positions(body, added.skin, added.positions);
    added.areas = skin_areas(added.positions, added.skin.triangles);
    added.options = options;
    add(std::move(added), false);
    if (options.self_collision) scene_.set_self_collision(bodies_.back().number, true);
  }

  void add_rigid(btRigidBody& body, RigidSurface surface, const BodyOptions& options) {
    refuse_twice(&body);
    raycontact::detail::check_threes(surface.triangles.size(), "surface.triangles", "triangle");
    ContactBody added{nullptr, &body, {}, std::move(surface), 0, true, 0, {}, {}};
    place(added, {});
    added.options = options;
    // A triangle mesh may be a piece of terrain; a moving one must be closed to have an inside.
    add(std::move(added), body.isStaticOrKinematicObject());
  }

  void remove(const btCollisionObject* body) {
    const auto gone =
        std::find_if(bodies_.begin(), bodies_.end(), [&](const ContactBody& b) { return object(b) == body; });
    if (gone == bodies_.end()) return;
    scene_.remove(gone->number);
    // Contacts, which name it, are dropped below.
    scene_.release_body_numbers();
    bodies_.erase(gone);
    std::fill(index_of_number_.begin(), index_of_number_.end(), no_body);
    for (std::size_t i = 0; i < bodies_.size(); ++i) index_of_number_[bodies_[i].number] = i;
    contacts_.clear();
    coefficients_.clear();
    pushes_.clear();
  }

  /** Contacts where the bodies will be if nothing stops them, with bodies counted in the order they were added. */
  void detect(const LookAhead& ahead) {
    const auto start = std::chrono::steady_clock::now();
    for (ContactBody& body : bodies_) {
      if (!body.in_world) continue;
      place(body, ahead);
      scene_.set_positions(body.number, vectors(body.positions.data(), body.positions.size() / 3));
    }
    scene_.query(found_);
    found_.copy_to(contacts_);
    found_.copy_coefficients_to(response_, coefficients_);
    for (std::size_t i = 0; pushes_whole_bodies_ && i < contacts_.size(); ++i)
      if (contacts_[i].kind == RAYC_CONTACT_KIND_ESCAPE) coefficients_[i] = 0;
    copy_pushes();
    for (rayc_contact& contact : contacts_) {
      contact.colliding = static_cast<uint32_t>(index_of_number_[contact.colliding]);
      contact.collided = static_cast<uint32_t>(index_of_number_[contact.collided]);
    }
    detection_ms_ = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  }

  /** Ends the step, after its first detection: what is found from now on in the same step changes nothing for the next.
   */
  void advance(double seconds) { scene_.advance(seconds); }

  /** Positions as they are now, for restore_positions() after another detection in the same step. */
  void keep_positions() {
    for (ContactBody& body : bodies_) body.kept_positions = body.positions;
  }

  void restore_positions() {
    for (ContactBody& body : bodies_) std::swap(body.positions, body.kept_positions);
  }

  std::vector<ContactBody>& bodies() { return bodies_; }
  const std::vector<ContactBody>& bodies() const { return bodies_; }
  const std::vector<rayc_contact>& contacts() const { return contacts_; }
  const std::vector<double>& coefficients() const { return coefficients_; }  // N/m, one for each contact
  const std::vector<rayc_escape_push>& pushes() const { return pushes_; }
  double detection_ms() const { return detection_ms_; }

  rayc_statistics statistics() const {
    rayc_statistics statistics{};
    check(rayc_contacts_statistics(found_.get(), sizeof statistics, &statistics));
    return statistics;
  }

  std::size_t index_of(const btCollisionObject& body) const {
    for (std::size_t i = 0; i < bodies_.size(); ++i)
      if (object(bodies_[i]) == &body) return i;
    throw std::invalid_argument("this body was not added, or has been removed");
  }

 private:
  static constexpr std::size_t no_body = std::numeric_limits<std::size_t>::max();

  static const btCollisionObject* object(const ContactBody& body) {
    return body.soft != nullptr ? static_cast<const btCollisionObject*>(body.soft) : body.rigid;
  }

  void refuse_twice(const btCollisionObject* body) const {
    for (const ContactBody& other : bodies_)
      if (object(other) == body) throw std::invalid_argument("this body has been added already; remove it first");
  }

  void add(ContactBody body, bool may_be_open) {
    const std::vector<uint32_t>& triangles = body.soft != nullptr ? body.skin.triangles : body.surface.triangles;
    const rayc_vectors positions = vectors(body.positions.data(), body.positions.size() / 3);
    rayc_mesh_options options{};
    check(rayc_default_mesh_options(sizeof options, &options));
    rayc_mesh* made = nullptr;
    rayc_status status = rayc_mesh_create(&options, &positions, triangles.data(), triangles.size() / 3, &made);
    if (status == RAYC_STATUS_MESH_OPEN && may_be_open) {
      options.open = 1;
      status = rayc_mesh_create(&options, &positions, triangles.data(), triangles.size() / 3, &made);
    }
    check(status);
    const raycontact::detail::Owner<rayc_mesh, rayc_mesh_destroy> mesh(made);
    check(rayc_scene_add_mesh(scene_.get(), mesh.get(), &body.number));
    if (index_of_number_.size() <= body.number) index_of_number_.resize(body.number + 1, no_body);
    index_of_number_[body.number] = bodies_.size();
    for (const ContactBody& other : bodies_)
      if ((body.options.group & other.options.mask) == 0 || (other.options.group & body.options.mask) == 0)
        scene_.set_pair_collision(body.number, other.number, false);
    bodies_.push_back(std::move(body));
  }

  static void place(ContactBody& body, const LookAhead& ahead) {
    if (body.soft != nullptr) {
      LookAhead own = ahead;
      own.gained *= body.soft->m_gravityFactor;
      skin_positions(*body.soft, body.skin, body.positions, own);
      return;
    }
    body.positions.resize(3 * body.surface.points.size());
    btTransform transform = body.rigid->getWorldTransform();
    if (ahead.time > 0 && !body.rigid->isStaticObject()) {
      const btVector3 linear = body.rigid->getLinearVelocity() + gravity_gain(*body.rigid, ahead.time);
      btTransformUtil::integrateTransform(body.rigid->getWorldTransform(), linear, body.rigid->getAngularVelocity(),
                                          ahead.time, transform);
    }
    for (std::size_t i = 0; i < body.surface.points.size(); ++i) {
      const btVector3 x = transform * body.surface.points[i];
      for (int axis = 0; axis < 3; ++axis) body.positions[3 * i + static_cast<std::size_t>(axis)] = x[axis];
    }
  }

  void copy_pushes() {
    pushes_.clear();
    if (!pushes_whole_bodies_) return;
    found_.copy_escape_pushes_to(pushes_);
    for (rayc_escape_push& push : pushes_) {
      push.first = static_cast<uint32_t>(index_of_number_[push.first]);
      push.second = static_cast<uint32_t>(index_of_number_[push.second]);
    }
  }

  rayc_response_options response_{};
  bool pushes_whole_bodies_ = true;
  Scene scene_;
  Contacts found_;
  std::vector<ContactBody> bodies_;
  std::vector<std::size_t> index_of_number_;
  std::vector<rayc_contact> contacts_;
  std::vector<double> coefficients_;
  std::vector<rayc_escape_push> pushes_;
  double detection_ms_ = 0;
};

}  // namespace raycontact::bullet::detail

#endif  // RAYCONTACT_BULLET_SURFACE_SET_HPP
