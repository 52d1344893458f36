/* The number of a body that was removed is no other body's at once: it is refused, until tens of thousands of others
   have been removed after it. So numbers stay small, however many bodies come and go. */
#include "check.h"
#include "shapes.h"

#define BETWEEN 65536 /* as rayc_scene_add_mesh() says */
#define CYCLES 140000
#define MOST_NUMBERS (BETWEEN + 3)

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

static void numbers_rest_and_stay_small(void) {
  rayc_scene* scene = NULL;
  CHECK_OK(rayc_scene_create(NULL, &scene));
  static int removed_at[MOST_NUMBERS];
  int removed = 0, used_again = 0;
  for (int i = 0; i < MOST_NUMBERS; ++i) removed_at[i] = -1;
  uint32_t present[3] = {add(scene, no_shift), add(scene, no_shift), add(scene, no_shift)};
  for (int cycle = 0; cycle < CYCLES && check_failures == 0; ++cycle) {
    const int which = cycle * 7 % 3;
    const uint32_t gone = present[which];
    CHECK_OK(rayc_scene_remove_body(scene, gone));
    removed_at[gone] = removed++;
    present[which] = add(scene, no_shift);
    CHECK(present[which] < MOST_NUMBERS);
    if (present[which] >= MOST_NUMBERS) break;
    const int before = removed_at[present[which]];
    if (before >= 0) {
      CHECK(removed - 1 - before >= BETWEEN);
      ++used_again;
    }
    removed_at[present[which]] = -1;
    CHECK_STATUS(rayc_scene_remove_body(scene, gone), RAYC_STATUS_UNKNOWN_BODY, "removed");
  }
  CHECK(used_again > CYCLES / 2);
  CHECK_OK(rayc_scene_destroy(scene));
}

int main(void) {
  a_removed_number_is_refused();
  numbers_rest_and_stay_small();
  return check_result();
}
