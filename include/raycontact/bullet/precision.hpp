// SPDX-License-Identifier: MIT OR Apache-2.0
/** Refuses a mixture of Bullet's float and double builds: such programs link, run and give nonsense. */
#ifndef RAYCONTACT_BULLET_PRECISION_HPP
#define RAYCONTACT_BULLET_PRECISION_HPP

#include <BulletSoftBody/btSoftBody.h>
#include <LinearMath/btScalar.h>

#include <type_traits>

// A build system that knows which library it links says so with RAYCONTACT_BULLET_PRECISION=32 or =64.
#if defined(RAYCONTACT_BULLET_PRECISION) && RAYCONTACT_BULLET_PRECISION == 64 && !defined(BT_USE_DOUBLE_PRECISION)
#error \
    "The double build of Bullet is linked but BT_USE_DOUBLE_PRECISION is not defined: compile with `pkg-config --cflags bullet-float64`."
#endif
#if defined(RAYCONTACT_BULLET_PRECISION) && RAYCONTACT_BULLET_PRECISION == 32 && defined(BT_USE_DOUBLE_PRECISION)
#error \
    "The float build of Bullet is linked but BT_USE_DOUBLE_PRECISION is defined: compile with `pkg-config --cflags bullet`."
#endif

namespace raycontact::bullet {

#ifdef BT_USE_DOUBLE_PRECISION
#define RAYCONTACT_BULLET_IS_DOUBLE true
#else
#define RAYCONTACT_BULLET_IS_DOUBLE false
#endif
/** Whether Bullet's scalar is double. */
inline constexpr bool double_precision = RAYCONTACT_BULLET_IS_DOUBLE;
#undef RAYCONTACT_BULLET_IS_DOUBLE

static_assert(std::is_same<btScalar, double>::value == double_precision,
              "BT_USE_DOUBLE_PRECISION changed after Bullet's headers were read: define it on the command line, as "
              "`pkg-config --cflags bullet-float64` does");

namespace detail {

/**
 * The name of this function of Bullet contains the scalar type, so a program compiled for one precision and linked
 * with the other stops at the linker instead of running with arrays of the wrong size.
 */
inline void require_library_of_same_precision() {
  void (btSoftBody::*volatile needed)(btScalar, bool) = &btSoftBody::setTotalMass;
  static_cast<void>(needed);
}

}  // namespace detail
}  // namespace raycontact::bullet

#endif  // RAYCONTACT_BULLET_PRECISION_HPP
