// SPDX-License-Identifier: MIT OR Apache-2.0
/** The engine plugin: a shared library that registers itself when MuJoCo loads it. */
#include "raycontact/mujoco.hpp"

mjPLUGIN_LIB_INIT(raycontact_flex_contact) { raycontact::mujoco::register_plugin(); }
