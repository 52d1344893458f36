// SPDX-License-Identifier: MIT OR Apache-2.0
/** Contact between the bodies of a btDeformableMultiBodyDynamicsWorld, as one of its implicit forces. */
#ifndef RAYCONTACT_BULLET_CONTACT_FORCE_HPP
#define RAYCONTACT_BULLET_CONTACT_FORCE_HPP

#include <BulletDynamics/Dynamics/btActionInterface.h>
#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableGravityForce.h>
#include <BulletSoftBody/btDeformableLagrangianForce.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <LinearMath/btIDebugDraw.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "raycontact/bullet/body_check.hpp"
#include "raycontact/bullet/contact_bodies.hpp"
#include "raycontact/bullet/options.hpp"

namespace raycontact::bullet {

/**
 * The contact system of the library inside Bullet's implicit solve. It detects once per sub-step. Bodies must outlive
 * it, or be removed from the world or from it first. Errors of detection, such as positions that are no longer finite,
 * come out of stepSimulation as exceptions.
 */
class ContactForce : public btDeformableLagrangianForce, public ContactBodies {
 public:
  /** Refuses options out of range. */
  explicit ContactForce(const ContactOptions& options = {}) : ContactBodies(options), reaction_(*this) {}

  ~ContactForce() override {
    if (world_ != nullptr) world_->removeAction(&reaction_);
  }

  /**
   * Call once, before bodies are added. Has the world step implicitly and with projection, and without line search:
   * contact works in no other. `world.addForce` would drop a second force of the same type without a word. The world
   * must outlive this force.
   */
  void register_with(btDeformableMultiBodyDynamicsWorld& world) {
    world.setImplicit(true);       // the contact force is stiff
    world.setUseProjection(true);  // without it nothing moves
    world.setLineSearch(false);    // together with damping it sinks bodies into floors
    // Bullet keeps its solver to itself, but hands it to each soft body that enters.
    btSoftBody visitor(&world.getWorldInfo());
    world.addSoftBody(&visitor);
    auto* solver = static_cast<btDeformableBodySolver*>(visitor.getSoftBodySolver());
    world.removeSoftBody(&visitor);
    solver->getLagrangianForceArray()->push_back(this);
    setIndices(solver->getIndices());
    solver_ = solver;
    world.addAction(&reaction_);
    world_ = &world;
  }

  /** A link of a multibody, or its base: as a rigid body, and its joints feel the reaction. */
  void add_link(btMultiBodyLinkCollider& link, const BodyOptions& options = {}) {
    add_link(link, surface_of_shape(*link.getCollisionShape()), options);
  }

  /** The same with a surface of its own. */
  void add_link(btMultiBodyLinkCollider& link, RigidSurface surface, const BodyOptions& options = {}) {
    const detail::MultibodyLink own(&link, world_);
    own.check();
    add_surface(link, std::move(surface), options, own);
  }

  /** Needed for rigid bodies and links only: soft bodies leave when they leave the world. */
  void remove_rigid_body(btCollisionObject& body) { remove(&body); }

  /** The net force of `other` on `body` in the last sub-step, in N, as the solve left it. Zero for a body and itself.
   */
  btVector3 pair_force(const btCollisionObject& body, const btCollisionObject& other) {
    finish_step();
    return force_between(body, other);
  }

  /**
   * For a solver of the host's own that takes Newton steps: to be called after each, with its result in the nodes' m_v.
   * One body that is stopped may be in the way of the next, which detection took to be moving on. Looks for contacts
   * where the bodies would end now, if that is further than the depth cap from where they were sought before, and takes
   * those of pairs that had none, or rows of less than half the area. True if there are such, or if a twentieth of all
   * force proves to be wrong then: another step is due.
   */
  bool detect_again() {
    if (!is_under_way_ || !options_.look_ahead) return false;
    const std::vector<double>& velocities = gather_velocities();
    const double cap = options_.depth_cap / double(time_step_);
    const std::array<double, 2> squares = system_.off_course(scene_, velocities);
    has_gone_elsewhere_ = has_gone_elsewhere_ || std::max(squares[0], squares[1]) > cap * cap;
    if (!has_gone_elsewhere_) return false;
    if (system_.detect_again(scene_, velocities)) return true;
    if (!(system_.misjudged(velocities) > 0.05)) return false;
    system_.linearise(velocities);
    return true;
  }

  /** @cond What Bullet calls, as it describes it. */

  void addSoftBody(btSoftBody* body) override { add_body(*body); }

