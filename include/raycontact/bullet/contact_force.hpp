// SPDX-License-Identifier: MIT OR Apache-2.0
/** Contact between the bodies of a btDeformableMultiBodyDynamicsWorld, as one of its implicit forces. */
#ifndef RAYCONTACT_BULLET_CONTACT_FORCE_HPP
#define RAYCONTACT_BULLET_CONTACT_FORCE_HPP

#include <BulletDynamics/Dynamics/btActionInterface.h>
#include <BulletDynamics/Dynamics/btDynamicsWorld.h>
#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableGravityForce.h>
#include <BulletSoftBody/btDeformableLagrangianForce.h>
#include <LinearMath/btIDebugDraw.h>
#include <LinearMath/btTransformUtil.h>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <map>
#include <stdexcept>
#include <utility>
#include <vector>

#include "raycontact/bullet/body_check.hpp"
#include "raycontact/bullet/contact_folding.hpp"
#include "raycontact/bullet/contact_rows.hpp"
#include "raycontact/bullet/options.hpp"
#include "raycontact/bullet/surface_set.hpp"

namespace raycontact::bullet {

/**
 * Detects once per sub-step and then acts as springs along the rays
 * inside the implicit solve. Bodies must outlive it, or be removed from the world or from it first. Errors of
 * detection, such as positions that are no longer finite, come out of stepSimulation as exceptions.
 */
class ContactForce : public btDeformableLagrangianForce {
 public:
  /** Refuses options out of range. */
  explicit ContactForce(const ContactOptions& options = {}) : options_(options), surfaces_(options), reaction_(*this) {
    m_nodes = nullptr;
  }

  ~ContactForce() override {
    if (world_ != nullptr) world_->removeAction(&reaction_);
  }

  ContactForce(const ContactForce&) = delete;
  ContactForce& operator=(const ContactForce&) = delete;

  /** Call once. `world.addForce` would drop a second force of the same type without a word. */
  void register_with(btDeformableBodySolver& solver) {
    solver.getLagrangianForceArray()->push_back(this);
    setIndices(solver.getIndices());
    solver_ = &solver;
  }

  /** The same, and rigid bodies of `world` feel the reaction; the world must outlive this force. */
  void register_with(btDeformableBodySolver& solver, btDynamicsWorld& world) {
    register_with(solver);
    world.addAction(&reaction_);
    world_ = &world;
  }

  /** The body's own faces are its collision surface. */
  void add_body(btSoftBody& body, const BodyOptions& options = {}) {
    if (body.m_faces.size() == 0)
      throw std::invalid_argument("soft body: it has no faces; appendFace its boundary, outward, or give it a skin");
    add_body(body, skin_from_faces(body), options);
  }

  /** A finer surface carried by the body's nodes. */
  void add_body(btSoftBody& body, Skin skin, const BodyOptions& options = {}) {
    check_body(body);
    surfaces_.add_soft(body, std::move(skin), options);
    m_softBodies.push_back(&body);
  }

  /** Soft bodies collide with the surface of the body's shape; see surface_of_shape. Rigid bodies pass each other. */
  void add_rigid_body(btRigidBody& body, const BodyOptions& options = {}) {
    add_rigid_body(body, surface_of_shape(*body.getCollisionShape()), options);
  }

  /** The same with a surface of its own. Open surfaces (terrain) are taken for bodies that no force moves. */
  void add_rigid_body(btRigidBody& body, RigidSurface surface, const BodyOptions& options = {}) {
    if (world_ == nullptr && !body.isStaticOrKinematicObject())
      throw std::logic_error("rigid body: it could not react; call register_with(solver, world) first");
    surfaces_.add_rigid(body, std::move(surface), options);
  }

  /** Needed for rigid bodies only: soft ones leave when they leave the world. */
  void remove_rigid_body(btRigidBody& body) {
    surfaces_.remove(&body);
    forget();
  }

