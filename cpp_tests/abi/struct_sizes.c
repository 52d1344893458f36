/* Structs that grow: a program built with an older header gets what it knows and nothing beyond, one built with a newer
   header than the library's is told so. */
#include <stddef.h>

#include "check.h"
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

/* An options struct of the first version: shorter, with garbage behind it that must not be read. */
static void older_options_are_read_as_far_as_they_go(void) {
  rayc_detection_options options;
  memset(&options, 0xFF, sizeof options);
  CHECK_OK(rayc_default_detection_options(END_OF(rayc_detection_options, escape), &options));
  CHECK(options.struct_size == END_OF(rayc_detection_options, escape));
  rayc_scene* scene = NULL;
  CHECK_OK(rayc_scene_create(NULL, &scene));
  CHECK_OK(rayc_scene_set_detection_options(scene, &options));
  options.struct_size = sizeof options;
  CHECK_STATUS(rayc_scene_set_detection_options(scene, &options), RAYC_STATUS_INVALID_OPTION, "");
  CHECK_OK(rayc_default_detection_options(sizeof options, &options));
  options.reserved = 1;
  CHECK_STATUS(rayc_scene_set_detection_options(scene, &options), RAYC_STATUS_INVALID_OPTION, "reserved");
  CHECK_OK(rayc_scene_destroy(scene));
}

/* Padding at the end would be read as an option once one lies there. */
static void structs_have_no_padding_at_the_end(void) {
  CHECK(END_OF(rayc_mesh_options, open) == sizeof(rayc_mesh_options));
  CHECK(END_OF(rayc_detection_options, force_tolerance) == sizeof(rayc_detection_options));
  CHECK(END_OF(rayc_response_options, whole_body_escape) == sizeof(rayc_response_options));
  CHECK(END_OF(rayc_scene_options, parallel_context) == sizeof(rayc_scene_options));
  CHECK(END_OF(rayc_statistics, crowded_pairs) == sizeof(rayc_statistics));
}

int main(void) {
  CHECK_OK(rayc_contacts_create(&contacts));
  CHECK_SIZES(rayc_mesh_options, END_OF(rayc_mesh_options, open), rayc_default_mesh_options);
  CHECK_SIZES(rayc_detection_options, END_OF(rayc_detection_options, escape), rayc_default_detection_options);
  CHECK_SIZES(rayc_response_options, END_OF(rayc_response_options, whole_body_escape), rayc_default_response_options);
  CHECK_SIZES(rayc_scene_options, END_OF(rayc_scene_options, threads), rayc_default_scene_options);
  CHECK_SIZES(rayc_statistics, END_OF(rayc_statistics, escapes_forbidden), statistics_of_contacts);
  CHECK_STATUS(rayc_contacts_statistics(contacts, sizeof(rayc_statistics), NULL), RAYC_STATUS_NULL_POINTER,
               "statistics");
  older_options_are_read_as_far_as_they_go();
  structs_have_no_padding_at_the_end();
  CHECK_OK(rayc_contacts_destroy(contacts));
  return check_result();
}
