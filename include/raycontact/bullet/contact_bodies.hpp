// SPDX-License-Identifier: MIT OR Apache-2.0
/** Bullet's bodies in a scene and its contact system: what both ways into Bullet share. */
#ifndef RAYCONTACT_BULLET_CONTACT_BODIES_HPP
#define RAYCONTACT_BULLET_CONTACT_BODIES_HPP

#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <LinearMath/btTransformUtil.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <stdexcept>
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
  Skin skin;             // of a soft body
  RigidSurface surface;  // of a rigid one
  BodyOptions options;
  bool is_in_scene = false;
  uint32_t number = 0;                // there
  std::array<btScalar, 5> inertia{};  // of a rigid body, as the system has it
  rayc_motion motion{};

  const btCollisionObject* object() const {
    return soft != nullptr ? static_cast<const btCollisionObject*>(soft) : rigid;
  }
  bool gives_way() const { return rigid != nullptr && !rigid->isStaticOrKinematicObject() && rigid->getInvMass() > 0; }
};

/** The unknowns are the nodes of all soft bodies that take part, in the order in which the bodies were added. */
class ContactBodies {
 public:
  explicit ContactBodies(const ContactOptions& options)
      : options_(checked(options)), scene_(options.threads), system_(system_options()) {
    require_library_of_same_precision();
    rayc_detection_options detection = default_detection_options();
    detection.law = options.law;
    detection.sampling = options.sampling;
    detection.sampling_value = options.sampling_value;
    detection.edges = options.edges ? 1 : 0;
    detection.escape = options.escape ? 1 : 0;
    scene_.set_detection_options(detection);
  }

  void add(ContactBody body) {
    if (find(body.object()) != bodies_.end())
      throw std::invalid_argument("this body has been added already; remove it first");
    if (body.soft != nullptr) check_skin(*body.soft, body.skin);
    mesh_of(body);  // refuses what is no surface
    bodies_.push_back(std::move(body));
    has_changed_ = true;
  }

  void remove(const btCollisionObject* object) {
    const auto gone = find(object);
    if (gone == bodies_.end()) return;
    if (gone->is_in_scene) leave(*gone);
    bodies_.erase(gone);
    const auto is_of = [&](const PairMaterial& pair) { return pair.first == object || pair.second == object; };
    materials_.erase(std::remove_if(materials_.begin(), materials_.end(), is_of), materials_.end());
    contacts_.clear();
    has_news_ = false;
    has_changed_ = true;
  }

  void add_half_space(const HalfSpace& half_space) {
    check_half_space(half_space);
    half_spaces_.push_back(half_space);
    has_changed_ = true;
  }

  void set_material(const btCollisionObject& a, const btCollisionObject& b, const rayc_material& material) {
    index_of(a), index_of(b);  // refuses what was not added
    materials_.push_back({&a, &b, material});
    has_changed_ = true;
  }

  /** Before anything in a step has changed the velocities of rigid bodies. */
  void note_start() {
    for (ContactBody& body : bodies_)
      if (body.rigid != nullptr) copy_velocity(*body.rigid, body.motion.velocity);
  }

  /**
   * Begins a step of the bodies for which `takes_part(body)` holds. Without contact, soft bodies would go on with their
   * velocities and what gravity adds, rigid ones with the velocities that they have now. `has_moved`: bodies are where
   * that takes them.
   */
  template <class TakesPart>
  void begin(btScalar dt, const btVector3& gravity, bool has_moved, TakesPart takes_part) {
    const auto start = std::chrono::steady_clock::now();
    system_.cancel();
    renew(takes_part);
    const double back = has_moved ? double(dt) : 0;
    free_.resize(velocities_.size());
    positions_.resize(velocities_.size());
    std::size_t k = 0;
    for (const ContactBody& body : bodies_) {
      if (!body.is_in_scene || body.soft == nullptr) continue;
      const btVector3 gained = dt * body.soft->m_gravityFactor * gravity;
      for (int n = 0; n < body.soft->m_nodes.size(); ++n)
        for (int axis = 0; axis < 3; ++axis, ++k) {
          const btSoftBody::Node& node = body.soft->m_nodes[n];
          velocities_[k] = node.m_im > 0 ? double(node.m_v[axis]) : 0;
          free_[k] = velocities_[k] + (node.m_im > 0 ? double(gained[axis]) : 0);
          positions_[k] = double(node.m_x[axis]) - back * velocities_[k];
        }
    }
    for (ContactBody& body : bodies_) {
      if (!body.is_in_scene || body.rigid == nullptr) continue;
      renew_motion(body, btScalar(back));
      system_.set_motion(body.number, body.motion);
    }
    system_.begin(scene_, double(dt), positions_, velocities_, free_);
    has_news_ = true;
    wake_touched();
    begin_ms_ = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  }