  /** Refuses a normal that is no unit vector, and a negative stiffness. */
  void add_half_space(const HalfSpace& half_space) {
    check_half_space(half_space);
    half_spaces_.push_back(half_space);
  }

  /** Contacts of the last detection; of those, only what ends up pushing bears any load. */
  std::size_t contact_count() const { return surfaces_.contacts().size(); }
  /** The contacts of the last detection; `colliding` and `collided` count bodies in the order of `add_...`. */
  const std::vector<rayc_contact>& contacts() const { return surfaces_.contacts(); }
  /** What the last detection did: rays, misses, pairs that escape. */
  rayc_statistics statistics() const { return surfaces_.statistics(); }
  /** Positions of the skins, search structures, rays: everything up to the list of contacts. */
  double last_detection_ms() const { return surfaces_.detection_ms(); }

  /** The net force of `other` on `body` in the last sub-step, in N, as the solve left it. Zero for a body and itself.
   */
  btVector3 pair_force(const btCollisionObject& body, const btCollisionObject& other) {
    const int a = static_cast<int>(surfaces_.index_of(body)), b = static_cast<int>(surfaces_.index_of(other));
    btVector3 sum(0, 0, 0);
    if (m_nodes == nullptr || a == b) return sum;
    rows_.solution(*m_nodes, [&](const btVector3&, int first, int second, const btVector3& pull) {
      if (first == a && second == b) sum += pull;
      if (first == b && second == a) sum -= pull;
    });
    return sum;
  }

  /**
   * For a solver of the host's own that takes Newton steps: to be called after each, with its result in the nodes' m_v.
   * One body that is stopped may be in the way of the next, which detection took to be moving on. Looks for contacts
   * where the bodies would end now, if that is further than the depth cap from where they were sought before, and takes
   * those of pairs that had none, or less than half as many; true if there are such: another step is due.
   */
  bool detect_again() {
    LookAhead ahead = look_ahead();
    ahead.gained.setZero();
    if (!options_.look_ahead) return false;
    const bool is_far = ends_elsewhere(ahead.time);
    if (!is_far && free_velocities_.size() == 1) return false;
    const bool has_changed = rows_.has_changed(*m_nodes);
    std::vector<btVector3> velocities(velocities_.size());
    for (std::size_t n = 0; n < velocities.size(); ++n)
      velocities[n] = ahead.velocity(*(*m_nodes)[static_cast<int>(n)]);
    free_velocities_.push_back(std::move(velocities));
    rows_.start_pass();
    return (is_far && add_contacts(ahead)) || has_changed;
  }

  /** @cond What Bullet calls, as it describes it. */

  void addSoftBody(btSoftBody* body) override { add_body(*body); }

  void removeSoftBody(btSoftBody* body) override {
    m_softBodies.remove(body);
    surfaces_.remove(body);
    forget();
  }

  void reinitialize(bool) override {
    if (m_nodes == nullptr)
      throw std::logic_error("raycontact: call ContactForce::register_with before the first step");
    if (static_cast<std::size_t>(m_nodes->size()) != velocities_.size()) forget();  // nodes have new numbers
    finish_step();
    for (detail::ContactBody& body : surfaces_.bodies()) {
      body.in_world = body.soft != nullptr ? is_in_world(*body.soft) : body.rigid->isInWorld();
      if (!body.in_world || body.soft == nullptr) continue;
      body.first_node = body.soft->m_nodes[0].index;
      switch_off_continuous_collision(*body.soft);
    }
    anchors_.start_step();
    const LookAhead ahead = look_ahead();
    collect_velocities(ahead);
    surfaces_.detect(ahead);
    surfaces_.advance(static_cast<double>(solver_->m_objective->m_dt));
    rows_.clear();
    detail::ContactFolding folding(surfaces_, rows_, ahead.time, options_.friction > 0 ? &anchors_ : nullptr);
    folding.fold_contacts(surfaces_, [](int, int) { return true; });
    folding.fold_pushes(surfaces_, options_);
    for (std::size_t h = 0; h < half_spaces_.size(); ++h) folding.fold_half_space(half_spaces_[h], h);
  }

