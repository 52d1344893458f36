// SPDX-License-Identifier: MIT OR Apache-2.0
/**
 * @file
 * raycontact for C++17: move-only owners of the handles in raycontact.h, views of the caller's arrays, errors as
 * exceptions or, with RAYCONTACT_NO_EXCEPTIONS, as results.
 *
 * Header-only. `get()` gives the C handle, so that everything in raycontact.h stays within reach.
 */
#ifndef RAYCONTACT_HPP
#define RAYCONTACT_HPP

#include "raycontact/contact_system.hpp"
#include "raycontact/contacts.hpp"
#include "raycontact/mesh.hpp"
#include "raycontact/result.hpp"
#include "raycontact/scene.hpp"
#include "raycontact/span.hpp"

#endif  // RAYCONTACT_HPP