  /** Ends it with the velocities in the nodes. Rigid bodies get theirs, and are moved by what these differ. */
  void finish(btScalar dt) {
    system_.finish(gather_velocities());
    for (ContactBody& body : bodies_) {
      if (!body.is_in_scene || !body.gives_way()) continue;
      const std::array<double, 6> end = system_.rigid_velocity(body.number);
      btVector3 change[2];
      for (int k = 0; k < 6; ++k) change[k / 3][k % 3] = btScalar(end[std::size_t(k)] - body.motion.free_velocity[k]);
      if (change[0].isZero() && change[1].isZero()) continue;
      body.rigid->setLinearVelocity(body.rigid->getLinearVelocity() + change[0]);
      body.rigid->setAngularVelocity(body.rigid->getAngularVelocity() + change[1]);
      btTransform moved;
      btTransformUtil::integrateTransform(body.rigid->getWorldTransform(), change[0], change[1], dt, moved);
      body.rigid->proceedToTransform(moved);
    }
  }

  const std::vector<double>& gather_velocities() {
    for (std::size_t n = 0; n < nodes_.size(); ++n)
      for (std::size_t axis = 0; axis < 3; ++axis)
        velocities_[3 * n + axis] = double(nodes_[n]->m_v[int(axis)]);
    return velocities_;
  }

  /** `colliding` and `collided` count bodies in the order in which they were added. */
  const std::vector<rayc_contact>& contacts() {
    if (!has_news_) return contacts_;
    has_news_ = false;
    system_.copy_contacts_to(found_);
    found_.copy_to(contacts_);
    for (rayc_contact& contact : contacts_)
      for (uint32_t* number : {&contact.colliding, &contact.collided})
        *number = static_cast<uint32_t>(index_of_number_[*number]);
    return contacts_;
  }

  rayc_statistics statistics() {
    contacts();
    return found_.statistics();
  }

  /** The force of `b` on `a` in the last step that was finished. */
  btVector3 pair_force(const btCollisionObject& a, const btCollisionObject& b) const {
    const ContactBody &one = bodies_[index_of(a)], &other = bodies_[index_of(b)];
    if (!one.is_in_scene || !other.is_in_scene || has_changed_) return btVector3(0, 0, 0);
    const std::array<double, 3> force = system_.pair_force(one.number, other.number);
    return btVector3(btScalar(force[0]), btScalar(force[1]), btScalar(force[2]));
  }

  ContactSystem& system() { return system_; }
  Scene& scene() { return scene_; }
  const std::vector<btSoftBody::Node*>& nodes() const { return nodes_; }
  const std::vector<double>& masses() const { return masses_; }
  double begin_ms() const { return begin_ms_; }

 private:
  struct PairMaterial {
    const btCollisionObject *first, *second;
    rayc_material material;
  };

  static const ContactOptions& checked(const ContactOptions& options) {
    check_options(options);
    return options;
  }

  rayc_contact_system_options system_options() const {
    rayc_contact_system_options options = default_contact_system_options();
    options.look_ahead = options_.look_ahead ? 1 : 0;
    options.weighting = options_.weighting;
    return options;
  }

  rayc_material material(double stiffness) const {
    rayc_material material{};
    material.struct_size = sizeof material;
    material.stiffness = stiffness;
    material.damping_time = options_.damping_time;
    material.friction = options_.friction;
    material.depth_cap = options_.depth_cap;
    return material;
  }

  std::vector<ContactBody>::iterator find(const btCollisionObject* object) {
    return std::find_if(bodies_.begin(), bodies_.end(), [&](const ContactBody& b) { return b.object() == object; });
  }

