/* Two static libraries written in Rust in one program, each with its own copy of Rust's standard library. */
#include "check.h"

int64_t second_sum(int64_t n);

int main(void) {
  CHECK(second_sum(100) == 5050);
  CHECK(second_sum(-1) == -1);

  rayc_scene_options options;
  rayc_scene* scene = NULL;
  rayc_mesh* mesh = NULL;
  CHECK_OK(rayc_default_scene_options(sizeof options, &options));
  options.threads = 2;
  CHECK_OK(rayc_scene_create(&options, &scene));
  CHECK_STATUS(rayc_mesh_create_from_obj(NULL, "no such file", &mesh), RAYC_STATUS_FILE_NOT_READABLE, "no such file");
  CHECK(second_sum(10) == 55);
  CHECK_OK(rayc_scene_destroy(scene));
  return check_result();
}
