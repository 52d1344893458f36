/* Bodies that scenes share, from C: keys decide the order, a ghost's pairs are found by one scene of two, meshes go as
   bytes, forces come pair by pair; and what is refused. */
#include "check.h"
#include "raycontact/distributed.h"
#include "shapes.h"

static rayc_mesh* octahedron(double shift) {
  double positions[3 * OCTAHEDRON_VERTICES];
  for (int k = 0; k < 3 * OCTAHEDRON_VERTICES; ++k) positions[k] = octahedron_positions[k] + shift;
  const rayc_vectors vectors = packed(positions, OCTAHEDRON_VERTICES);
  rayc_mesh* mesh = NULL;
  CHECK_OK(rayc_mesh_create(NULL, &vectors, octahedron_triangles, OCTAHEDRON_TRIANGLES, &mesh));
  return mesh;
}

/* Packs, and makes another mesh of the bytes. */
static rayc_mesh* copy(const rayc_mesh* mesh) {
  static uint8_t bytes[4096];
  size_t length = 0;
  rayc_mesh* made = NULL;
  CHECK_OK(rayc_mesh_packed_length(mesh, &length));
  /* The octahedron is one cluster of triangles. */
  CHECK(length == 44 + 24 * OCTAHEDRON_VERTICES + 16 * OCTAHEDRON_TRIANGLES + 1 + 8);
  CHECK_STATUS(rayc_mesh_pack(mesh, length - 1, bytes), RAYC_STATUS_WRONG_COUNT, "give that many");
  CHECK_OK(rayc_mesh_pack(mesh, length, bytes));
  CHECK_STATUS(rayc_mesh_unpack(length - 1, bytes, &made), RAYC_STATUS_SAVED_STATE_BROKEN, "packed mesh");
  bytes[50] ^= 1;
  CHECK_STATUS(rayc_mesh_unpack(length, bytes, &made), RAYC_STATUS_SAVED_STATE_BROKEN, "changed since");
  bytes[50] ^= 1;
  bytes[8] = 77;
  CHECK_STATUS(rayc_mesh_unpack(length, bytes, &made), RAYC_STATUS_SAVED_STATE_OTHER_VERSION, "77");
  bytes[8] = 2;
  CHECK(made == NULL);
  CHECK_OK(rayc_mesh_unpack(length, bytes, &made));
  return made;
}

