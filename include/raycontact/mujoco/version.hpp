// SPDX-License-Identifier: MIT OR Apache-2.0
/** Which MuJoCo this is for: the implicit metric that the adapter reads changes from version to version. */
#ifndef RAYCONTACT_MUJOCO_VERSION_HPP
#define RAYCONTACT_MUJOCO_VERSION_HPP

#include <mujoco/mujoco.h>

#include <stdexcept>
#include <string>

#include "raycontact.hpp"

#if mjVERSION_HEADER / 1000 != 4000
#error "raycontact/mujoco.hpp is for MuJoCo 4.0: build with its headers (PyPI: mujoco-core==4.0.0)"
#endif
#ifdef mjUSESINGLE
#error "raycontact/mujoco.hpp is for MuJoCo in double precision: build without mjUSESINGLE"
#endif
#ifdef RAYCONTACT_NO_EXCEPTIONS
#error "raycontact/mujoco.hpp needs exceptions; none of them passes into MuJoCo"
#endif

namespace raycontact::mujoco {

/** Throws std::runtime_error unless `version`, that of mj_version(), is one of 4.0. */
inline void check_version(int version) {
  if (version / 1000 == mjVERSION_HEADER / 1000) return;
  const auto text = [](int number) {
    return std::to_string(number / 1000000) + "." + std::to_string(number / 1000 % 1000) + "." +
           std::to_string(number % 1000);
  };
  throw std::runtime_error("raycontact was built for MuJoCo " + text(mjVERSION_HEADER) + ", and MuJoCo " +
                           text(version) + " is running; load the version that it was built for");
}

}  // namespace raycontact::mujoco

#endif  // RAYCONTACT_MUJOCO_VERSION_HPP
