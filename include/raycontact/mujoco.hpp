// SPDX-License-Identifier: MIT OR Apache-2.0
/**
 * raycontact for MuJoCo 4.0: contact between flexes, MuJoCo's deformable bodies, as an implicit passive force.
 *
 * Header-only. Include this one file; the parts below `mujoco/` are its chapters. In short:
 *
 *     mjModel* m = mj_loadXML("scene.xml", nullptr, error, sizeof error);  // flexes have contype="0"
 *     mjData* d = mj_makeData(m);
 *     raycontact::mujoco::AttachedContact contact(m, d);    // as long as it lives, mj_step(m, d) has contact of flexes
 *
 * Contact of flexes with rigid geoms stays MuJoCo's own. evaluation/demos/mujoco/plugin.cpp makes an engine plugin of it, which an
 * XML model switches on without code. docs/mujoco.md is the manual.
 */
#ifndef RAYCONTACT_MUJOCO_HPP
#define RAYCONTACT_MUJOCO_HPP

#include "raycontact.hpp"
#include "raycontact/mujoco/callback.hpp"
#include "raycontact/mujoco/flex_contact.hpp"
#include "raycontact/mujoco/plugin.hpp"

#endif  // RAYCONTACT_MUJOCO_HPP
