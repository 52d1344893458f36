// SPDX-License-Identifier: MIT OR Apache-2.0
/** From contacts on surfaces to rows over the nodes that carry those surfaces. */
#ifndef RAYCONTACT_BULLET_CONTACT_FOLDING_HPP
#define RAYCONTACT_BULLET_CONTACT_FOLDING_HPP

#include <cstddef>
#include <vector>

#include "raycontact/bullet/contact_rows.hpp"
#include "raycontact/bullet/friction_anchors.hpp"
#include "raycontact/bullet/surface_set.hpp"

namespace raycontact::bullet::detail {

/** Folds one detection. A contact of a body with itself is a row like any other: its two points share nodes, which sum.
 */
class ContactFolding {
 public:
  /** `anchors`: for friction, or nullptr. */
  ContactFolding(const SurfaceSet& surfaces, ContactRows& rows, btScalar time_ahead, FrictionAnchors* anchors = nullptr)
      : bodies_(surfaces.bodies()), rows_(rows), time_ahead_(time_ahead), anchors_(anchors) {}

  /** `is_wanted(first, second)`: whether to take contacts of this pair of bodies. */
  template <class IsWanted>
  void fold_contacts(const SurfaceSet& surfaces, IsWanted is_wanted) {
    for (std::size_t i = 0; i < surfaces.contacts().size(); ++i) {
      const rayc_contact& contact = surfaces.contacts()[i];
      const ContactBody &colliding = bodies_[contact.colliding], &collided = bodies_[contact.collided];
      const double coefficient = surfaces.coefficients()[i];
      const int first = static_cast<int>(contact.colliding), second = static_cast<int>(contact.collided);
      if (!collide(colliding, collided) || !(coefficient > 0) || !is_wanted(first, second)) continue;
      add_surface_point(colliding, contact.p1, -1);
      add_surface_point(collided, contact.p2, 1);
      const Hold hold = anchors_ != nullptr ? anchors_->find(bodies_, contact) : Hold{};
      rows_.finish_row(vector(contact.direction), btScalar(contact.depth), btScalar(coefficient), first, second,
                       anchors_ != nullptr ? &hold : nullptr);
    }
  }

  /** Escaping pairs: one spring between the two centres of mass, so that every node gets the same acceleration. */
  void fold_pushes(const SurfaceSet& surfaces, const ContactOptions& options) {
    for (const rayc_escape_push& push : surfaces.pushes()) {
      const ContactBody &first = bodies_[push.first], &second = bodies_[push.second];
      if (!collide(first, second)) continue;
      add_whole_body(first, -1);
      add_whole_body(second, 1);
      const double weight = options.weighting == RAYC_WEIGHTING_AREA ? push.area : push.contact_count;
      rows_.finish_row(vector(push.direction), btScalar(push.depth), btScalar(options.stiffness * weight),
                       static_cast<int>(push.first), static_cast<int>(push.second));
    }
  }

  void fold_half_space(const HalfSpace& half_space, std::size_t number) {
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      const ContactBody& body = bodies_[b];
      if (!body.in_world || body.soft == nullptr) continue;
      for (std::size_t p = 0; p < body.skin.points.size(); ++p) {
        const btScalar* x = &body.positions[3 * p];
        const btScalar depth = half_space.offset - half_space.normal.dot(btVector3(x[0], x[1], x[2]));
        if (!(depth > 0) || !(body.areas[p] > 0)) continue;
        add_skin_point(body, p, -1);
        const Hold hold = anchors_ != nullptr ? anchors_->find(bodies_, b, p, number) : Hold{};
        rows_.finish_row(half_space.normal, depth, half_space.stiffness * body.areas[p], static_cast<int>(b), -1,
                         anchors_ != nullptr ? &hold : nullptr);
      }
    }
  }

 private:
  // Two rigid bodies are the host's own business.
  static bool collide(const ContactBody& a, const ContactBody& b) {
    return a.in_world && b.in_world && (a.soft != nullptr || b.soft != nullptr);
  }

  static btVector3 vector(const double* x) { return btVector3(btScalar(x[0]), btScalar(x[1]), btScalar(x[2])); }

  int add_rigid(btRigidBody& body) {
    Twist ahead{};
    if (time_ahead_ > 0) {
      ahead = RigidCoupling::velocity(body);
      const btVector3 gained = gravity_gain(body, time_ahead_);
      for (int axis = 0; axis < 3; ++axis) ahead[static_cast<std::size_t>(axis)] += double(gained[axis]);
    }
    return rows_.rigids().add(body, ahead);
  }

  // Contact points are where the body will be, and so is its centre.
  btVector3 centre_ahead(const btRigidBody& body) const {
    return body.getCenterOfMassPosition() + time_ahead_ * (body.getLinearVelocity() + gravity_gain(body, time_ahead_));
  }

  void add_surface_point(const ContactBody& body, const rayc_surface_point& point, btScalar sign) {
    if (body.rigid != nullptr) {
      if (body.rigid->getInvMass() > 0) body.rigid->activate();
      rows_.set_rigid_point({add_rigid(*body.rigid), sign, vector(point.position) - centre_ahead(*body.rigid)});
      return;
    }
    for (int corner = 0; corner < 3; ++corner)
      if (point.weights[corner] != 0)
        add_skin_point(body, point.vertices[corner], sign * static_cast<btScalar>(point.weights[corner]));
  }

  void add_skin_point(const ContactBody& body, std::size_t p, btScalar weight) {
    const SkinPoint& point = body.skin.points[p];
    for (std::size_t k = 0; k < 4; ++k)
      if (point.weights[k] != 0) rows_.add(body.first_node + point.nodes[k], weight * btScalar(point.weights[k]));
  }

  void add_whole_body(const ContactBody& body, btScalar sign) {
    if (body.rigid != nullptr) {
      rows_.set_rigid_point({add_rigid(*body.rigid), sign, btVector3(0, 0, 0)});
      return;
    }
    const btScalar share = sign / body.soft->getTotalMass();
    for (int n = 0; n < body.soft->m_nodes.size(); ++n)
      if (body.soft->m_nodes[n].m_im > 0) rows_.add_distinct(body.first_node + n, share / body.soft->m_nodes[n].m_im);
  }

  const std::vector<ContactBody>& bodies_;
  ContactRows& rows_;
  btScalar time_ahead_;
  FrictionAnchors* anchors_;
};

}  // namespace raycontact::bullet::detail

#endif  // RAYCONTACT_BULLET_CONTACT_FOLDING_HPP
