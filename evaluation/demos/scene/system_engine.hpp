// SPDX-License-Identifier: MIT OR Apache-2.0
/** The scenes in an engine that needs no Bullet: corotated tetrahedra on the library's contact system. */
#ifndef RAYCONTACT_DEMOS_SCENE_SYSTEM_ENGINE_HPP
#define RAYCONTACT_DEMOS_SCENE_SYSTEM_ENGINE_HPP

#include <memory>

#include "engine.hpp"

namespace demo {

std::unique_ptr<Engine> make_system_engine(const Scene& scene, const Setting& setting);

}  // namespace demo

#endif  // RAYCONTACT_DEMOS_SCENE_SYSTEM_ENGINE_HPP