  void addScaledForces(btScalar scale, TVStack& force) override {
    rows_.update(*m_nodes, velocities_, free_velocities_, inverse_masses_, scale, law());
    rows_.add_forces(scale, force);
  }

  void addScaledElasticForceDifferential(btScalar, const TVStack& dx, TVStack& df) override {
    rows_.add_differential(dx, df);
  }

  // Damping is part of the above.
  void addScaledDampingForce(btScalar, TVStack&) override {}
  void addScaledDampingForceDifferential(btScalar, const TVStack&, TVStack&) override {}
  void buildDampingForceDifferentialDiagonal(btScalar, TVStack&) override {}

  void addScaledExplicitForce(btScalar, TVStack&) override {
    throw std::logic_error("raycontact: the world integrates explicitly; call world.setImplicit(true)");
  }

  double totalElasticEnergy(btScalar) override {
    throw std::logic_error("raycontact: line search sinks bodies into each other; call world.setLineSearch(false)");
  }

  // No enumerator is meant for forces from outside; 7 is free and fits the enumeration's three bits.
  btDeformableLagrangianForceType getForceType() override { return static_cast<btDeformableLagrangianForceType>(7); }

  /** @endcond */

 private:
  /** Runs when Bullet has moved everything: rigid bodies then get what the solve found for them. */
  class Reaction : public btActionInterface {
   public:
    explicit Reaction(ContactForce& force) : force_(force) {}
    void updateAction(btCollisionWorld*, btScalar time_step) override { force_.move_rigid_bodies(time_step); }
    void debugDraw(btIDebugDraw* drawer) override {
      const auto vector = [](const double* x) { return btVector3(btScalar(x[0]), btScalar(x[1]), btScalar(x[2])); };
      for (const rayc_contact& contact : force_.contacts())
        drawer->drawContactPoint(vector(contact.p1.position), vector(contact.direction), btScalar(contact.depth), 1,
                                 btVector3(1, 1, 0));
    }

   private:
    ContactForce& force_;
  };

  detail::RowLaw law() const {
    return {btScalar(options_.damping_time), btScalar(options_.depth_cap), btScalar(options_.friction),
            options_.directions == Stiffness::isotropic, options_.look_ahead};
  }

  // Bullet sets the step of the objective before it reinitialises the forces.
  LookAhead look_ahead() const {
    if (!options_.look_ahead) return {};
    return {solver_->m_objective->m_dt, solver_->m_objective->m_dt * gravity()};
  }

  // Contacts where nodes would be with the velocities they have, of pairs that have more there than they had.
  bool add_contacts(const LookAhead& ahead) {
    surfaces_.keep_positions();
    surfaces_.detect(ahead);
    std::map<std::pair<int, int>, std::size_t> found;
    for (std::size_t i = 0; i < surfaces_.contacts().size(); ++i) {
      // Those of pairs that are pushed as whole bodies push nothing themselves: such a pair keeps its push.
      if (!(surfaces_.coefficients()[i] > 0)) continue;
      const rayc_contact& contact = surfaces_.contacts()[i];
      ++found[std::minmax(static_cast<int>(contact.colliding), static_cast<int>(contact.collided))];
    }
    for (auto pair = found.begin(); pair != found.end();) {
      const bool is_news = pair->second > 2 * rows_.count(pair->first.first, pair->first.second);
      if (is_news) rows_.drop(pair->first.first, pair->first.second);
      pair = is_news ? std::next(pair) : found.erase(pair);
    }
    detail::ContactFolding(surfaces_, rows_, ahead.time).fold_contacts(surfaces_, [&](int first, int second) {
      return found.count(std::minmax(first, second)) > 0;
    });
    surfaces_.restore_positions();
    return !found.empty();
  }