  void removeSoftBody(btSoftBody* body) override {
    m_softBodies.remove(body);
    remove(body);
  }

  // Also after a soft body has left the world: detection waits for the solve.
  void reinitialize(bool) override {
    finish_step();
    is_due_ = true;
    waits_for_joints_ = note_start();
  }

  void addScaledForces(btScalar scale, TVStack& force) override {
    // Bullet asks first to see what would happen without joints and its own contacts.
    if (is_due_ && !std::exchange(waits_for_joints_, false)) begin_step();
    if (!is_under_way_) return;
    const std::vector<double>& velocities = gather_velocities();
    result_.assign(velocities.size(), 0);
    system_.add_forces(velocities, result_);
    add_result(double(scale), force);
  }

  // Of all that Bullet's scale stands for, the forces take the step's length.
  void addScaledElasticForceDifferential(btScalar, const TVStack& dx, TVStack& df) override {
    if (!is_under_way_) return;
    change_.resize(3 * index_.size());
    for (std::size_t n = 0; n < index_.size(); ++n)
      for (int axis = 0; axis < 3; ++axis) change_[3 * n + std::size_t(axis)] = double(dx[index_[n]][axis]);
    result_.assign(change_.size(), 0);
    system_.add_product(double(time_step_), change_, result_);
    add_result(1, df);
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

 protected:
  void add(ContactBody body) override {
    btSoftBody* soft = body.soft;
    if (soft != nullptr) check_body(*soft, body.options.open);
    if (world_ == nullptr)
      throw std::logic_error("no world would ask this contact force for anything; call register_with(world) first");
    ContactBodies::add(std::move(body));
    if (soft != nullptr) m_softBodies.push_back(soft);
  }

  /** @endcond */

 private:
  /** Runs when Bullet has moved everything: rigid bodies then get what the solve found for them. */
  class Reaction : public btActionInterface {
   public:
    explicit Reaction(ContactForce& force) : force_(force) {}
    void updateAction(btCollisionWorld*, btScalar) override { force_.finish_step(); }
    void debugDraw(btIDebugDraw* drawer) override {
      const auto vector = [](const double* x) { return btVector3(btScalar(x[0]), btScalar(x[1]), btScalar(x[2])); };
      for (const rayc_contact& contact : force_.contacts())
        drawer->drawContactPoint(vector(contact.p1.position), vector(contact.direction), btScalar(contact.depth), 1,
                                 btVector3(1, 1, 0));
    }

   private:
    ContactForce& force_;
  };

  void begin_step() {
    is_due_ = has_gone_elsewhere_ = false;
    time_step_ = solver_->m_objective->m_dt;
    begin(time_step_, gravity(), false, [this](const ContactBody& body) {
      return body.soft != nullptr ? is_in_world(*body.soft) : body.rigid->getBroadphaseHandle() != nullptr;
    });
    index_.clear();
    for (const btSoftBody::Node* node : nodes_) index_.push_back(node->index);
    is_under_way_ = true;
  }

  void finish_step() {
    if (!std::exchange(is_under_way_, false)) return;
    finish(time_step_);
  }

  void add_result(double scale, TVStack& to) const {
    for (std::size_t n = 0; n < index_.size(); ++n)
      for (int axis = 0; axis < 3; ++axis) to[index_[n]][axis] += btScalar(scale * result_[3 * n + std::size_t(axis)]);
  }

  bool is_in_world(const btSoftBody& body) const {
    const int index = body.m_nodes[0].index;
    return index >= 0 && index < m_nodes->size() && (*m_nodes)[index] == &body.m_nodes[0];
  }

  btVector3 gravity() const {
    const auto& forces = *solver_->getLagrangianForceArray();
    for (int i = 0; i < forces.size(); ++i)
      if (forces[i]->getForceType() == BT_GRAVITY_FORCE)
        return static_cast<btDeformableGravityForce*>(forces[i])->m_gravity;
    return {0, 0, 0};
  }

  Reaction reaction_;
  std::vector<double> change_, result_;
  std::vector<int> index_;  // Bullet's, of each unknown node
  btDeformableBodySolver* solver_ = nullptr;
  btDeformableMultiBodyDynamicsWorld* world_ = nullptr;
  btScalar time_step_ = 0;
  bool is_due_ = false, waits_for_joints_ = false, is_under_way_ = false, has_gone_elsewhere_ = false;
};

}  // namespace raycontact::bullet

#endif  // RAYCONTACT_BULLET_CONTACT_FORCE_HPP