int main(void) {
  rayc_scene* scene = NULL;
  rayc_contacts* contacts = NULL;
  CHECK_OK(rayc_scene_create(NULL, &scene));
  CHECK_OK(rayc_contacts_create(&contacts));
  uint32_t bodies[2] = {42, 42};
  const uint64_t keys[2] = {UINT64_MAX, 3};
  for (int i = 0; i < 2; ++i) {
    rayc_mesh* mesh = octahedron(i == 0 ? 0.0 : 0.25);
    rayc_mesh* made = copy(mesh);
    CHECK_OK(rayc_scene_add_mesh_with_key(scene, made, keys[i], &bodies[i]));
    CHECK_STATUS(rayc_scene_add_mesh_with_key(scene, mesh, keys[i], &bodies[i]), RAYC_STATUS_KEY_TAKEN, "key");
    CHECK_OK(rayc_mesh_destroy(mesh));
    CHECK_OK(rayc_mesh_destroy(made));
  }
  CHECK(bodies[0] == 0 && bodies[1] == 1);

  CHECK_OK(rayc_scene_query(scene, contacts));
  rayc_contact first;
  CHECK_OK(rayc_contacts_copy(contacts, 0, 1, &first));
  CHECK(first.colliding == 1 && first.collided == 0);
  rayc_pair_memory memory;
  CHECK_OK(rayc_scene_copy_pair_memories(scene, 0, 1, sizeof memory, &memory));
  CHECK(memory.first == 1 && memory.second == 0);
  CHECK_OK(rayc_scene_set_pair_memory(scene, sizeof memory, &memory));
  memory.first = 0, memory.second = 1;
  CHECK_STATUS(rayc_scene_set_pair_memory(scene, sizeof memory, &memory), RAYC_STATUS_SAVED_STATE_BROKEN, "other way");
  memory.first = 9;
  CHECK_STATUS(rayc_scene_set_pair_memory(scene, sizeof memory, &memory), RAYC_STATUS_UNKNOWN_BODY, "9");
  CHECK_STATUS(rayc_scene_set_pair_memory(scene, 8, &memory), RAYC_STATUS_INVALID_STRUCT_SIZE, "rayc_pair_memory");

  /* The forces of the pair are those of all contacts, and are opposite. */
  size_t pair_count = 0, force_count = 0;
  CHECK_OK(rayc_contacts_sum_pair_forces(contacts, NULL, 0, NULL, NULL, &pair_count, &force_count));
  CHECK(pair_count == 1 && force_count > 2 && force_count <= 2 * OCTAHEDRON_VERTICES);
  rayc_pair_forces pair;
  rayc_vertex_force forces[2 * OCTAHEDRON_VERTICES];
  CHECK_STATUS(rayc_contacts_copy_pair_forces(contacts, 1, &pair, 1, forces), RAYC_STATUS_WRONG_COUNT,
               "forces has room for 1");
  CHECK_OK(rayc_contacts_copy_pair_forces(contacts, pair_count, &pair, force_count, forces));
  CHECK(pair.first == 1 && pair.second == 0 && pair.first_count + pair.second_count == force_count);
  double expected[2][3 * OCTAHEDRON_VERTICES], sum[3] = {0, 0, 0};
  memset(expected, 0, sizeof expected);
  const rayc_vectors_mut out[2] = {packed_mut(expected[0], OCTAHEDRON_VERTICES),
                                   packed_mut(expected[1], OCTAHEDRON_VERTICES)};
  CHECK_OK(rayc_contacts_add_forces(contacts, NULL, 2, NULL, NULL, out));
  for (size_t i = 0; i < force_count; ++i) {
    const uint32_t body = i < pair.first_count ? pair.first : pair.second;
    for (int k = 0; k < 3; ++k) {
      CHECK_NEAR(forces[i].force[k], expected[body][3 * forces[i].vertex + (uint32_t)k], 1e-14);
      sum[k] += forces[i].force[k];
    }
  }
  for (int k = 0; k < 3; ++k) CHECK_NEAR(sum[k], 0, 1e-14);

  rayc_body_state state;
  CHECK_STATUS(rayc_scene_body_state(scene, 9, sizeof state, &state), RAYC_STATUS_UNKNOWN_BODY, "9");
  CHECK_OK(rayc_scene_find_self_contacts(scene));
  CHECK_OK(rayc_scene_body_state(scene, 1, sizeof state, &state));
  CHECK(state.lower[0] == -0.75 && state.upper[2] == 1.25);
  CHECK(state.cost > 0 && state.overlaps_itself == 0);
  rayc_pair_cost cost = {42, 42, -1};
  size_t cost_count = 42;
  CHECK_OK(rayc_scene_pair_cost_count(scene, &cost_count));
  CHECK(cost_count == 1);
  CHECK_STATUS(rayc_scene_copy_pair_costs(scene, 1, 1, sizeof cost, &cost), RAYC_STATUS_WRONG_COUNT, "there are 1");
  CHECK(cost.first == 42);
  CHECK_OK(rayc_scene_copy_pair_costs(scene, 0, 1, sizeof cost, &cost));
  CHECK(cost.first == 1 && cost.second == 0 && cost.cost > 0 && cost.cost <= 2 * state.cost);

  /* A ghost's pair is found here or there. */
  uint32_t here = 2, there = 2;
  CHECK_OK(rayc_finds_pair(UINT64_MAX, 3, &here));
  CHECK_OK(rayc_finds_pair(3, UINT64_MAX, &there));
  CHECK(here + there == 1);
  CHECK_STATUS(rayc_finds_pair(3, 3, &here), RAYC_STATUS_INVALID_OPTION, "both keys are 3");
  size_t counts[2];
  for (uint32_t ghost = 0; ghost < 2; ++ghost) {
    CHECK_OK(rayc_scene_share_body(scene, ghost, 1, 1, 0));
    CHECK_OK(rayc_scene_share_body(scene, 1 - ghost, 0, RAYC_NEIGHBOURS_COUNTED, 0));
    CHECK_OK(rayc_scene_query(scene, contacts));
    CHECK_OK(rayc_contacts_count(contacts, &counts[ghost]));
  }
  CHECK((counts[0] == 0) != (counts[1] == 0));
  CHECK_OK(rayc_scene_share_body(scene, 0, 1, 0, 1));
  CHECK_OK(rayc_scene_query(scene, contacts));
  CHECK_OK(rayc_contacts_count(contacts, &counts[0]));
  CHECK(counts[0] == 0); /* two ghosts */
  CHECK_STATUS(rayc_scene_share_body(scene, 0, 2, 0, 0), RAYC_STATUS_INVALID_OPTION, "is_ghost");
  CHECK_STATUS(rayc_scene_share_body(scene, 0, 1, 0, 2), RAYC_STATUS_INVALID_OPTION, "overlaps_itself");
  CHECK_STATUS(rayc_scene_share_body(scene, 7, 1, 0, 0), RAYC_STATUS_UNKNOWN_BODY, "7");
  CHECK_OK(rayc_contacts_destroy(contacts));
  CHECK_OK(rayc_scene_destroy(scene));
  return check_result();
}