  bool ends_elsewhere(btScalar time) const {
    const btScalar cap = static_cast<btScalar>(options_.depth_cap) / time;
    for (int n = 0; n < m_nodes->size(); ++n) {
      const btSoftBody::Node& node = *(*m_nodes)[n];
      if (node.m_im > 0 && (node.m_v - free_velocities_.back()[static_cast<std::size_t>(n)]).length2() > cap * cap)
        return true;
    }
    return false;
  }

  // Surfaces are still where detection had them.
  void finish_step() {
    rows_.remember_loads(*m_nodes);
    if (!(options_.friction > 0)) return;
    rows_.holds([&](std::size_t hold, bool is_dragged, const btVector3& offset) {
      if (is_dragged)
        anchors_.drag(surfaces_.bodies(), hold, offset);
      else
        anchors_.keep(hold);
    });
    anchors_.finish_step();
  }

  void forget() {
    rows_.forget();
    anchors_.forget();
  }

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

  btVector3 gravity() const {
    const auto& forces = *solver_->getLagrangianForceArray();
    for (int i = 0; i < forces.size(); ++i)
      if (forces[i]->getForceType() == BT_GRAVITY_FORCE)
        return static_cast<btDeformableGravityForce*>(forces[i])->m_gravity;
    return {0, 0, 0};
  }

  void collect_velocities(const LookAhead& ahead) {
    velocities_.resize(static_cast<std::size_t>(m_nodes->size()));
    free_velocities_.resize(1);
    free_velocities_[0].resize(velocities_.size());
    inverse_masses_.clear();
    for (const detail::ContactBody& body : surfaces_.bodies()) {
      const double mass = body.soft != nullptr ? double(body.soft->getTotalMass()) : 0;
      inverse_masses_.push_back(body.soft != nullptr ? 1 / mass : double(body.rigid->getInvMass()));
      if (body.soft == nullptr || !body.in_world) continue;
      LookAhead own = ahead;
      own.gained *= body.soft->m_gravityFactor;
      for (int n = 0; n < body.soft->m_nodes.size(); ++n) {
        const btSoftBody::Node& node = body.soft->m_nodes[n];
        velocities_[static_cast<std::size_t>(body.first_node + n)] = LookAhead().velocity(node);
        free_velocities_[0][static_cast<std::size_t>(body.first_node + n)] = own.velocity(node);
      }
    }
  }

  void move_rigid_bodies(btScalar time_step) {
    if (m_nodes == nullptr || rows_.rigids().all().empty()) return;
    rows_.solution(*m_nodes, [](const btVector3&, int, int, const btVector3&) {});
    for (const detail::CoupledRigid& rigid : rows_.rigids().all()) {
      if (!rigid.movable) continue;
      const btVector3 linear = detail::three_of(rigid.change, 0), angular = detail::three_of(rigid.change, 3);
      rigid.body->setLinearVelocity(rigid.body->getLinearVelocity() + linear);
      rigid.body->setAngularVelocity(rigid.body->getAngularVelocity() + angular);
      btTransform moved;
      btTransformUtil::integrateTransform(rigid.body->getWorldTransform(), linear, angular, time_step, moved);
      rigid.body->proceedToTransform(moved);
    }
  }

  ContactOptions options_;
  detail::SurfaceSet surfaces_;
  std::vector<HalfSpace> half_spaces_;
  detail::ContactRows rows_;
  Reaction reaction_;
  detail::FrictionAnchors anchors_;
  std::vector<btVector3> velocities_;                    // of the nodes, before the step
  std::vector<std::vector<btVector3>> free_velocities_;  // after it if nothing more stopped them, for each detection
  std::vector<double> inverse_masses_;
  btDeformableBodySolver* solver_ = nullptr;
  btDynamicsWorld* world_ = nullptr;
};

}  // namespace raycontact::bullet

#endif  // RAYCONTACT_BULLET_CONTACT_FORCE_HPP
