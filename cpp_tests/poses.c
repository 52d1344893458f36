/* Bodies moved by poses: the contacts and forces are those of the same bodies moved by positions, to the bit, and what
   is no pose is refused and changes nothing. */
#include <math.h>

#include "check.h"
#include "raycontact/distributed.h"
#include "shapes.h"

#define STEPS 12

static rayc_scene* two_bodies(rayc_scalar precision) {
  rayc_scene_options options;
  rayc_mesh_options mesh_options;
  CHECK_OK(rayc_default_scene_options(sizeof options, &options));
  CHECK_OK(rayc_default_mesh_options(sizeof mesh_options, &mesh_options));
  options.precision = mesh_options.precision = (uint32_t)precision;
  rayc_scene* scene = NULL;
  CHECK_OK(rayc_scene_create(&options, &scene));
  const rayc_vectors vectors = packed(octahedron_positions, OCTAHEDRON_VERTICES);
  for (uint32_t i = 0; i < 2; ++i) {
    rayc_mesh* mesh = NULL;
    uint32_t body = 42;
    CHECK_OK(rayc_mesh_create(&mesh_options, &vectors, octahedron_triangles, OCTAHEDRON_TRIANGLES, &mesh));
    CHECK_OK(rayc_scene_add_mesh(scene, mesh, &body));
    CHECK(body == i);
    CHECK_OK(rayc_mesh_destroy(mesh));
  }
  return scene;
}

