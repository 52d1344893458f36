/* What the pairs of a scene remember: a small octahedron inside a large one escapes; its memory is read, saved and
   restored in another scene, which goes on as the first; bad bytes are refused; an escape is forbidden. */
#include "check.h"
#include "shapes.h"

#define LENGTH 144 /* of one saved pair */

static rayc_scene* nested(uint32_t precision) {
  rayc_scene_options options;
  CHECK_OK(rayc_default_scene_options(sizeof options, &options));
  options.precision = precision;
  rayc_scene* scene = NULL;
  CHECK_OK(rayc_scene_create(&options, &scene));
  for (uint32_t i = 0; i < 2; ++i) {
    double positions[3 * OCTAHEDRON_VERTICES];
    for (int k = 0; k < 3 * OCTAHEDRON_VERTICES; ++k) {
      positions[k] = octahedron_positions[k] * (i == 0 ? 1.0 : 0.125);
    }
    rayc_mesh_options mesh_options;
    CHECK_OK(rayc_default_mesh_options(sizeof mesh_options, &mesh_options));
    mesh_options.precision = precision;
    const rayc_vectors vectors = packed(positions, OCTAHEDRON_VERTICES);
    rayc_mesh* mesh = NULL;
    uint32_t body = 42;
    CHECK_OK(rayc_mesh_create(&mesh_options, &vectors, octahedron_triangles, OCTAHEDRON_TRIANGLES, &mesh));
    CHECK_OK(rayc_scene_add_mesh(scene, mesh, &body));
    CHECK_OK(rayc_mesh_destroy(mesh));
  }
  return scene;
}

static rayc_statistics query(rayc_scene* scene, rayc_contacts* contacts) {
  rayc_statistics statistics;
  memset(&statistics, 0, sizeof statistics);
  CHECK_OK(rayc_scene_query(scene, contacts));
  CHECK_OK(rayc_contacts_statistics(contacts, sizeof statistics, &statistics));
  return statistics;
}

/* The push is along the remembered direction, and what the contacts push with together. */
static void check_push(const rayc_contacts* contacts, const rayc_pair_memory* memory) {
  size_t count = 0, contact_count = 0;
  rayc_escape_push push;
  memset(&push, 0, sizeof push);
  CHECK_OK(rayc_contacts_count(contacts, &contact_count));
  CHECK_OK(rayc_contacts_escape_push_count(contacts, &count));
  CHECK(count == 1);
  CHECK_STATUS(rayc_contacts_copy_escape_pushes(contacts, 1, 1, sizeof push, &push), RAYC_STATUS_WRONG_COUNT,
               "there are 1");
  CHECK_OK(rayc_contacts_copy_escape_pushes(contacts, 0, 1, sizeof push, &push));
  CHECK(push.first == 0 && push.second == 1 && push.contact_count == contact_count);
  CHECK(push.depth > 0 && push.area > 0);
  CHECK(memcmp(push.direction, memory->direction, sizeof push.direction) == 0);

  rayc_response_options options;
  CHECK_OK(rayc_default_response_options(sizeof options, &options));
  options.stiffness = 2;
  double forces[2][3 * OCTAHEDRON_VERTICES];
  memset(forces, 0, sizeof forces);
  const rayc_vectors_mut out[2] = {packed_mut(forces[0], OCTAHEDRON_VERTICES),
                                   packed_mut(forces[1], OCTAHEDRON_VERTICES)};
  CHECK_OK(rayc_contacts_add_forces(contacts, &options, 2, NULL, NULL, out));
  for (int axis = 0; axis < 3; ++axis) {
    double sums[2] = {0, 0};
    for (int i = axis; i < 3 * OCTAHEDRON_VERTICES; i += 3)
      for (int body = 0; body < 2; ++body) sums[body] += forces[body][i];
    const double expected = 2 * push.area * push.depth * push.direction[axis];
    CHECK_NEAR(sums[0], expected, 1e-14);
    CHECK_NEAR(sums[1], -expected, 1e-14);
  }
}