  std::size_t index_of(const btCollisionObject& object) const {
    for (std::size_t i = 0; i < bodies_.size(); ++i)
      if (bodies_[i].object() == &object) return i;
    throw std::invalid_argument("this body was not added, or has been removed");
  }

  static Mesh mesh_of(const ContactBody& body) {
    if (body.soft != nullptr) {
      std::vector<btScalar> positions;
      skin_positions(*body.soft, body.skin, positions);
      return Mesh(vectors(positions), body.skin.triangles);
    }
    raycontact::detail::check_threes(body.surface.triangles.size(), "surface.triangles", "triangle");
    rayc_mesh_options options = default_mesh_options();
    try {
      return Mesh(vectors(body.surface.points), body.surface.triangles, options);
    } catch (const Error& error) {
      // A triangle mesh may be a piece of terrain; a moving one must be closed to have an inside.
      if (error.status() != RAYC_STATUS_MESH_OPEN || !body.rigid->isStaticOrKinematicObject()) throw;
      options.open = 1;
      return Mesh(vectors(body.surface.points), body.surface.triangles, options);
    }
  }

  /** Its inverse mass and inertia, and whether anything moves it. */
  static std::array<btScalar, 5> inertia_of(const ContactBody& body) {
    const btVector3& inertia = body.rigid->getInvInertiaDiagLocal();
    return {{body.rigid->getInvMass(), inertia.x(), inertia.y(), inertia.z(), btScalar(body.gives_way() ? 1 : 0)}};
  }

  void leave(ContactBody& body) {
    body.is_in_scene = false;
    has_changed_ = true;
    scene_.remove(body.number);
    scene_.release_body_numbers();
  }

  /** Who takes part, and what they weigh. */
  template <class TakesPart>
  void renew(TakesPart takes_part) {
    for (ContactBody& body : bodies_) {
      const bool is_in = takes_part(body);
      if (body.is_in_scene && !is_in) leave(body);
      const bool is_new = is_in && !body.is_in_scene;
      has_changed_ = has_changed_ || is_new || (is_in && body.rigid != nullptr && inertia_of(body) != body.inertia);
      if (is_new) body.number = scene_.add(mesh_of(body));
      body.is_in_scene = is_in;
    }
    const std::size_t node_count = nodes_.size();
    nodes_.clear();
    masses_.clear();
    for (const ContactBody& body : bodies_) {
      if (!body.is_in_scene || body.soft == nullptr) continue;
      for (int n = 0; n < body.soft->m_nodes.size(); ++n) {
        btSoftBody::Node& node = body.soft->m_nodes[n];
        nodes_.push_back(&node);
        masses_.push_back(node.m_im > 0 ? 1 / double(node.m_im) : std::numeric_limits<double>::infinity());
      }
    }
    if (has_changed_ || nodes_.size() != node_count) make_system();
    if (masses_ != known_masses_) system_.set_node_masses(known_masses_ = masses_);
  }

