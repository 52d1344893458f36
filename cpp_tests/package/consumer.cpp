#include <cstdio>
#include <raycontact.hpp>

int main() {
  try {
    raycontact::check(rayc_mesh_create_from_obj(nullptr, "missing.obj", nullptr));
  } catch (const raycontact::Error& error) {
    return error.status() == RAYC_STATUS_NULL_POINTER ? 0 : 1;
  }
  std::fprintf(stderr, "no exception\n");
  return 1;
}
