#include <raycontact.h>
#include <stdio.h>

int main(void) {
  const uint32_t expected = RAYC_VERSION_MAJOR * 10000 + RAYC_VERSION_MINOR * 100 + RAYC_VERSION_PATCH;
  rayc_scene* scene = NULL;
  /* A scene with threads of its own pulls in more of the system libraries. */
  rayc_scene_options options;
  if (rayc_version() != expected || rayc_default_scene_options(sizeof options, &options) != RAYC_STATUS_OK) {
    return 1;
  }
  options.threads = 2;
  if (rayc_scene_create(&options, &scene) != RAYC_STATUS_OK) {
    fprintf(stderr, "%s\n", rayc_last_error_message());
    return 1;
  }
  return rayc_scene_destroy(scene) == RAYC_STATUS_OK ? 0 : 1;
}
