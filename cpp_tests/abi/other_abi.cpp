// Headers of another ABI than the library's refuse to make anything, and say both numbers.
#include <cstdio>
#include <cstring>

#include "raycontact.hpp"

static_assert(RAYC_ABI_VERSION == 987654, "these are the changed headers");

int main() {
  try {
    raycontact::Scene scene;
  } catch (const raycontact::Error& error) {
    if (std::strstr(error.what(), "987654") != nullptr) return 0;
    std::fprintf(stderr, "the message does not say the ABI of the header: %s\n", error.what());
    return 1;
  }
  std::fprintf(stderr, "a scene was made with headers of another ABI\n");
  return 1;
}
