/* A row of overlapping octahedra: a scene finds for each neighbouring pair what a pair query finds, in the same order
   for any number of threads, and follows bodies that move and leave. */
#include "check.h"
#include "shapes.h"

#define BODIES 8

static rayc_scene* row_of_bodies(uint32_t threads) {
  rayc_scene_options options;
  CHECK_OK(rayc_default_scene_options(sizeof options, &options));
  options.threads = threads;
  rayc_scene* scene = NULL;
  CHECK_OK(rayc_scene_create(&options, &scene));
  const rayc_detection_options detection = from_vertices();
  CHECK_OK(rayc_scene_set_detection_options(scene, &detection));
  for (uint32_t i = 0; i < BODIES; ++i) {
    const double shift[3] = {i * octahedron_shift[0], i * octahedron_shift[1], i * octahedron_shift[2]};
    rayc_mesh* mesh = octahedron_mesh(shift);
    uint32_t body = 42;
    CHECK_OK(rayc_scene_add_mesh(scene, mesh, &body));
    CHECK(body == i);
    CHECK_OK(rayc_mesh_destroy(mesh)); /* the scene has its own copy */
  }
  return scene;
}

static size_t query(rayc_scene* scene, rayc_contacts* contacts, rayc_contact* out) {
  size_t count = 0;
  CHECK_OK(rayc_scene_query(scene, contacts));
  CHECK_OK(rayc_contacts_count(contacts, &count));
  CHECK(count <= 2 * BODIES);
  if (count > 2 * BODIES) {
    return 0;
  }
  CHECK_OK(rayc_contacts_copy(contacts, 0, count, out));
  return count;
}

int main(void) {
  rayc_contacts* contacts = NULL;
  rayc_contact expected[2 * BODIES], actual[2 * BODIES];
  CHECK_OK(rayc_contacts_create(&contacts));
  rayc_scene* scene = row_of_bodies(1);
  memset(expected, 0, sizeof expected);
  CHECK(query(scene, contacts, expected) == 2 * (BODIES - 1));
  for (uint32_t i = 0; i < BODIES - 1; ++i) {
    CHECK(expected[2 * i].colliding == i && expected[2 * i].collided == i + 1);
    CHECK(expected[2 * i + 1].colliding == i + 1 && expected[2 * i + 1].collided == i);
    CHECK_NEAR(expected[2 * i].depth, SHIFTED_DEPTH, 1e-13);
    CHECK_NEAR(expected[2 * i + 1].depth, SHIFTED_DEPTH, 1e-13);
  }

  for (uint32_t threads = 2; threads <= 4; ++threads) {
    rayc_scene* parallel = row_of_bodies(threads);
    memset(actual, 0, sizeof actual);
    CHECK(query(parallel, contacts, actual) == 2 * (BODIES - 1));
    CHECK(memcmp(actual, expected, sizeof actual) == 0);
    CHECK_OK(rayc_scene_destroy(parallel));
  }

  /* A pair that is switched off is not looked at; the others stay as they are. */
  CHECK_OK(rayc_scene_set_pair_collision(scene, 3, 2, 0));
  CHECK(query(scene, contacts, actual) == 2 * (BODIES - 2));
  CHECK(memcmp(actual, expected, 4 * sizeof *actual) == 0);
  CHECK(memcmp(actual + 4, expected + 6, (2 * BODIES - 8) * sizeof *actual) == 0);
  CHECK_STATUS(rayc_scene_set_pair_collision(scene, 2, 2, 0), RAYC_STATUS_INVALID_OPTION, "2");
  CHECK_STATUS(rayc_scene_set_pair_collision(scene, 2, 3, 2), RAYC_STATUS_INVALID_OPTION, "is_on");
  CHECK_STATUS(rayc_scene_set_pair_collision(scene, 2, 42, 1), RAYC_STATUS_UNKNOWN_BODY, "42");
  CHECK_OK(rayc_scene_set_pair_collision(scene, 2, 3, 1));
  memset(actual, 0, sizeof actual);
  CHECK(query(scene, contacts, actual) == 2 * (BODIES - 1));
  CHECK(memcmp(actual, expected, sizeof actual) == 0);

  /* The last body goes far away, the second leaves: four pairs stay; then the number 1 is unknown. */
  double positions[3 * OCTAHEDRON_VERTICES];
  const double far_away[3] = {1000, 0, 0};
  octahedron_shifted(far_away, positions);
  const rayc_vectors vectors = packed(positions, OCTAHEDRON_VERTICES);
  CHECK_OK(rayc_scene_set_positions(scene, BODIES - 1, &vectors));
  CHECK_OK(rayc_scene_remove_body(scene, 1));
  CHECK(query(scene, contacts, actual) == 2 * (BODIES - 4));
  CHECK_STATUS(rayc_scene_remove_body(scene, 1), RAYC_STATUS_UNKNOWN_BODY, "1");

  /* A refused position changes nothing. */
  positions[4] = NAN;
  CHECK_STATUS(rayc_scene_set_positions(scene, 2, &vectors), RAYC_STATUS_NOT_FINITE, "1");
  CHECK(query(scene, contacts, actual) == 2 * (BODIES - 4));

  rayc_mesh* single = NULL;
  rayc_mesh_options options;
  CHECK_OK(rayc_default_mesh_options(sizeof options, &options));
  options.precision = RAYC_SCALAR_F32;
  const rayc_vectors at_origin = packed(octahedron_positions, OCTAHEDRON_VERTICES);
  CHECK_OK(rayc_mesh_create(&options, &at_origin, octahedron_triangles, OCTAHEDRON_TRIANGLES, &single));
  uint32_t body = 42;
  CHECK_STATUS(rayc_scene_add_mesh(scene, single, &body), RAYC_STATUS_PRECISION_MISMATCH, "precision");
  CHECK(body == 42);
  CHECK_OK(rayc_mesh_destroy(single));

  CHECK_OK(rayc_scene_destroy(scene));
  CHECK_OK(rayc_contacts_destroy(contacts));
  return check_result();
}
