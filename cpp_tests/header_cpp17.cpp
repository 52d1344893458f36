// The main headers, as C++17, in a program of two translation units.
#include <cstdio>

#include "raycontact.h"
#include "raycontact.hpp"

extern "C" std::uint32_t header_version_from_c99(void);

int main() {
  // RAYCONTACT_CARGO_VERSION is what CMake read from Cargo.toml.
  if (rayc_version() != RAYCONTACT_CARGO_VERSION || header_version_from_c99() != RAYCONTACT_CARGO_VERSION) {
    std::fprintf(stderr, "versions differ: library %u, header %u, Cargo.toml %u\n", rayc_version(),
                 header_version_from_c99(), static_cast<unsigned>(RAYCONTACT_CARGO_VERSION));
    return 1;
  }
  return 0;
}
