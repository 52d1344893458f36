// SPDX-License-Identifier: MIT OR Apache-2.0
/** One unilateral spring, and how it pushes and rubs. */
#ifndef RAYCONTACT_BULLET_CONTACT_ROW_HPP
#define RAYCONTACT_BULLET_CONTACT_ROW_HPP

#include <algorithm>
#include <cstddef>

#include "raycontact/bullet/precision.hpp"
#include "raycontact/bullet/rigid_coupling.hpp"

namespace raycontact::bullet::detail {

/** What friction holds on to. */
struct Hold {
  std::size_t number;  // among the holds of this step
  bool is_old;         // from the step before
  btVector3 offset;    // of an old one: from the contact's point to it, where detection had both
};

/** How the rows of one step push. */
struct RowLaw {
  btScalar damping_time, depth_cap, friction;
  bool isotropic, look_ahead;
};

/**
 * One contact. Its motion is u = sum of weight * velocity over its nodes, and the velocity of a rigid body where one
 * takes part; the force on a node is -weight * pull, pull = push * direction + friction. Within a step everything is
 * linear in the change of u: pull + D du, D = normal part along the direction, tangential part across it.
 */
struct ContactRow {
  btVector3 direction;
  btScalar depth;
  btScalar stiffness;
  int first, second;  // bodies
  RigidPoint point;
  btVector3 motion, free;  // u of the nodes: at the update, and if nothing more stopped them
  btVector3 pull;
  btVector3 kept_offset;        // as Hold::offset, from now on
  btVector3 sliding;            // at the start of the step
  btScalar push;                // predicted
  btScalar normal, tangential;  // D
  bool pushes, holds, is_dragged;
  Hold hold;
  std::size_t pass;
  std::size_t end;  // its entries run from the end of the row before

  bool is_between(int a, int b) const {
    return stiffness > 0 && ((first == a && second == b) || (first == b && second == a));
  }

  btVector3 across(const btVector3& u) const { return u - direction.dot(u) * direction; }

  btVector3 stiffened(const btVector3& u) const {
    return tangential * u + ((normal - tangential) * direction.dot(u)) * direction;
  }

  /**
   * `deepening`: motion within the step that detection did not know of, m; `along`: u along the direction, m/s, if
   * nothing stopped it; `is_loaded`: whether the pair bore anything in the step before.
   */
  void set_push(btScalar deepening, btScalar along, btScalar time_step, const RowLaw& law, bool is_loaded) {
    // The cap is for what there was at the start of the step: what bodies at rest fall within it must be met in full.
    const btScalar closing = time_step * std::max(btScalar(0), along);
    const btScalar most = law.look_ahead ? law.depth_cap + closing : std::max(law.depth_cap, closing);
    const btScalar asked = std::min(depth, most) + deepening;
    btScalar damping_time = law.damping_time;
    push = stiffness * (asked + damping_time * along);
    pushes = push > 0;
    // What rests on a body that its own support holds up seems to be left by it: no reason to let go. Such a row says
    // nothing yet, and pushes if the solve brings the two together.
    if (!pushes && asked > 0 && stiffness > 0 && is_loaded) {
      damping_time = -asked / along;
      push = 0;
      pushes = true;
    }
    normal = stiffness * (time_step + damping_time);
    tangential = law.isotropic ? stiffness * time_step : 0;
  }

  /**
   * Coulomb's force: a spring from the anchor, as stiff as the contact, which is held within the step. Where it would
   * bear more than friction allows at the speed the bodies have, the spring is softer, and the anchor is dragged along.
   * `load(push)`: how much of a predicted push will be borne; `lost()`: by how much friction slows the pair in a step.
   */
  template <class Load, class Lost>
  void set_pull(btScalar time_step, const RowLaw& law, Load load, Lost lost) {
    const btVector3 free_sliding = pull;
    pull = push * direction;
    if (!(law.friction > 0)) return;
    const btScalar most = law.friction * load(std::max(btScalar(0), push));
    const btVector3 ahead = law.look_ahead ? time_step * free_sliding : btVector3(0, 0, 0);
    btVector3 stretch = hold.is_old ? across(hold.offset) - ahead : btVector3(0, 0, 0);
    const btScalar stretched = stiffness * stretch.length();
    is_dragged = !hold.is_old || stretched > most;
    if (stretched > most) stretch *= most / stretched;
    const btScalar time = time_step + law.damping_time;
    btScalar expected = (stretch + time * sliding).length();
    // One that begins to slide is as fast at the end of the step as friction alone leaves it.
    if (stretched >= most)
      expected = std::max(expected, stretch.length() + time * (free_sliding.length() - law.friction * lost()));
    const btScalar softer = stiffness * expected > most ? most / expected : stiffness;
    pull += softer * (stretch + time * free_sliding);
    tangential += softer * time;
    kept_offset = stretch + ahead;
  }
};

}  // namespace raycontact::bullet::detail

#endif  // RAYCONTACT_BULLET_CONTACT_ROW_HPP
