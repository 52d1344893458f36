// SPDX-License-Identifier: MIT OR Apache-2.0
/** Arrays of numbers that come in threes. */
#ifndef RAYCONTACT_BULLET_THREES_HPP
#define RAYCONTACT_BULLET_THREES_HPP

#include <cstddef>
#include <stdexcept>
#include <string>

namespace raycontact::bullet::detail {

/** Throws std::invalid_argument where one or two numbers are left over. */
inline void check_threes(std::size_t size, const std::string& name, const std::string& each) {
  if (size % 3 != 0)
    throw std::invalid_argument(name + " has " + std::to_string(size) +
                                " numbers, which is no multiple of three; give three for each " + each);
}

}  // namespace raycontact::bullet::detail

#endif  // RAYCONTACT_BULLET_THREES_HPP
