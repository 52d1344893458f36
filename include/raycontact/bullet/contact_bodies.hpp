// SPDX-License-Identifier: MIT OR Apache-2.0
/** Bullet's bodies in a scene and its contact system: what both ways into Bullet share. */
#ifndef RAYCONTACT_BULLET_CONTACT_BODIES_HPP
#define RAYCONTACT_BULLET_CONTACT_BODIES_HPP

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "raycontact.hpp"
#include "raycontact/bullet/contact_body.hpp"
#include "raycontact/bullet/options.hpp"

namespace raycontact::bullet {

/**
 * Which bodies touch, and what of: the same for both of Bullet's soft body worlds. Rigid bodies pass each other and
 * half-spaces; that is the world's own contact.
 */
class ContactBodies {
 public:
  virtual ~ContactBodies() = default;
  ContactBodies(const ContactBodies&) = delete;
  ContactBodies& operator=(const ContactBodies&) = delete;

  /** The body's own faces are its collision surface. */
  void add_body(btSoftBody& body, const BodyOptions& options = {}) { add_body(body, skin_from_faces(body), options); }

  /** A finer surface carried by the body's nodes. */
  void add_body(btSoftBody& body, Skin skin, const BodyOptions& options = {}) {
    check_skin(skin, body.m_nodes.size());
    add({&body, nullptr, std::move(skin), {}, options});
  }

  /** Soft bodies collide with the surface of the body's shape; see surface_of_shape. */
  void add_rigid_body(btRigidBody& body, const BodyOptions& options = {}) {
    add_rigid_body(body, surface_of_shape(*body.getCollisionShape()), options);
  }

  /** The same with a surface of its own. Open surfaces (terrain) are taken for bodies that no force moves. */
  void add_rigid_body(btRigidBody& body, RigidSurface surface, const BodyOptions& options = {}) {
    add_surface(body, std::move(surface), options);
  }

  /** Refuses a normal that is no unit vector, and a negative stiffness. */
  void add_half_space(const HalfSpace& half_space) {
    check_half_space(half_space);
    half_spaces_.push_back(half_space);
    has_changed_ = true;
  }

  /** What contacts of two bodies, or of one with itself, are made of, in place of what the options say. */
  void set_pair_material(const btCollisionObject& a, const btCollisionObject& b, const rayc_material& material) {
    index_of(a), index_of(b);  // refuses what was not added
    if (material.restitution > 0)
      throw std::invalid_argument("material of a pair: its restitution is " + std::to_string(material.restitution) +
                                  "; a soft body bounces by its own elasticity alone, so leave it 0, and give the pair "
                                  "a damping_time of 0 for more of that");
    ContactSystem(system_options()).add_half_space({0, 0, 1}, 0, material);  // refuses what is no material
    materials_.push_back({&a, &b, material});
    has_changed_ = true;
  }

  /** Contacts of the last detection; of those, only what ends up pushing bears any load. */
  std::size_t contact_count() const { return contacts().size(); }

  /** They themselves; `colliding` and `collided` count bodies in the order of `add_...`. Until the next step. */
  const std::vector<rayc_contact>& contacts() const {
    if (!has_news_) return contacts_;
    has_news_ = false;
    system_.copy_contacts_to(found_);
    found_.copy_to(contacts_);
    for (rayc_contact& contact : contacts_)
      for (uint32_t* number : {&contact.colliding, &contact.collided})
        *number = static_cast<uint32_t>(index_of_number_[*number]);
    return contacts_;
  }

  /** What the last detection did: rays, misses, pairs that escape. */
  rayc_statistics statistics() const {
    contacts();
    return found_.statistics();
  }

  /** Positions of the skins, search structures, rays, and what the solve needs of the contacts. */
  double last_detection_ms() const { return begin_ms_; }

  /// @cond internal
 protected:
  using ContactBody = detail::ContactBody;

  /** Refuses options out of range. */
  explicit ContactBodies(const ContactOptions& options)
      : options_(checked(options)), scene_(options.threads), system_(system_options()) {
    detail::require_library_of_same_precision();
    rayc_detection_options detection = default_detection_options();
    detection.law = options.law;
    detection.sampling = options.sampling;
    detection.sampling_value = options.sampling_value;
    detection.edges = options.edges ? 1 : 0;
    detection.escape = options.escape ? 1 : 0;
    scene_.set_detection_options(detection);
  }

  void add_surface(btCollisionObject& object, RigidSurface surface, const BodyOptions& options,
                   const detail::MultibodyLink& link = detail::MultibodyLink()) {
    raycontact::detail::check_threes(surface.triangles.size(), "surface.triangles", "triangle");
    ContactBody body{nullptr, &object, {}, std::move(surface), options};
    body.link = link;
    add(std::move(body));
  }

