/* NaN and infinity in positions, velocities and displacements: where a contact reads them, the call says in which
   array, body and vertex, and adds nothing; where none does, they do no harm. */
#include "check.h"
#include "shapes.h"

#define NUMBERS (3 * OCTAHEDRON_VERTICES)

static rayc_contacts* contacts;
static rayc_response_options options;
static double values[2][NUMBERS], forces[2][NUMBERS];

typedef enum given { POSITIONS, VELOCITIES, DISPLACEMENTS, POSITIONS_OF_ENERGY } given;
static const char* const names[] = {"positions", "velocities", "displacements", "positions"};

static rayc_status call(given what) {
  const rayc_vectors in[2] = {packed(values[0], OCTAHEDRON_VERTICES), packed(values[1], OCTAHEDRON_VERTICES)};
  const rayc_vectors_mut out[2] = {packed_mut(forces[0], OCTAHEDRON_VERTICES),
                                   packed_mut(forces[1], OCTAHEDRON_VERTICES)};
  double joules = 42;
  switch (what) {
    case POSITIONS:
      return rayc_contacts_add_forces(contacts, &options, 2, in, NULL, out);
    case VELOCITIES:
      return rayc_contacts_add_forces(contacts, &options, 2, NULL, in, out);
    case DISPLACEMENTS:
      return rayc_contacts_add_differential(contacts, &options, 1, 0, 2, in, out);
    default:
      break;
  }
  const rayc_status status = rayc_contacts_energy(contacts, &options, 2, in, &joules);
  CHECK(status == RAYC_STATUS_OK ? isfinite(joules) : joules == 42);
  return status;
}

static int is_read(uint32_t body, uint32_t vertex) {
  size_t count = 0;
  CHECK_OK(rayc_contacts_count(contacts, &count));
  for (size_t at = 0; at < count; ++at) {
    rayc_contact contact;
    CHECK_OK(rayc_contacts_copy(contacts, at, 1, &contact));
    for (int i = 0; i < 3; ++i) {
      if (contact.colliding == body && contact.p1.vertices[i] == vertex) return 1;
      if (contact.collided == body && contact.p2.vertices[i] == vertex) return 1;
    }
  }
  return 0;
}

static void check_all(void) {
  const double bad[] = {NAN, INFINITY, -INFINITY};
  int read = 0, unread = 0;
  for (given what = POSITIONS; what <= POSITIONS_OF_ENERGY; ++what) {
    for (uint32_t number = 0; number < 2 * NUMBERS; ++number) {
      const uint32_t body = number / NUMBERS, vertex = number % NUMBERS / 3;
      double* place = &values[body][number % NUMBERS];
      const double before = *place;
      *place = bad[number % 3];
      memset(forces, 0, sizeof forces);
      if (is_read(body, vertex)) {
        char part[64];
        snprintf(part, sizeof part, "%s[%u]: vertex %u", names[what], (unsigned)body, (unsigned)vertex);
        CHECK_STATUS(call(what), RAYC_STATUS_NOT_FINITE, part);
        for (int i = 0; i < 2 * NUMBERS; ++i) CHECK(forces[i / NUMBERS][i % NUMBERS] == 0);
        ++read;
      } else {
        CHECK_OK(call(what));
        for (int i = 0; i < 2 * NUMBERS; ++i) CHECK(isfinite(forces[i / NUMBERS][i % NUMBERS]));
        ++unread;
      }
      *place = before;
      CHECK_OK(call(what));
    }
  }
  CHECK(read > 0 && unread > 0);
}

static void contacts_say_what_they_cannot_use(void) {
  const double none[3] = {0, 0, 0};
  rayc_mesh *a = octahedron_mesh(none), *b = octahedron_mesh(octahedron_shift);
  rayc_octree *octree_a = NULL, *octree_b = NULL;
  CHECK_OK(rayc_octree_create(NULL, a, &octree_a));
  CHECK_OK(rayc_octree_create(NULL, b, &octree_b));
  const rayc_detection_options detection = from_vertices();
  CHECK_OK(rayc_query_pair(&detection, a, octree_a, b, octree_b, contacts));
  octahedron_shifted(none, values[0]);
  octahedron_shifted(octahedron_shift, values[1]);
  check_all();
  CHECK_OK(rayc_octree_destroy(octree_a));
  CHECK_OK(rayc_octree_destroy(octree_b));
  CHECK_OK(rayc_mesh_destroy(a));
  CHECK_OK(rayc_mesh_destroy(b));
}

/* 1e39 is a number, but no float. */
static void check_beyond_float(void) {
  const double before = values[1][4];
  values[1][4] = 1e39;
  for (given what = POSITIONS; what <= POSITIONS_OF_ENERGY; ++what) {
    char part[64];
    snprintf(part, sizeof part, "%s[1]: vertex 1 has 1e39, beyond 3.4", names[what]);
    memset(forces, 0, sizeof forces);
    CHECK_STATUS(call(what), RAYC_STATUS_MESH_BEYOND_RANGE, part);
    for (int i = 0; i < 2 * NUMBERS; ++i) CHECK(forces[i / NUMBERS][i % NUMBERS] == 0);
  }
  values[1][4] = before;
}

/* Those of an escape: a small octahedron inside a large one. */
static void escapes_say_what_they_cannot_use(uint32_t precision) {
  rayc_scene* scene = NULL;
  rayc_scene_options scene_options;
  rayc_mesh_options mesh_options;
  CHECK_OK(rayc_default_scene_options(sizeof scene_options, &scene_options));
  CHECK_OK(rayc_default_mesh_options(sizeof mesh_options, &mesh_options));
  scene_options.precision = mesh_options.precision = precision;
  CHECK_OK(rayc_scene_create(&scene_options, &scene));
  for (int k = 0; k < 2; ++k) {
    for (int i = 0; i < NUMBERS; ++i) values[k][i] = octahedron_positions[i] * (k == 0 ? 1 : 0.125);
    const rayc_vectors positions = packed(values[k], OCTAHEDRON_VERTICES);
    rayc_mesh* mesh = NULL;
    uint32_t body = 0;
    CHECK_OK(rayc_mesh_create(&mesh_options, &positions, octahedron_triangles, OCTAHEDRON_TRIANGLES, &mesh));
    CHECK_OK(rayc_scene_add_mesh(scene, mesh, &body));
    CHECK_OK(rayc_mesh_destroy(mesh));
  }
  CHECK_OK(rayc_scene_query(scene, contacts));
  check_all();
  if (precision == RAYC_SCALAR_F32) check_beyond_float();
  CHECK_OK(rayc_scene_destroy(scene));
}

int main(void) {
  CHECK_OK(rayc_contacts_create(&contacts));
  CHECK_OK(rayc_default_response_options(sizeof options, &options));
  contacts_say_what_they_cannot_use();
  escapes_say_what_they_cannot_use(RAYC_SCALAR_F64);
  escapes_say_what_they_cannot_use(RAYC_SCALAR_F32);
  CHECK_OK(rayc_contacts_destroy(contacts));
  return check_result();
}