int main(void) {
  rayc_contacts* contacts = NULL;
  CHECK_OK(rayc_contacts_create(&contacts));
  rayc_scene* scene = nested(RAYC_SCALAR_F64);
  size_t count = 42;
  CHECK_OK(rayc_scene_pair_memory_count(scene, &count));
  CHECK(count == 0);
  CHECK(query(scene, contacts).escapes_started == 1);
  CHECK_OK(rayc_scene_pair_memory_count(scene, &count));
  CHECK(count == 1);

  /* The same positions have the same contacts, until the step ends. */
  CHECK(query(scene, contacts).escapes_started == 1);
  CHECK_STATUS(rayc_scene_advance(scene, NAN), RAYC_STATUS_INVALID_OPTION, "NaN seconds");
  CHECK_STATUS(rayc_scene_advance(scene, -0.5), RAYC_STATUS_INVALID_OPTION, "-0.5 seconds");
  CHECK_STATUS(rayc_scene_advance(NULL, 0.5), RAYC_STATUS_NULL_POINTER, "scene");
  CHECK(query(scene, contacts).escapes_started == 1);
  CHECK_OK(rayc_scene_advance(scene, 1.0 / 60));

  rayc_pair_memory memory;
  CHECK_OK(rayc_scene_copy_pair_memories(scene, 0, 1, sizeof memory, &memory));
  CHECK(memory.first == 0 && memory.second == 1 && memory.escaping == 1);
  const double* d = memory.direction;
  CHECK_NEAR(d[0] * d[0] + d[1] * d[1] + d[2] * d[2], 1.0, 1e-14);
  CHECK_STATUS(rayc_scene_copy_pair_memories(scene, 0, 2, sizeof memory, &memory), RAYC_STATUS_WRONG_COUNT, "1");

  check_push(contacts, &memory);

  size_t length = 0;
  uint8_t bytes[LENGTH];
  CHECK_OK(rayc_scene_saved_length(scene, &length));
  CHECK(length == LENGTH);
  CHECK_STATUS(rayc_scene_save_pair_memories(scene, LENGTH - 1, bytes), RAYC_STATUS_WRONG_COUNT, "144");
  CHECK_OK(rayc_scene_save_pair_memories(scene, LENGTH, bytes));

  rayc_scene* other = nested(RAYC_SCALAR_F64);
  CHECK_OK(rayc_scene_restore_pair_memories(other, LENGTH, bytes));
  rayc_pair_memory restored;
  CHECK_OK(rayc_scene_copy_pair_memories(other, 0, 1, sizeof restored, &restored));
  CHECK(restored.escaping == 1 && memcmp(restored.direction, memory.direction, sizeof memory.direction) == 0);
  const rayc_statistics next = query(other, contacts);
  CHECK(next.escapes_started == 0 && next.escaping_pairs == 1);

  /* Refused, and as before. */
  CHECK_STATUS(rayc_scene_restore_pair_memories(other, 0, NULL), RAYC_STATUS_SAVED_STATE_BROKEN, "0 bytes");
  CHECK_STATUS(rayc_scene_restore_pair_memories(other, LENGTH, NULL), RAYC_STATUS_NULL_POINTER, "bytes");
  CHECK_STATUS(rayc_scene_restore_pair_memories(other, LENGTH - 1, bytes), RAYC_STATUS_SAVED_STATE_BROKEN, "143");
  bytes[60] ^= 1;
  CHECK_STATUS(rayc_scene_restore_pair_memories(other, LENGTH, bytes), RAYC_STATUS_SAVED_STATE_BROKEN, "changed");
  bytes[60] ^= 1;
  bytes[8] ^= 6;
  CHECK_STATUS(rayc_scene_restore_pair_memories(other, LENGTH, bytes), RAYC_STATUS_SAVED_STATE_OTHER_VERSION, "5");
  bytes[8] ^= 6;
  rayc_scene* single = nested(RAYC_SCALAR_F32);
  CHECK_STATUS(rayc_scene_restore_pair_memories(single, LENGTH, bytes), RAYC_STATUS_PRECISION_MISMATCH, "8-byte");
  CHECK_OK(rayc_scene_destroy(single));
  CHECK_OK(rayc_scene_pair_memory_count(other, &count));
  CHECK(count == 1);

  /* Forbidden, it ends; and each bad argument says which. */
  uint32_t allowed = 42;
  CHECK_OK(rayc_scene_allow_escape(other, 1, 0, 0));
  CHECK_OK(rayc_scene_may_escape(other, 0, 1, &allowed));
  CHECK(allowed == 0);
  const rayc_statistics forbidden = query(other, contacts);
  CHECK(forbidden.escaping_pairs == 0 && forbidden.escapes_forbidden == 1 && forbidden.escape_contacts == 0);
  CHECK_STATUS(rayc_scene_allow_escape(other, 1, 0, 2), RAYC_STATUS_INVALID_OPTION, "allowed");
  CHECK_STATUS(rayc_scene_allow_escape(other, 1, 1, 1), RAYC_STATUS_INVALID_OPTION, "twice");
  CHECK_STATUS(rayc_scene_allow_escape(other, 1, 9, 1), RAYC_STATUS_UNKNOWN_BODY, "9");
  CHECK_OK(rayc_scene_remove_body(other, 0));
  CHECK_STATUS(rayc_scene_restore_pair_memories(other, LENGTH, bytes), RAYC_STATUS_UNKNOWN_BODY, "0");

  CHECK_OK(rayc_scene_destroy(other));
  CHECK_OK(rayc_scene_destroy(scene));
  CHECK_OK(rayc_contacts_destroy(contacts));
  return check_result();
}
