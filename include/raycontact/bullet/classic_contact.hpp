// SPDX-License-Identifier: MIT OR Apache-2.0
/** Contact for Bullet's classic soft bodies (btSoftRigidDynamicsWorld), by correcting positions and velocities. */
#ifndef RAYCONTACT_BULLET_CLASSIC_CONTACT_HPP
#define RAYCONTACT_BULLET_CLASSIC_CONTACT_HPP

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <utility>
#include <vector>

#include "raycontact/bullet/contact_folding.hpp"
#include "raycontact/bullet/contact_rows.hpp"
#include "raycontact/bullet/options.hpp"
#include "raycontact/bullet/surface_set.hpp"

namespace raycontact::bullet {

/**
 * Call apply(dt) after every step of the world, or in a tick callback of your own: Bullet has one slot for those and
 * this class leaves it alone. Of the options only those of detection and `depth_cap` count: corrections have no
 * stiffness.
 */
class ClassicContact {
 public:
  /** `relaxation`: the part of a correction that one call of apply() makes, above 0 and at most 1. */
  explicit ClassicContact(const ContactOptions& options = {}, double relaxation = 0.2)
      : options_(with_stiffness(options)), relaxation_(static_cast<btScalar>(relaxation)), surfaces_(options_) {
    if (!(relaxation > 0 && relaxation <= 1)) throw std::invalid_argument("relaxation must be above 0 and at most 1");
  }

  /** The body's own faces are its collision surface. */
  void add_body(btSoftBody& body, const BodyOptions& options = {}) {
    if (body.m_faces.size() == 0)
      throw std::invalid_argument("soft body: it has no faces; appendFace its boundary, outward, or give it a skin");
    add_body(body, skin_from_faces(body), options);
  }

  /** A finer surface carried by the body's nodes. */
  void add_body(btSoftBody& body, Skin skin, const BodyOptions& options = {}) {
    surfaces_.add_soft(body, std::move(skin), options);
  }

  /** Soft bodies collide with the surface of the body's shape; see surface_of_shape. Rigid bodies pass each other. */
  void add_rigid_body(btRigidBody& body, const BodyOptions& options = {}) {
    add_rigid_body(body, surface_of_shape(*body.getCollisionShape()), options);
  }
  /** The same with a surface of its own. */
  void add_rigid_body(btRigidBody& body, RigidSurface surface, const BodyOptions& options = {}) {
    surfaces_.add_rigid(body, std::move(surface), options);
  }

  /** Before the body leaves the world or is destroyed. */
  void remove_body(const btCollisionObject& body) { surfaces_.remove(&body); }

  /** Refuses a normal that is no unit vector, and a negative stiffness. */
  void add_half_space(const HalfSpace& half_space) {
    check_half_space(half_space);
    half_spaces_.push_back(half_space);
  }

  /** Contacts of the last apply(). */
  std::size_t contact_count() const { return surfaces_.contacts().size(); }
  /** They themselves; `colliding` and `collided` count bodies in the order of `add_...`. */
  const std::vector<rayc_contact>& contacts() const { return surfaces_.contacts(); }
  /** Positions of the skins, search structures, rays: everything up to the list of contacts. */
  double last_detection_ms() const { return surfaces_.detection_ms(); }

  /** Detects, and moves every node by a part of what its contacts ask for: x += d, v += d / dt. */
  void apply(double time_step) {
    if (!(time_step > 0)) throw std::invalid_argument("apply: the time step must be above 0");
    number_nodes();
    surfaces_.detect({});
    surfaces_.advance(time_step);
    rows_.clear();
    detail::ContactFolding folding(surfaces_, rows_, 0);
    folding.fold_contacts(surfaces_, [](int, int) { return true; });
    folding.fold_pushes(surfaces_, options_);
    for (std::size_t h = 0; h < half_spaces_.size(); ++h) folding.fold_half_space(half_spaces_[h], h);
    collect_corrections();
    correct(static_cast<btScalar>(time_step));
  }

