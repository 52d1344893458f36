/* The number of a body that was removed is refused, and no other body gets it before the host says that it has done
   with it: rayc_scene_release_body_numbers(). */
#include "check.h"
#include "shapes.h"

#define CYCLES 140000

static const double no_shift[3] = {0, 0, 0};

static uint32_t add(rayc_scene* scene, const double shift[3]) {
  rayc_mesh* mesh = octahedron_mesh(shift);
  uint32_t body = UINT32_MAX;
  CHECK_OK(rayc_scene_add_mesh(scene, mesh, &body));
  CHECK_OK(rayc_mesh_destroy(mesh));
  return body;
}

static void check_unknown(rayc_scene* scene, uint32_t body, uint32_t other) {
  double data[3 * OCTAHEDRON_VERTICES];
  octahedron_shifted(no_shift, data);
  const rayc_vectors positions = packed(data, OCTAHEDRON_VERTICES);
  uint32_t allowed = 42;
  CHECK_STATUS(rayc_scene_remove_body(scene, body), RAYC_STATUS_UNKNOWN_BODY, "removed");
  CHECK_STATUS(rayc_scene_set_positions(scene, body, &positions), RAYC_STATUS_UNKNOWN_BODY, "removed");
  CHECK_STATUS(rayc_scene_set_self_collision(scene, body, 1), RAYC_STATUS_UNKNOWN_BODY, "removed");
  CHECK_STATUS(rayc_scene_set_pair_collision(scene, body, other, 0), RAYC_STATUS_UNKNOWN_BODY, "removed");
  CHECK_STATUS(rayc_scene_allow_escape(scene, other, body, 0), RAYC_STATUS_UNKNOWN_BODY, "removed");
  CHECK_STATUS(rayc_scene_may_escape(scene, body, other, &allowed), RAYC_STATUS_UNKNOWN_BODY, "removed");
  CHECK(allowed == 42);
}

static void a_removed_number_is_refused(void) {
  rayc_scene* scene = NULL;
  rayc_contacts* contacts = NULL;
  CHECK_OK(rayc_scene_create(NULL, &scene));
  CHECK_OK(rayc_contacts_create(&contacts));
  CHECK(add(scene, no_shift) == 0 && add(scene, octahedron_shift) == 1);
  CHECK_OK(rayc_scene_remove_body(scene, 0));
  const uint32_t third = add(scene, no_shift);
  CHECK(third == 2);
  check_unknown(scene, 0, 1);

  /* Contacts name the bodies that are there, and forces lie in arrays by these numbers. */
  size_t count = 0;
  CHECK_OK(rayc_scene_query(scene, contacts));
  CHECK_OK(rayc_contacts_count(contacts, &count));
  CHECK(count > 0);
  for (size_t at = 0; at < count; ++at) {
    rayc_contact contact;
    CHECK_OK(rayc_contacts_copy(contacts, at, 1, &contact));
    CHECK(contact.colliding + contact.collided == 1 + third);
  }
  double forces[3][3 * OCTAHEDRON_VERTICES];
  memset(forces, 0, sizeof forces);
  const rayc_vectors_mut out[3] = {packed_mut(NULL, 0), packed_mut(forces[1], OCTAHEDRON_VERTICES),
                                   packed_mut(forces[2], OCTAHEDRON_VERTICES)};
  CHECK_OK(rayc_contacts_add_forces(contacts, NULL, 3, NULL, NULL, out));
  double along_x[3] = {0, 0, 0};
  for (int i = 0; i < OCTAHEDRON_VERTICES; ++i) {
    along_x[1] += forces[1][3 * i];
    along_x[2] += forces[2][3 * i];
  }
  CHECK(along_x[1] > 0);
  CHECK_NEAR(along_x[1] + along_x[2], 0, 1e-13);
  CHECK_OK(rayc_scene_destroy(scene));
  CHECK_OK(rayc_contacts_destroy(contacts));
}

static void a_number_is_given_once(void) {
  rayc_scene* scene = NULL;
  CHECK_OK(rayc_scene_create(NULL, &scene));
  uint32_t present[3] = {add(scene, no_shift), add(scene, no_shift), add(scene, no_shift)};
  for (uint32_t cycle = 0; cycle < CYCLES && check_failures == 0; ++cycle) {
    const uint32_t gone = present[cycle % 3];
    CHECK_OK(rayc_scene_remove_body(scene, gone));
    present[cycle % 3] = add(scene, no_shift);
    CHECK(present[cycle % 3] == 3 + cycle);
    CHECK_STATUS(rayc_scene_remove_body(scene, gone), RAYC_STATUS_UNKNOWN_BODY, "removed");
  }
  CHECK_STATUS(rayc_scene_remove_body(scene, 0), RAYC_STATUS_UNKNOWN_BODY, "removed");
  CHECK_OK(rayc_scene_destroy(scene));
}

/* A host that releases the numbers it has done with gets them again, and no others. */
static void released_numbers_come_back(void) {
  rayc_scene* scene = NULL;
  CHECK_OK(rayc_scene_create(NULL, &scene));
  for (uint32_t i = 0; i < 6; ++i) CHECK(add(scene, no_shift) == i);
  const uint32_t first[3] = {4, 1, 3};
  for (int i = 0; i < 3; ++i) CHECK_OK(rayc_scene_remove_body(scene, first[i]));
  CHECK_OK(rayc_scene_release_body_numbers(scene));
  CHECK_STATUS(rayc_scene_remove_body(scene, 3), RAYC_STATUS_UNKNOWN_BODY, "removed");
  CHECK(add(scene, no_shift) == 1);
  CHECK_OK(rayc_scene_remove_body(scene, 0)); /* after the release: not to be given again */
  CHECK(add(scene, no_shift) == 3 && add(scene, no_shift) == 4 && add(scene, no_shift) == 6);
  /* The last numbers of all are given anew too. */
  for (uint32_t body = 3; body < 7; ++body) CHECK_OK(rayc_scene_remove_body(scene, body));
  CHECK_OK(rayc_scene_release_body_numbers(scene));
  CHECK_OK(rayc_scene_release_body_numbers(scene));
  CHECK(add(scene, no_shift) == 0 && add(scene, no_shift) == 3 && add(scene, no_shift) == 4);
  CHECK_OK(rayc_scene_destroy(scene));
}

/* So numbers stay small, however many bodies come and go. */
static void released_numbers_stay_small(void) {
  rayc_scene* scene = NULL;
  CHECK_OK(rayc_scene_create(NULL, &scene));
  uint32_t present[3] = {add(scene, no_shift), add(scene, no_shift), add(scene, no_shift)};
  for (uint32_t cycle = 0; cycle < CYCLES && check_failures == 0; ++cycle) {
    CHECK_OK(rayc_scene_remove_body(scene, present[cycle * 7 % 3]));
    if (cycle % 100 == 0) CHECK_OK(rayc_scene_release_body_numbers(scene));
    present[cycle * 7 % 3] = add(scene, no_shift);
    CHECK(present[cycle * 7 % 3] < 3 + 100);
  }
  CHECK_OK(rayc_scene_destroy(scene));
}

int main(void) {
  a_removed_number_is_refused();
  a_number_is_given_once();
  released_numbers_come_back();
  released_numbers_stay_small();
  return check_result();
}
