/**
 * @file
 * raycontact: contact between deformable bodies, found by tracing rays. Includes all headers of raycontact/ that one process
 * needs; raycontact/distributed.h is for several that simulate one world together. raycontact/base.h says what holds for all
 * calls.
 *
 * To start with, in the order of a simulation:
 *
 * - mesh.h: rayc_mesh_create(), rayc_mesh_create_from_obj(), rayc_mesh_destroy()
 * - scene.h: rayc_scene_create(), rayc_default_scene_options(), rayc_scene_add_mesh(), rayc_scene_remove_body(),
 *   rayc_scene_set_self_collision(), rayc_scene_destroy(); each step rayc_scene_set_positions() for each body that moved, or
 *   rayc_scene_set_pose() where it keeps its shape; rayc_scene_advance() at its end
 * - contacts.h: rayc_contacts_create(), rayc_scene_query(), rayc_contacts_count(), rayc_contacts_copy(),
 *   rayc_default_response_options(), rayc_contacts_add_forces(), rayc_contacts_add_wrenches(),
 *   rayc_contacts_add_differential(), rayc_contacts_energy(), rayc_contacts_statistics(), rayc_default_detection_options(), rayc_scene_set_detection_options(), rayc_contacts_destroy()
 * - base.h: rayc_last_error_message(), rayc_status_name(), rayc_version()
 *
 * Beyond that, contact_system.h has friction, rigid bodies and cages, queries.h rays and nearest points, and state.h what to
 * save.
 */

#ifndef RAYCONTACT_H
#define RAYCONTACT_H

#include "raycontact/base.h"
#include "raycontact/mesh.h"
#include "raycontact/scene.h"
#include "raycontact/contacts.h"
#include "raycontact/contact_system.h"
#include "raycontact/queries.h"
#include "raycontact/state.h"

#endif /* RAYCONTACT_H */