 private:
  struct Correction {
    btVector3 sum{0, 0, 0};
    btScalar weight = 0;
  };

  struct RigidCorrection {
    btVector3 linear{0, 0, 0}, angular{0, 0, 0};
    btScalar weight = 0;
  };

  static ContactOptions with_stiffness(ContactOptions options) {
    options.stiffness = 1;  // a contact of no stiffness would be left out
    return options;
  }

  void number_nodes() {
    nodes_.clear();
    for (detail::ContactBody& body : surfaces_.bodies()) {
      body.in_world = true;
      if (body.soft == nullptr) continue;
      body.first_node = static_cast<int>(nodes_.size());
      for (int n = 0; n < body.soft->m_nodes.size(); ++n) nodes_.push_back(&body.soft->m_nodes[n]);
    }
  }

  void collect_corrections() {
    corrections_.assign(nodes_.size(), {});
    rigid_corrections_.assign(rows_.rigids().all().size(), {});
    const btScalar cap = static_cast<btScalar>(options_.depth_cap);
    rows_.visit([&](const btVector3& direction, btScalar depth, const detail::RigidPoint& point,
                    const detail::ContactRows::Entries& entries) {
      btScalar compliance = 0;
      for (std::size_t e = entries.begin; e < entries.end; ++e)
        compliance += entries.weight(e) * entries.weight(e) * node(entries, e).m_im;
      const bool moves_rigid = rows_.rigids().is_movable(point.rigid);
      const btVector3 turning = point.arm.cross(direction);
      if (moves_rigid) {
        const btRigidBody& rigid = *rows_.rigids()[point.rigid].body;
        compliance += rigid.getInvMass() + turning.dot(rigid.getInvInertiaTensorWorld() * turning);
      }
      if (!(compliance > 0)) return;
      const btScalar impulse = std::min(depth, cap) / compliance;
      for (std::size_t e = entries.begin; e < entries.end; ++e) {
        Correction& c = corrections_[static_cast<std::size_t>(entries.node(e))];
        c.sum -= (entries.weight(e) * node(entries, e).m_im * impulse) * direction;
        c.weight += btFabs(entries.weight(e));
      }
      if (moves_rigid) {
        const btRigidBody& rigid = *rows_.rigids()[point.rigid].body;
        RigidCorrection& c = rigid_corrections_[static_cast<std::size_t>(point.rigid)];
        c.linear -= (point.sign * rigid.getInvMass() * impulse) * direction;
        c.angular -= (point.sign * impulse) * (rigid.getInvInertiaTensorWorld() * turning);
        c.weight += 1;
      }
    });
  }

  const btSoftBody::Node& node(const detail::ContactRows::Entries& entries, std::size_t e) const {
    return *nodes_[static_cast<std::size_t>(entries.node(e))];
  }

  void correct(btScalar time_step) {
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
      if (!(corrections_[n].weight > 0)) continue;
      const btVector3 d = corrections_[n].sum * (relaxation_ / corrections_[n].weight);
      nodes_[n]->m_x += d;
      nodes_[n]->m_v += d / time_step;
    }
    for (std::size_t r = 0; r < rigid_corrections_.size(); ++r) {
      const RigidCorrection& c = rigid_corrections_[r];
      if (!(c.weight > 0)) continue;
      btRigidBody& body = *rows_.rigids()[static_cast<int>(r)].body;
      const btScalar factor = relaxation_ / c.weight / time_step;
      body.setLinearVelocity(body.getLinearVelocity() + c.linear * factor);
      body.setAngularVelocity(body.getAngularVelocity() + c.angular * factor);
    }
  }

  ContactOptions options_;
  btScalar relaxation_;
  detail::SurfaceSet surfaces_;
  std::vector<HalfSpace> half_spaces_;
  detail::ContactRows rows_;
  std::vector<btSoftBody::Node*> nodes_;
  std::vector<Correction> corrections_;
  std::vector<RigidCorrection> rigid_corrections_;
};

}  // namespace raycontact::bullet

#endif  // RAYCONTACT_BULLET_CLASSIC_CONTACT_HPP