  void make_system() {
    velocities_.resize(3 * nodes_.size());
    system_ = ContactSystem(system_options());
    system_.set_node_masses(known_masses_ = masses_);
    for (const HalfSpace& half_space : half_spaces_) {
      const btVector3& n = half_space.normal;
      // Rigid bodies pass: they are the host's own business.
      system_.add_half_space({double(n.x()), double(n.y()), double(n.z())}, double(half_space.offset), material(0));
    }
    uint32_t first_node = 0;
    index_of_number_.clear();
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      ContactBody& body = bodies_[i];
      if (!body.is_in_scene) continue;
      if (body.number >= index_of_number_.size()) index_of_number_.resize(body.number + 1);
      index_of_number_[body.number] = i;
      if (body.soft != nullptr)
        add_soft(body, first_node);
      else
        add_rigid(body);
      for (const ContactBody& other : bodies_)
        if (&other != &body && other.is_in_scene)
          scene_.set_pair_collision(body.number, other.number, may_touch(body, other));
    }
    for (const PairMaterial& pair : materials_) {
      const ContactBody &one = bodies_[index_of(*pair.first)], &other = bodies_[index_of(*pair.second)];
      if (one.is_in_scene && other.is_in_scene) system_.set_pair_material(one.number, other.number, &pair.material);
    }
    has_changed_ = false;
  }

  // Two rigid bodies are the host's own business.
  static bool may_touch(const ContactBody& a, const ContactBody& b) {
    return (a.soft != nullptr || b.soft != nullptr) && (a.options.group & b.options.mask) != 0 &&
           (b.options.group & a.options.mask) != 0;
  }

  void add_soft(const ContactBody& body, uint32_t& first_node) {
    std::vector<uint32_t> offsets(1), nodes;
    std::vector<double> weights;
    for (const SkinPoint& point : body.skin.points) {
      for (std::size_t k = 0; k < 4; ++k) {
        if (point.weights[k] == 0) continue;
        nodes.push_back(static_cast<uint32_t>(point.nodes[k]));
        weights.push_back(point.weights[k]);
      }
      offsets.push_back(static_cast<uint32_t>(nodes.size()));
    }
    const auto node_count = static_cast<uint32_t>(body.soft->m_nodes.size());
    // Two of it in series are the contact's.
    system_.add_deformable(scene_, body.number, first_node, node_count, Carriers{offsets, nodes, weights},
                           material(2 * options_.stiffness));
    first_node += node_count;
    scene_.set_self_collision(body.number, body.options.self_collision);
    for (uint32_t h = 0; h < half_spaces_.size(); ++h) {
      const rayc_material floor = material(double(half_spaces_[h].stiffness));
      system_.set_half_space_material(body.number, h, &floor);
    }
  }

  void add_rigid(ContactBody& body) {
    body.inertia = inertia_of(body);
    if (!body.gives_way()) {
      system_.add_moved(scene_, body.number, material(2 * options_.stiffness));
      return;
    }
    const double mass = 1 / double(body.inertia[0]);
    double square = 0;
    for (const btVector3& point : body.surface.points) square = std::max(square, double(point.length2()));
    std::array<double, 9> inertia{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double inverse = double(body.inertia[axis + 1]);
      // Bullet's zero stands for an axis about which nothing turns the body.
      inertia[4 * axis] = inverse > 0 ? 1 / inverse : 1e9 * mass * square;
    }
    system_.add_rigid(scene_, body.number, mass, inertia, material(2 * options_.stiffness));
  }

  static void copy_velocity(const btRigidBody& body, double* velocity) {
    for (int axis = 0; axis < 3; ++axis) {
      velocity[axis] = double(body.getLinearVelocity()[axis]);
      velocity[axis + 3] = double(body.getAngularVelocity()[axis]);
    }
  }

  static void renew_motion(ContactBody& body, btScalar back) {
    copy_velocity(*body.rigid, body.motion.free_velocity);
    btTransform place = body.rigid->getWorldTransform();
    if (back > 0)
      btTransformUtil::integrateTransform(body.rigid->getWorldTransform(), body.rigid->getLinearVelocity(),
                                          body.rigid->getAngularVelocity(), -back, place);
    for (int row = 0; row < 3; ++row) {
      body.motion.position[row] = double(place.getOrigin()[row]);
      for (int column = 0; column < 3; ++column) body.motion.rotation[row][column] = double(place.getBasis()[row][column]);
    }
  }

  void wake_touched() {
    const bool all_awake = std::all_of(bodies_.begin(), bodies_.end(),
                                       [](const ContactBody& b) { return !b.gives_way() || b.rigid->isActive(); });
    if (all_awake) return;
    for (const rayc_contact& contact : contacts())
      for (uint32_t index : {contact.colliding, contact.collided})
        if (bodies_[index].gives_way()) bodies_[index].rigid->activate();
  }

  ContactOptions options_;
  Scene scene_;
  ContactSystem system_;
  std::vector<ContactBody> bodies_;
  std::vector<HalfSpace> half_spaces_;
  std::vector<PairMaterial> materials_;
  std::vector<btSoftBody::Node*> nodes_;
  std::vector<double> masses_, known_masses_, positions_, velocities_, free_;
  std::vector<std::size_t> index_of_number_;
  Contacts found_;
  std::vector<rayc_contact> contacts_;
  bool has_changed_ = true, has_news_ = false;
  double begin_ms_ = 0;
};

}  // namespace raycontact::bullet::detail

#endif  // RAYCONTACT_BULLET_CONTACT_BODIES_HPP
