/* Structs that grow: a program built with an older header gets what it knows and nothing beyond, one built with a newer
   header than the library's is told so. */
#include <stddef.h>

#include "check.h"
#include "raycontact/distributed.h"
#include "shapes.h"

/* Calls `fill(size, place)` with older, the own and newer sizes; `known` is the size of the first version. */
#define CHECK_SIZES(type, known, fill)                                                          \
  do {                                                                                          \
    union {                                                                                     \
      type value;                                                                               \
      unsigned char bytes[sizeof(type) + 8];                                                    \
    } place;                                                                                    \
    for (size_t size = (known); size <= sizeof(type); size += 8) {                              \
      memset(&place, 0xA5, sizeof place);                                                       \
      CHECK_OK(fill(size, &place.value));                                                       \
      for (size_t at = size; at < sizeof place; ++at) CHECK(place.bytes[at] == 0xA5);           \
    }                                                                                           \
    memset(&place, 0xA5, sizeof place);                                                         \
    CHECK_STATUS(fill((known)-8, &place.value), RAYC_STATUS_INVALID_STRUCT_SIZE, #type);        \
    CHECK_STATUS(fill(sizeof(type) - 4, &place.value), RAYC_STATUS_INVALID_STRUCT_SIZE, #type); \
    CHECK_STATUS(fill(sizeof(type) + 8, &place.value), RAYC_STATUS_INVALID_STRUCT_SIZE, #type); \
    CHECK(place.bytes[0] == 0xA5);                                                              \
  } while (0)

#define END_OF(type, field) (offsetof(type, field) + sizeof(((type*)0)->field))

static rayc_contacts* contacts = NULL;

static rayc_status statistics_of_contacts(size_t size, rayc_statistics* place) {
  return rayc_contacts_statistics(contacts, size, place);
}

static rayc_scene* scene = NULL;

static rayc_status pair_memory_of_scene(size_t size, rayc_pair_memory* place) {
  return rayc_scene_copy_pair_memories(scene, 0, 1, size, place);
}

static rayc_status cost_of_pair(size_t size, rayc_pair_cost* place) {
  return rayc_scene_copy_pair_costs(scene, 0, 1, size, place);
}

static rayc_status push_of_contacts(size_t size, rayc_escape_push* place) {
  return rayc_contacts_copy_escape_pushes(contacts, 0, 1, size, place);
}

static rayc_status state_of_body(size_t size, rayc_body_state* place) {
  return rayc_scene_body_state(scene, 0, size, place);
}

static rayc_status bearing_material(size_t size, rayc_material* place) {
  return rayc_bearing_material(1, 1, size, place);
}

/* An octahedron with two small ones inside, which escape. */
static void make_escapes(void) {
  CHECK_OK(rayc_scene_create(NULL, &scene));
  for (int k = 0; k < 3; ++k) {
    double positions[3 * OCTAHEDRON_VERTICES];
    for (int i = 0; i < 3 * OCTAHEDRON_VERTICES; ++i) {
      positions[i] = octahedron_positions[i] * (k == 0 ? 1.0 : 0.0625) + (k == 2 && i % 3 == 0 ? 0.25 : 0.0);
    }
    const rayc_vectors vectors = packed(positions, OCTAHEDRON_VERTICES);
    rayc_mesh* mesh = NULL;
    uint32_t body = 42;
    CHECK_OK(rayc_mesh_create(NULL, &vectors, octahedron_triangles, OCTAHEDRON_TRIANGLES, &mesh));
    CHECK_OK(rayc_scene_add_mesh(scene, mesh, &body));
    CHECK_OK(rayc_mesh_destroy(mesh));
  }
  CHECK_OK(rayc_scene_query(scene, contacts));
}

/* Elements lie as far apart as the caller says, and no call writes where there is none. */
static void arrays_are_written_in_steps_of_the_callers_size(void) {
  rayc_pair_memory memories[3];
  rayc_escape_push pushes[3];
  memset(memories, 0xA5, sizeof memories);
  memset(pushes, 0xA5, sizeof pushes);
  const unsigned char* const after[2] = {(unsigned char*)&memories[2], (unsigned char*)&pushes[2]};
  CHECK_OK(rayc_scene_copy_pair_memories(scene, 0, 2, sizeof memories[0], memories));
  CHECK_OK(rayc_contacts_copy_escape_pushes(contacts, 0, 2, sizeof pushes[0], pushes));
  for (uint32_t k = 0; k < 2; ++k) {
    CHECK(memories[k].first == 0 && memories[k].second == k + 1 && memories[k].escaping == 1);
    CHECK(pushes[k].first == 0 && pushes[k].second == k + 1 && pushes[k].depth > 0);
    CHECK(memories[k].reserved == 0 && pushes[k].reserved == 0);
  }
  for (size_t at = 0; at < sizeof memories[2]; ++at) CHECK(after[0][at] == 0xA5);
  for (size_t at = 0; at < sizeof pushes[2]; ++at) CHECK(after[1][at] == 0xA5);
  CHECK_OK(rayc_scene_copy_pair_memories(scene, 2, 0, sizeof memories[0], NULL));
  CHECK_OK(rayc_contacts_copy_escape_pushes(contacts, 2, 0, sizeof pushes[0], NULL));
  CHECK_STATUS(rayc_scene_copy_pair_memories(scene, 0, 2, sizeof memories[0], NULL), RAYC_STATUS_NULL_POINTER, "out");
  CHECK_STATUS(rayc_contacts_copy_escape_pushes(contacts, 0, 2, sizeof pushes[0], NULL), RAYC_STATUS_NULL_POINTER,
               "out");
}

/* An options struct of the first version: shorter, with garbage behind it that must not be read. */
static void older_options_are_read_as_far_as_they_go(void) {
  rayc_contact_system_options options;
  memset(&options, 0xFF, sizeof options);
  CHECK_OK(rayc_default_contact_system_options(END_OF(rayc_contact_system_options, keeps_rigid_unknowns), &options));
  CHECK(options.struct_size == END_OF(rayc_contact_system_options, keeps_rigid_unknowns));
  rayc_contact_system* system = NULL;
  CHECK_OK(rayc_contact_system_create(&options, &system));
  CHECK_OK(rayc_contact_system_destroy(system));
  options.struct_size = sizeof options;
  CHECK_STATUS(rayc_contact_system_create(&options, &system), RAYC_STATUS_INVALID_OPTION, "look_ahead");

  rayc_detection_options detection;
  rayc_scene* other = NULL;
  CHECK_OK(rayc_scene_create(NULL, &other));
  CHECK_OK(rayc_default_detection_options(sizeof detection, &detection));
  detection.law = 3;
  CHECK_STATUS(rayc_scene_set_detection_options(other, &detection), RAYC_STATUS_UNKNOWN_ENUM, "rayc_law");
  CHECK_OK(rayc_scene_destroy(other));
}

/* Padding at the end would be read as an option once one lies there. */
static void structs_have_no_padding_at_the_end(void) {
  CHECK(END_OF(rayc_mesh_options, close_holes) == sizeof(rayc_mesh_options));
  CHECK(END_OF(rayc_detection_options, reserved) == sizeof(rayc_detection_options));
  CHECK(END_OF(rayc_response_options, slip_speed) == sizeof(rayc_response_options));
  CHECK(END_OF(rayc_scene_options, parallel_context) == sizeof(rayc_scene_options));
  CHECK(END_OF(rayc_contact_system_options, weighting) == sizeof(rayc_contact_system_options));
  CHECK(END_OF(rayc_material, restitution) == sizeof(rayc_material));
  CHECK(END_OF(rayc_statistics, error_estimated) == sizeof(rayc_statistics));
  CHECK(END_OF(rayc_pair_memory, state) == sizeof(rayc_pair_memory));
  CHECK(END_OF(rayc_escape_push, area) == sizeof(rayc_escape_push));
  CHECK(END_OF(rayc_body_state, reserved) == sizeof(rayc_body_state));
  CHECK(END_OF(rayc_pair_cost, cost) == sizeof(rayc_pair_cost));
}

/* Nor a hole within, whose bytes would be whatever they were. */
static void arrays_elements_have_no_holes(void) {
  CHECK(END_OF(rayc_pair_memory, reserved) == offsetof(rayc_pair_memory, direction));
  CHECK(sizeof(rayc_pair_memory) ==
        4 * sizeof(uint32_t) + 3 * sizeof(double) + sizeof(((rayc_pair_memory*)NULL)->state));
  CHECK(END_OF(rayc_escape_push, reserved) == offsetof(rayc_escape_push, direction));
  CHECK(sizeof(rayc_escape_push) == 4 * sizeof(uint32_t) + 5 * sizeof(double));
  CHECK(sizeof(rayc_contact) ==
        4 * sizeof(uint32_t) + sizeof(uint64_t) + 2 * sizeof(rayc_surface_point) + 6 * sizeof(double));
  CHECK(sizeof(rayc_surface_point) == 4 * sizeof(uint32_t) + 6 * sizeof(double));
  CHECK(sizeof(rayc_pair_cost) == 2 * sizeof(uint32_t) + sizeof(double));
  CHECK(sizeof(rayc_vertex_force) == 2 * sizeof(uint32_t) + 3 * sizeof(double));
  CHECK(sizeof(rayc_hit) == 2 * sizeof(uint32_t) + 4 * sizeof(double));
  CHECK(sizeof(rayc_hole) == 2 * sizeof(uint32_t) + sizeof(double));
  CHECK(sizeof(rayc_own_exit) == 2 * sizeof(uint32_t) + 7 * sizeof(double));
}

int main(void) {
  CHECK_OK(rayc_contacts_create(&contacts));
  CHECK_SIZES(rayc_mesh_options, END_OF(rayc_mesh_options, open), rayc_default_mesh_options);
  CHECK_SIZES(rayc_detection_options, END_OF(rayc_detection_options, reserved), rayc_default_detection_options);
  CHECK_SIZES(rayc_response_options, END_OF(rayc_response_options, reserved), rayc_default_response_options);
  CHECK_SIZES(rayc_scene_options, END_OF(rayc_scene_options, threads), rayc_default_scene_options);
  CHECK_SIZES(rayc_contact_system_options, END_OF(rayc_contact_system_options, keeps_rigid_unknowns),
              rayc_default_contact_system_options);
  CHECK_SIZES(rayc_material, END_OF(rayc_material, depth_cap), bearing_material);
  CHECK_SIZES(rayc_statistics, END_OF(rayc_statistics, escapes_forbidden), statistics_of_contacts);
  CHECK_STATUS(rayc_contacts_statistics(contacts, sizeof(rayc_statistics), NULL), RAYC_STATUS_NULL_POINTER,
               "statistics");
  make_escapes();
  CHECK_SIZES(rayc_pair_memory, END_OF(rayc_pair_memory, state), pair_memory_of_scene);
  CHECK_SIZES(rayc_body_state, END_OF(rayc_body_state, reserved), state_of_body);
  CHECK_SIZES(rayc_pair_cost, END_OF(rayc_pair_cost, cost), cost_of_pair);
  CHECK_SIZES(rayc_escape_push, END_OF(rayc_escape_push, area), push_of_contacts);
  arrays_are_written_in_steps_of_the_callers_size();
  CHECK_OK(rayc_scene_destroy(scene));
  older_options_are_read_as_far_as_they_go();
  arrays_elements_have_no_holes();
  structs_have_no_padding_at_the_end();
  CHECK_OK(rayc_contacts_destroy(contacts));
  return check_result();
}
