// SPDX-License-Identifier: MIT OR Apache-2.0
/** Contact between the bodies of a btDeformableMultiBodyDynamicsWorld, as one of its implicit forces. */
#ifndef RAYCONTACT_BULLET_CONTACT_FORCE_HPP
#define RAYCONTACT_BULLET_CONTACT_FORCE_HPP

#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableLagrangianForce.h>

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
#include "raycontact/bullet/body_check.hpp"
#include "raycontact/bullet/contact_rows.hpp"
#include "raycontact/bullet/precision.hpp"
#include "raycontact/bullet/skin.hpp"

namespace raycontact::bullet {

/**
 * A stiffness per area (N/m^3) that parts bodies without crushing them: factor * E / h, where E is Young's modulus
 * (Pa) and h the edge of a typical element (m) of the softer body. Factors from 0.1 to 3 work.
 */
inline double suggested_stiffness(double youngs_modulus, double element_edge, double factor = 1) {
  return factor * youngs_modulus / element_edge;
}

struct ContactOptions {
  double stiffness = 1000;       ///< N/m^3 (N/m with RAYC_WEIGHTING_VERTEX); see suggested_stiffness
  double damping_time = 0.05;    ///< s; damping along the ray = stiffness * damping_time
  uint32_t weighting = RAYC_WEIGHTING_AREA;
  double depth_cap = std::numeric_limits<double>::infinity();  ///< m; asked of one step: a tenth to half an element edge
  /// m; where rays start: 0 = at each vertex of the skins, the least that a skin finer than its cage needs.
  double sample_spacing = RAYC_SPACING_AUTOMATIC;
  uint32_t threads = 1;          ///< for detection; 1 = the caller's own, 0 = one for each core
};

/** A frictionless floor: pushes along `normal` where normal . x < offset. */
struct HalfSpace {
  btVector3 normal;    ///< unit, out of the solid
  btScalar offset;     ///< m
  btScalar stiffness;  ///< N/m^3
};

/**
 * Detects once per sub-step, at the positions and velocities it starts from, and then acts as springs along the rays
 * inside the implicit solve. Bodies must outlive it or be removed from the world first. Errors of detection, such as
 * positions that are no longer finite, come out of stepSimulation as exceptions.
 */
class ContactForce : public btDeformableLagrangianForce {
 public:
  explicit ContactForce(const ContactOptions& options = {}) : options_(options), scene_(options.threads) {
    detail::require_library_of_same_precision();
    scene_.set_sample_spacing(options.sample_spacing);
    m_nodes = nullptr;
    response_ = default_response_options();
    response_.stiffness = options.stiffness;
    response_.damping_time = options.damping_time;
    response_.weighting = options.weighting;
  }

  /** Call once. `world.addForce` would drop a second force of the same type without a word. */
  void register_with(btDeformableBodySolver& solver) {
    solver.getLagrangianForceArray()->push_back(this);
    setIndices(solver.getIndices());
  }

  /** The body's own faces are its collision surface. */
  void add_body(btSoftBody& body) {
    if (body.m_faces.size() == 0)
      throw std::invalid_argument("soft body: it has no faces; appendFace its boundary, outward, or give it a skin");
    add_body(body, skin_from_faces(body));
  }

  /** A finer surface carried by the body's nodes. */
  void add_body(btSoftBody& body, Skin skin) {
    check_body(body);
    check_skin(body, skin);
    Body added{&body, std::move(skin), 0, false, {}, {}};
    skin_positions(body, added.skin, added.positions);
    added.areas = skin_areas(added.positions, added.skin.triangles);
    added.number = scene_.add(Mesh(vectors(added.positions.data(), added.skin.points.size()), added.skin.triangles));
    if (body_of_number_.size() <= added.number) body_of_number_.resize(added.number + 1, no_body);
    body_of_number_[added.number] = bodies_.size();
    bodies_.push_back(std::move(added));
    m_softBodies.push_back(&body);
  }

  void add_half_space(const HalfSpace& half_space) { half_spaces_.push_back(half_space); }

  std::size_t contact_count() const { return contacts_.size(); }
  /** The contacts of the last detection; `colliding` and `collided` count bodies in the order of `add_body`. */
  const std::vector<rayc_contact>& contacts() const { return contacts_; }
  /** Positions of the skins, search structures, rays: everything up to the list of contacts. */
  double last_detection_ms() const { return last_detection_ms_; }

  // What Bullet calls.

  void addSoftBody(btSoftBody* body) override { add_body(*body); }

  void removeSoftBody(btSoftBody* body) override {
    m_softBodies.remove(body);
    const auto gone = std::find_if(bodies_.begin(), bodies_.end(), [&](const Body& b) { return b.soft == body; });
    if (gone == bodies_.end()) return;
    scene_.remove(gone->number);
    bodies_.erase(gone);
    std::fill(body_of_number_.begin(), body_of_number_.end(), no_body);
    for (std::size_t i = 0; i < bodies_.size(); ++i) body_of_number_[bodies_[i].number] = i;
    forget_contacts();
  }

  void reinitialize(bool) override {
    if (m_nodes == nullptr) throw std::logic_error("raycontact: call ContactForce::register_with before the first step");
    for (Body& body : bodies_) {
      body.in_world = is_in_world(*body.soft);
      if (body.in_world) switch_off_continuous_collision(*body.soft);
    }
    detect();
    fold();
  }

