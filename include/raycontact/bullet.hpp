// SPDX-License-Identifier: MIT OR Apache-2.0
/**
 * raycontact for Bullet: contact between deformable bodies as an implicit force.
 *
 * Header-only, for the float and the double build of Bullet. Include this one file; the parts below `bullet/` are
 * its chapters. In short:
 *
 *     raycontact::bullet::ContactForce contact(options);       // ContactOptions::elastic(E, nu, h), friction
 *     contact.register_with(world);                            // instead of world.addForce
 *     contact.add_body(*soft_body);                            // its own faces are the collision surface, or
 *     contact.add_body(*cage_body, skin);                      // a fine skin carried by a coarse cage, or
 *     contact.add_body(*body, skin_from_render_mesh(*body));   // Bullet's own render mesh
 *     contact.add_rigid_body(*rigid_body);                     // static or moving; reacts
 *     contact.add_link(*link_collider);                        // of a multibody, whose joints react
 *
 * and step the btDeformableMultiBodyDynamicsWorld. For Bullet's classic soft bodies: ClassicContact. For bodies that
 * roll over: CorotatedElasticity in place of Bullet's.
 */
#ifndef RAYCONTACT_BULLET_HPP
#define RAYCONTACT_BULLET_HPP

#include "raycontact.hpp"
#include "raycontact/bullet/classic_contact.hpp"
#include "raycontact/bullet/contact_force.hpp"
#include "raycontact/bullet/corotated_elasticity.hpp"
#include "raycontact/bullet/soft_body.hpp"

#endif  // RAYCONTACT_BULLET_HPP