  virtual void add(ContactBody body) {
    if (find(body.object()) != bodies_.end())
      throw std::invalid_argument("this body has been added already; remove it first");
    body.mesh();  // refuses what is no surface
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

  /** Before anything in a step has changed the velocities of rigid bodies. Whether some of these are links. */
  bool note_start() {
    bool has_links = false;
    for (ContactBody& body : bodies_) {
      if (body.rigid != nullptr) body.note_start();
      has_links = has_links || body.link;
    }
    return has_links;
  }

  /**
   * Begins a step of the bodies for which `takes_part(body)` holds. Without contact, soft bodies would go on with their
   * velocities and, as far as they fall, what gravity adds, rigid ones with the velocities that they have now.
   * `has_moved`: bodies are where that takes them.
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
    for (ContactBody& body : bodies_) {
      if (!body.is_in_scene || body.soft == nullptr) continue;
      btVector3 gained = dt * body.soft->m_gravityFactor * gravity;
      gained *= body.falling_part(gained);
      for (int n = 0; n < body.soft->m_nodes.size(); ++n)
        for (int axis = 0; axis < 3; ++axis, ++k) {
          const btSoftBody::Node& node = body.soft->m_nodes[n];
          velocities_[k] = node.m_im > 0 ? double(node.m_v[axis]) : 0;
          free_[k] = velocities_[k] + (node.m_im > 0 ? double(gained[axis]) : 0);
          positions_[k] = double(node.m_x[axis]) - back * velocities_[k];
        }
    }
    add_inertia_of_joints();
    for (ContactBody& body : bodies_) {
      if (!body.is_in_scene || body.rigid == nullptr) continue;
      body.renew_motion(btScalar(back));
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
    for (ContactBody& body : bodies_)
      if (body.is_in_scene && body.gives_way()) body.follow(system_.rigid_velocity(body.number), dt);
  }

  const std::vector<double>& gather_velocities() {
    for (std::size_t n = 0; n < nodes_.size(); ++n)
      for (std::size_t axis = 0; axis < 3; ++axis) velocities_[3 * n + axis] = double(nodes_[n]->m_v[int(axis)]);
    return velocities_;
  }

  /** The force of `b` on `a` in the last step that was finished. */
  btVector3 force_between(const btCollisionObject& a, const btCollisionObject& b) const {
    const ContactBody &one = bodies_[index_of(a)], &other = bodies_[index_of(b)];
    if (!one.is_in_scene || !other.is_in_scene || has_changed_) return btVector3(0, 0, 0);
    const std::array<double, 3> force = system_.pair_force(one.number, other.number);
    return btVector3(btScalar(force[0]), btScalar(force[1]), btScalar(force[2]));
  }

  ContactOptions options_;
  Scene scene_;
  ContactSystem system_;
  std::vector<btSoftBody::Node*> nodes_;  // whose velocities are the unknowns
  std::vector<double> masses_;

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

  void leave(ContactBody& body) {
    body.leave_scene();
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
      has_changed_ = has_changed_ || is_new || (is_in && body.rigid != nullptr && body.inertia_now() != body.inertia);
      if (is_new) body.number = scene_.add(body.mesh());
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
          scene_.set_pair_collision(body.number, other.number, body.may_touch(other));
    }
    for (const PairMaterial& pair : materials_) {
      const ContactBody &one = bodies_[index_of(*pair.first)], &other = bodies_[index_of(*pair.second)];
      if (one.is_in_scene && other.is_in_scene) system_.set_pair_material(one.number, other.number, &pair.material);
    }
    has_changed_ = false;
  }

  void add_soft(const ContactBody& body, uint32_t& first_node) {
    const auto node_count = static_cast<uint32_t>(body.soft->m_nodes.size());
    // Two of it in series are the contact's.
    system_.add_deformable(scene_, body.number, first_node, node_count, SkinCarriers(body.skin),
                           material(2 * options_.stiffness));
    first_node += node_count;
    scene_.set_self_collision(body.number, body.options.self_collision);
    for (uint32_t h = 0; h < half_spaces_.size(); ++h) {
      const rayc_material floor = material(double(half_spaces_[h].stiffness));
      system_.set_half_space_material(body.number, h, &floor);
    }
  }

  void add_rigid(ContactBody& body) {
    body.inertia = body.inertia_now();
    if (!body.gives_way()) {
      system_.add_moved(scene_, body.number, material(2 * options_.stiffness));
      return;
    }
    system_.add_rigid(scene_, body.number, 1 / double(body.inertia[0]), body.inertia_matrix(),
                      material(2 * options_.stiffness));
  }

  void add_inertia_of_joints() {
    const auto is_pushed = [](const ContactBody& body) { return body.is_in_scene && body.link && body.gives_way(); };
    for (ContactBody& body : bodies_)
      if (is_pushed(body)) body.link.find_response();
    for (ContactBody& body : bodies_) {
      if (!is_pushed(body)) continue;
      const auto moves = [&](const ContactBody& other) { return is_pushed(other) && body.link.moves(other.link); };
      const auto count = static_cast<std::size_t>(std::count_if(bodies_.begin(), bodies_.end(), moves));
      body.articulated = body.link.articulated_inertia(std::max(count, std::size_t{1}));
      detail::Matrix6 added = body.articulated;
      for (std::size_t k = 0; k < 6; ++k) added[k][k] -= body.link.own_inertia()[k];
      system_.set_added_inertia(body.number, added);
    }
  }

  // What is touched stays awake; what sleeps does so until it is touched.
  void wake_touched() {
    const auto may_sleep = [](const ContactBody& body) {
      return body.gives_way() && body.rigid->getActivationState() != DISABLE_DEACTIVATION;
    };
    if (std::none_of(bodies_.begin(), bodies_.end(), may_sleep)) return;
    for (const rayc_contact& contact : contacts())
      for (const uint32_t index : {contact.colliding, contact.collided})
        if (may_sleep(bodies_[index])) bodies_[index].wake();
  }

  std::vector<ContactBody> bodies_;
  std::vector<HalfSpace> half_spaces_;
  std::vector<PairMaterial> materials_;
  std::vector<double> known_masses_, positions_, velocities_, free_;
  std::vector<std::size_t> index_of_number_;
  mutable Contacts found_;
  mutable std::vector<rayc_contact> contacts_;
  mutable bool has_news_ = false;  // contacts that have not been copied
  bool has_changed_ = true;        // what the system knows of
  double begin_ms_ = 0;
  /// @endcond
};

}  // namespace raycontact::bullet

#endif  // RAYCONTACT_BULLET_CONTACT_BODIES_HPP
