// SPDX-License-Identifier: MIT OR Apache-2.0
#pragma once

#include <chrono>

namespace bench {

class Clock {
 public:
  // Microseconds since the last call.
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    const double passed = std::chrono::duration<double, std::micro>(now - last_).count();
    last_ = now;
    return passed;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace bench
