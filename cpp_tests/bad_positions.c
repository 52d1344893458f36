/* New positions that cannot be used are refused with their own status, and the mesh keeps the old ones. */
#include "check.h"
#include "shapes.h"

static const double no_shift[3] = {0, 0, 0};
static rayc_mesh* mesh;

static void check_unchanged(void) {
  double positions[3 * OCTAHEDRON_VERTICES] = {0};
  const rayc_vectors_mut out = packed_mut(positions, OCTAHEDRON_VERTICES);
  CHECK_OK(rayc_mesh_copy_positions(mesh, &out));
  CHECK(memcmp(positions, octahedron_positions, sizeof positions) == 0);
}

static void check_refused(const rayc_vectors* vectors, rayc_status status, const char* part, const char* other_part) {
  const rayc_status actual = rayc_mesh_set_positions(mesh, vectors);
  CHECK_STATUS(actual, status, part);
  CHECK_STATUS(actual, status, other_part);
  check_unchanged();
}

/* A number, but beyond the largest float: in a mesh and in a scene of float precision. */
static void refuses_what_no_float_holds(void) {
  rayc_mesh_options options;
  rayc_scene_options scene_options;
  CHECK_OK(rayc_default_mesh_options(sizeof options, &options));
  CHECK_OK(rayc_default_scene_options(sizeof scene_options, &scene_options));
  options.precision = RAYC_SCALAR_F32;
  scene_options.precision = RAYC_SCALAR_F32;
  double positions[3 * OCTAHEDRON_VERTICES];
  octahedron_shifted(no_shift, positions);
  const rayc_vectors vectors = packed(positions, OCTAHEDRON_VERTICES);
  rayc_mesh* narrow = NULL;
  rayc_scene* scene = NULL;
  uint32_t body = 0;
  CHECK_OK(rayc_mesh_create(&options, &vectors, octahedron_triangles, OCTAHEDRON_TRIANGLES, &narrow));
  CHECK_OK(rayc_scene_create(&scene_options, &scene));
  CHECK_OK(rayc_scene_add_mesh(scene, narrow, &body));

  positions[3 * 2 + 1] = -1e39;
  CHECK_STATUS(rayc_mesh_set_positions(narrow, &vectors), RAYC_STATUS_MESH_BEYOND_RANGE,
               "vertex 2 has the coordinate -1e39");
  CHECK_STATUS(rayc_mesh_set_positions(narrow, &vectors), RAYC_STATUS_MESH_BEYOND_RANGE, "double precision");
  CHECK_STATUS(rayc_scene_set_positions(scene, body, &vectors), RAYC_STATUS_MESH_BEYOND_RANGE, "body 0: vertex 2");
  double read_back[3 * OCTAHEDRON_VERTICES] = {0};
  const rayc_vectors_mut out = packed_mut(read_back, OCTAHEDRON_VERTICES);
  CHECK_OK(rayc_mesh_copy_positions(narrow, &out));
  CHECK(memcmp(read_back, octahedron_positions, sizeof read_back) == 0);
  CHECK_OK(rayc_scene_destroy(scene));
  CHECK_OK(rayc_mesh_destroy(narrow));
}

int main(void) {
  mesh = octahedron_mesh(no_shift);
  double positions[3 * (OCTAHEDRON_VERTICES + 1)] = {0};
  octahedron_shifted(octahedron_shift, positions);
  const rayc_vectors good = packed(positions, OCTAHEDRON_VERTICES);
  rayc_vectors vectors = good;

  check_refused(NULL, RAYC_STATUS_NULL_POINTER, "positions", NULL);
  vectors.data = NULL;
  check_refused(&vectors, RAYC_STATUS_NULL_POINTER, "positions", NULL);
  CHECK_STATUS(rayc_mesh_set_positions(NULL, &good), RAYC_STATUS_NULL_POINTER, "mesh");

  /* Too few, too many, none. */
  vectors = good;
  vectors.count = 5;
  check_refused(&vectors, RAYC_STATUS_WRONG_COUNT, "5", "6");
  vectors.count = 7;
  check_refused(&vectors, RAYC_STATUS_WRONG_COUNT, "7", "6");
  vectors.count = 0;
  check_refused(&vectors, RAYC_STATUS_WRONG_COUNT, "0", "6");

  /* A stride shorter than three doubles, and one that no array can have. */
  vectors = good;
  vectors.stride = 8;
  check_refused(&vectors, RAYC_STATUS_INVALID_STRIDE, "8", "24");
  vectors.stride = SIZE_MAX / 4;
  check_refused(&vectors, RAYC_STATUS_INVALID_STRIDE, "6 vectors", "4611686018427387903");

  vectors = good;
  vectors.scalar = 0;
  check_refused(&vectors, RAYC_STATUS_UNKNOWN_ENUM, "0", "rayc_scalar");
  vectors.scalar = 77;
  check_refused(&vectors, RAYC_STATUS_UNKNOWN_ENUM, "77", "rayc_scalar");

  const double bad[] = {NAN, INFINITY, -INFINITY};
  for (size_t i = 0; i < 3; ++i) {
    octahedron_shifted(octahedron_shift, positions);
    positions[3 * 5 + i] = bad[i];
    check_refused(&good, RAYC_STATUS_NOT_FINITE, "vertex 5", "the simulation's last step");
  }
  refuses_what_no_float_holds();

  /* And the good ones are taken. */
  octahedron_shifted(octahedron_shift, positions);
  CHECK_OK(rayc_mesh_set_positions(mesh, &good));
  double read_back[3 * OCTAHEDRON_VERTICES] = {0};
  const rayc_vectors_mut out = packed_mut(read_back, OCTAHEDRON_VERTICES);
  CHECK_OK(rayc_mesh_copy_positions(mesh, &out));
  CHECK(memcmp(read_back, positions, sizeof read_back) == 0);

  CHECK_OK(rayc_mesh_destroy(mesh));
  return check_result();
}