  void addScaledForces(btScalar scale, TVStack& force) override {
    rows_.update(*m_nodes, damping_time(), static_cast<btScalar>(options_.depth_cap));
    rows_.add_forces(scale, force);
  }

  void addScaledExplicitForce(btScalar scale, TVStack& force) override { addScaledForces(scale, force); }

  void addScaledDampingForce(btScalar scale, TVStack& force) override {
    rows_.add_damping_forces(scale, *m_nodes, damping_time(), force);
  }

  void addScaledElasticForceDifferential(btScalar scale, const TVStack& dx, TVStack& df) override {
    rows_.add_differential(scale, dx, df);
  }

  void addScaledDampingForceDifferential(btScalar scale, const TVStack& dv, TVStack& df) override {
    if (options_.damping_time > 0) rows_.add_differential(scale * damping_time(), dv, df);
  }

  void buildDampingForceDifferentialDiagonal(btScalar, TVStack&) override {}

  double totalElasticEnergy(btScalar) override { return rows_.energy(*m_nodes); }

  // No enumerator is meant for forces from outside; 7 is free and fits the enumeration's three bits.
  btDeformableLagrangianForceType getForceType() override { return static_cast<btDeformableLagrangianForceType>(7); }

 private:
  static constexpr std::size_t no_body = std::numeric_limits<std::size_t>::max();

  struct Body {
    btSoftBody* soft;
    Skin skin;
    uint32_t number;  // in the scene
    bool in_world;
    std::vector<btScalar> positions;  // of the skin
    std::vector<btScalar> areas;      // at rest
  };

  btScalar damping_time() const { return static_cast<btScalar>(options_.damping_time); }

  bool is_in_world(const btSoftBody& body) const {
    const int index = body.m_nodes[0].index;
    return index >= 0 && index < m_nodes->size() && (*m_nodes)[index] == &body.m_nodes[0];
  }

  // Bullet runs its own continuous collision on any body with SDF_RD, whatever the flags say; an empty tree stops it.
  static void switch_off_continuous_collision(btSoftBody& body) {
    if (!body.m_bUpdateRtCst) return;
    body.m_bUpdateRtCst = false;
    body.updateConstants();
    body.m_fdbvt.clear();
  }

  void forget_contacts() {
    contacts_.clear();
    rows_.clear();
  }

  void detect() {
    const auto start = std::chrono::steady_clock::now();
    for (Body& body : bodies_) {
      if (!body.in_world) continue;
      skin_positions(*body.soft, body.skin, body.positions);
      scene_.set_positions(body.number, vectors(body.positions.data(), body.skin.points.size()));
    }
    scene_.query(found_);
    found_.copy_to(contacts_);
    found_.copy_coefficients_to(response_, coefficients_);
    last_detection_ms_ = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  }

  void fold() {
    rows_.clear();
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
      rayc_contact& contact = contacts_[i];
      const std::size_t colliding = body_of_number_[contact.colliding];
      const std::size_t collided = body_of_number_[contact.collided];
      contact.colliding = static_cast<uint32_t>(colliding);
      contact.collided = static_cast<uint32_t>(collided);
      if (!bodies_[colliding].in_world || !bodies_[collided].in_world) continue;
      add_surface_point(bodies_[colliding], contact.p1, -1);
      add_surface_point(bodies_[collided], contact.p2, 1);
      const btVector3 direction(btScalar(contact.direction[0]), btScalar(contact.direction[1]),
                                btScalar(contact.direction[2]));
      rows_.finish_row(direction, btScalar(contact.depth), btScalar(coefficients_[i]));
    }
    for (const HalfSpace& half_space : half_spaces_)
      for (const Body& body : bodies_)
        if (body.in_world) fold_half_space(half_space, body);
  }

  void fold_half_space(const HalfSpace& half_space, const Body& body) {
    for (std::size_t p = 0; p < body.skin.points.size(); ++p) {
      const btScalar* x = &body.positions[3 * p];
      const btScalar depth = half_space.offset - half_space.normal.dot(btVector3(x[0], x[1], x[2]));
      if (!(depth > 0) || !(body.areas[p] > 0)) continue;
      add_skin_point(body, p, -1);
      rows_.finish_row(half_space.normal, depth, half_space.stiffness * body.areas[p]);
    }
  }

  void add_surface_point(const Body& body, const rayc_surface_point& point, btScalar sign) {
    for (int corner = 0; corner < 3; ++corner)
      if (point.weights[corner] != 0)
        add_skin_point(body, point.vertices[corner], sign * static_cast<btScalar>(point.weights[corner]));
  }

  void add_skin_point(const Body& body, std::size_t p, btScalar weight) {
    const SkinPoint& point = body.skin.points[p];
    for (std::size_t k = 0; k < 4; ++k)
      if (point.weights[k] != 0) rows_.add(body.soft->m_nodes[point.nodes[k]].index, weight * point.weights[k]);
  }

  ContactOptions options_;
  rayc_response_options response_{};
  Scene scene_;
  Contacts found_;
  std::vector<Body> bodies_;
  std::vector<std::size_t> body_of_number_;
  std::vector<HalfSpace> half_spaces_;
  std::vector<rayc_contact> contacts_;
  std::vector<double> coefficients_;
  detail::ContactRows rows_;
  double last_detection_ms_ = 0;
};

}  // namespace raycontact::bullet

#endif  // RAYCONTACT_BULLET_CONTACT_FORCE_HPP