/* By a unit quaternion w, x, y, z, as the header says. */
static rayc_pose turned(double angle, double x, double y, double z) {
  const double w = cos(0.5 * angle), s = sin(0.5 * angle) / sqrt(x * x + y * y + z * z);
  x *= s, y *= s, z *= s;
  const rayc_pose pose = {{0.9 + 0.05 * angle, 0.1, 0.2},
                          {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                           {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                           {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}}};
  return pose;
}

/* The judge: the formula of the header. volatile: each product and sum is rounded, whatever the compiler would join. */
static void move(const rayc_pose* pose, double* positions) {
  for (int v = 0; v < OCTAHEDRON_VERTICES; ++v) {
    for (int k = 0; k < 3; ++k) {
      volatile double sum = pose->rotation[k][0] * octahedron_positions[3 * v];
      for (int j = 1; j < 3; ++j) {
        volatile double product = pose->rotation[k][j] * octahedron_positions[3 * v + j];
        sum = sum + product;
      }
      positions[3 * v + k] = sum + pose->position[k];
    }
  }
}

/* The force on each vertex of both bodies; gives how many contacts there are. */
static size_t forces_of(rayc_scene* scene, rayc_contacts* contacts, double* forces) {
  rayc_response_options options;
  size_t count = 0;
  CHECK_OK(rayc_default_response_options(sizeof options, &options));
  const rayc_vectors_mut arrays[2] = {packed_mut(forces, OCTAHEDRON_VERTICES),
                                      packed_mut(forces + 3 * OCTAHEDRON_VERTICES, OCTAHEDRON_VERTICES)};
  memset(forces, 0, 6 * OCTAHEDRON_VERTICES * sizeof *forces);
  CHECK_OK(rayc_scene_query(scene, contacts));
  CHECK_OK(rayc_contacts_count(contacts, &count));
  CHECK_OK(rayc_contacts_add_forces(contacts, &options, 2, NULL, NULL, arrays));
  return count;
}

static void poses_and_positions_agree(rayc_scalar precision) {
  rayc_scene *by_pose = two_bodies(precision), *by_positions = two_bodies(precision);
  rayc_contacts* contacts = NULL;
  CHECK_OK(rayc_contacts_create(&contacts));
  double expected[6 * OCTAHEDRON_VERTICES], actual[6 * OCTAHEDRON_VERTICES];
  for (int step = 0; step < STEPS; ++step) {
    const rayc_pose pose = turned(0.4 * step, 1, 0.5 * step, -0.3);
    double positions[3 * OCTAHEDRON_VERTICES];
    move(&pose, positions);
    const rayc_vectors vectors = packed(positions, OCTAHEDRON_VERTICES);
    CHECK_OK(rayc_scene_set_pose(by_pose, 1, &pose));
    CHECK_OK(rayc_scene_set_positions(by_positions, 1, &vectors));
    rayc_body_state states[2];
    CHECK_OK(rayc_scene_body_state(by_pose, 1, sizeof states[0], &states[0]));
    CHECK_OK(rayc_scene_body_state(by_positions, 1, sizeof states[1], &states[1]));
    CHECK(memcmp(states[0].lower, states[1].lower, sizeof states[0].lower) == 0);
    CHECK(memcmp(states[0].upper, states[1].upper, sizeof states[0].upper) == 0);
    const size_t count = forces_of(by_positions, contacts, expected);
    CHECK(count > 0 && forces_of(by_pose, contacts, actual) == count);
    CHECK(memcmp(actual, expected, sizeof actual) == 0);
    /* Goes on from what was saved. */
    if (step == STEPS / 2) {
      unsigned char bytes[512];
      size_t length = 0;
      CHECK_OK(rayc_scene_saved_length(by_pose, &length));
      CHECK(length <= sizeof bytes);
      CHECK_OK(rayc_scene_save_pair_memories(by_pose, length, bytes));
      rayc_scene* restored = two_bodies(precision);
      CHECK_OK(rayc_scene_set_pose(restored, 1, &pose));
      CHECK_OK(rayc_scene_restore_pair_memories(restored, length, bytes));
      CHECK(forces_of(restored, contacts, actual) == count);
      CHECK(memcmp(actual, expected, sizeof actual) == 0);
      CHECK_OK(rayc_scene_destroy(by_pose));
      by_pose = restored;
    }
  }
  CHECK_OK(rayc_contacts_destroy(contacts));
  CHECK_OK(rayc_scene_destroy(by_pose));
  CHECK_OK(rayc_scene_destroy(by_positions));
}

static void what_is_no_pose_is_refused(void) {
  rayc_scene* scene = two_bodies(RAYC_SCALAR_F32);
  rayc_contacts* contacts = NULL;
  CHECK_OK(rayc_contacts_create(&contacts));
  const rayc_pose good = turned(0.3, 1, 2, 3);
  double before[6 * OCTAHEDRON_VERTICES], after[6 * OCTAHEDRON_VERTICES];
  CHECK_OK(rayc_scene_set_pose(scene, 1, &good));
  const size_t count = forces_of(scene, contacts, before);

  rayc_pose pose = good;
  pose.position[2] = NAN;
  CHECK_STATUS(rayc_scene_set_pose(scene, 1, &pose), RAYC_STATUS_NOT_FINITE, "body 1: coordinate 2");
  pose = good;
  pose.rotation[1][0] = INFINITY;
  CHECK_STATUS(rayc_scene_set_pose(scene, 1, &pose), RAYC_STATUS_NOT_FINITE, "row 1 and column 0");
  pose = good;
  pose.rotation[0][0] *= 1.001;
  CHECK_STATUS(rayc_scene_set_pose(scene, 1, &pose), RAYC_STATUS_INVALID_DIRECTION, "no rotation matrix");
  pose = good;
  for (int k = 0; k < 3; ++k) pose.rotation[2][k] = -pose.rotation[2][k];
  CHECK_STATUS(rayc_scene_set_pose(scene, 1, &pose), RAYC_STATUS_INVALID_DIRECTION, "mirrors");
  pose = good;
  pose.position[0] = 4e38;
  CHECK_STATUS(rayc_scene_set_pose(scene, 1, &pose), RAYC_STATUS_MESH_BEYOND_RANGE, "body 1");
  CHECK_STATUS(rayc_scene_set_pose(scene, 2, &good), RAYC_STATUS_UNKNOWN_BODY, "2");
  CHECK_STATUS(rayc_scene_set_pose(scene, 1, NULL), RAYC_STATUS_NULL_POINTER, "pose");
  CHECK_STATUS(rayc_scene_set_pose(NULL, 1, &good), RAYC_STATUS_NULL_POINTER, "scene");

  CHECK(forces_of(scene, contacts, after) == count);
  CHECK(memcmp(before, after, sizeof before) == 0);
  CHECK_OK(rayc_contacts_destroy(contacts));
  CHECK_OK(rayc_scene_destroy(scene));
}

int main(void) {
  poses_and_positions_agree(RAYC_SCALAR_F64);
  poses_and_positions_agree(RAYC_SCALAR_F32);
  what_is_no_pose_is_refused();
  return check_result();
}
