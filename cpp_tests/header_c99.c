/* The header alone, twice, as C99. */
#include "raycontact.h"

uint32_t header_version_from_c99(void);

uint32_t header_version_from_c99(void) {
  return RAYC_VERSION_MAJOR * 10000 + RAYC_VERSION_MINOR * 100 + RAYC_VERSION_PATCH;
}
