// SPDX-License-Identifier: MIT OR Apache-2.0
/** One number for the bits of many, by which runs on different numbers of ranks are compared. */
#ifndef RAYCONTACT_DEMOS_NUMBER_BITS_HPP
#define RAYCONTACT_DEMOS_NUMBER_BITS_HPP

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace demo {

/** FNV-1a over words of 64 bits, begun with a body's key: sums over bodies do not depend on their order. */
class NumberBits {
 public:
  explicit NumberBits(uint64_t key) : hash_(0xcbf29ce484222325ull ^ key) {}

  void add(const double* numbers, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      uint64_t bits;
      std::memcpy(&bits, numbers + i, sizeof bits);
      hash_ = (hash_ ^ bits) * 0x100000001b3ull;
      hash_ ^= hash_ >> 29;
    }
  }

  uint64_t hash() const { return hash_; }

 private:
  uint64_t hash_;
};

}  // namespace demo

#endif  // RAYCONTACT_DEMOS_NUMBER_BITS_HPP
