/* NaN and infinity in positions, velocities and displacements: where a contact reads them, the call says in which
   array, body and vertex, and adds nothing; where none does, they do no harm. So with finite numbers that give none, and
   with arrays that share memory. */
#include "check.h"
#include "raycontact/distributed.h"
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

/* What is added to may not be what is read, wholly or in part; members of one struct may lie between one another. */
static void check_shared(void) {
  typedef struct vertex {
    double velocity[3], force[3];
  } vertex;
  static vertex vertices[2][OCTAHEDRON_VERTICES];
  static double before[2][NUMBERS];
  memset(forces, 0, sizeof forces);
  CHECK_OK(call(VELOCITIES));
  memcpy(before, values, sizeof before);
  for (int shift = 0; shift < NUMBERS; ++shift) {
    rayc_vectors in[2] = {packed(values[0], OCTAHEDRON_VERTICES), packed(values[1], OCTAHEDRON_VERTICES)};
    rayc_vectors_mut out[2] = {packed_mut(forces[0], OCTAHEDRON_VERTICES),
                               packed_mut(values[1] + shift, OCTAHEDRON_VERTICES - (shift + 2) / 3)};
    if (out[1].count == 0) break;
    CHECK_STATUS(rayc_contacts_add_forces(contacts, &options, 2, NULL, in, out), RAYC_STATUS_INVALID_OPTION,
                 "velocities of body 1 and forces of body 1 share memory");
    CHECK_STATUS(rayc_contacts_add_forces(contacts, &options, 2, in, NULL, out), RAYC_STATUS_INVALID_OPTION,
                 "positions of body 1 and forces of body 1 share memory");
    CHECK_STATUS(rayc_contacts_add_differential(contacts, &options, 1, 0, 2, in, out), RAYC_STATUS_INVALID_OPTION,
                 "displacements of body 1 and forces of body 1 share memory");
    const rayc_vectors turned[2] = {in[1], in[0]};
    CHECK_STATUS(rayc_contacts_add_forces(contacts, &options, 2, NULL, turned, out), RAYC_STATUS_INVALID_OPTION,
                 "velocities of body 0 and forces of body 1 share memory");
  }
  CHECK(memcmp(before, values, sizeof before) == 0);

  rayc_vectors in[2];
  rayc_vectors_mut out[2];
  for (int body = 0; body < 2; ++body) {
    for (int i = 0; i < NUMBERS; ++i) vertices[body][i / 3].velocity[i % 3] = values[body][i];
    in[body] = packed(vertices[body][0].velocity, OCTAHEDRON_VERTICES);
    out[body] = packed_mut(vertices[body][0].force, OCTAHEDRON_VERTICES);
    in[body].stride = out[body].stride = sizeof(vertex);
  }
  CHECK_OK(rayc_contacts_add_forces(contacts, &options, 2, NULL, in, out));
  for (int i = 0; i < 2 * NUMBERS; ++i)
    CHECK(vertices[i / NUMBERS][i % NUMBERS / 3].force[i % 3] == forces[i / NUMBERS][i % NUMBERS]);
  out[0].data = vertices[0][0].velocity + 1;
  CHECK_STATUS(rayc_contacts_add_forces(contacts, &options, 2, NULL, in, out), RAYC_STATUS_INVALID_OPTION,
               "velocities of body 0 and forces of body 0 share memory");
}

/* Finite stiffnesses, damping times and positions give finite numbers, or are refused and nothing is added. */
static void check_decades(void) {
  const rayc_response_options before = options;
  uint32_t vertex = 0;
  while (vertex + 1 < OCTAHEDRON_VERTICES && !is_read(1, vertex)) ++vertex;
  double* place = &values[1][3 * vertex];
  for (int number = 0; number < 3; ++number) {
    int taken = 0, refused = 0;
    for (int exponent = -300; exponent <= 308; exponent += 4) {
      const double value = pow(10, exponent);
      options = before;
      if (number == 0) options.stiffness = value;
      if (number == 1) options.damping_time = value;
      const double kept = *place;
      if (number == 2) *place = value;
      for (given what = POSITIONS; what <= POSITIONS_OF_ENERGY; ++what) {
        memset(forces, 0, sizeof forces);
        const rayc_status status = call(what);
        double sum = 0;
        for (int i = 0; i < 2 * NUMBERS; ++i) sum += fabs(forces[i / NUMBERS][i % NUMBERS]);
        CHECK(isfinite(sum) && (status == RAYC_STATUS_OK || sum == 0));
        ++*(status == RAYC_STATUS_OK ? &taken : &refused);
        size_t count = 0, pairs = 0, all = 0;
        CHECK_OK(rayc_contacts_count(contacts, &count));
        double coefficient = 42;
        const rayc_status copied = rayc_contacts_copy_coefficients(contacts, &options, 0, 1, &coefficient);
        CHECK(count > 0 && (copied == RAYC_STATUS_OK ? isfinite(coefficient) : coefficient == 42));
        const rayc_status summed =
            rayc_contacts_sum_pair_forces(contacts, &options, 0, NULL, NULL, &pairs, &all);
        if (summed != RAYC_STATUS_OK) continue;
        rayc_pair_forces of_pair[2];
        rayc_vertex_force at[8 * OCTAHEDRON_VERTICES];
        CHECK(pairs <= 2 && all <= 8 * OCTAHEDRON_VERTICES);
        CHECK_OK(rayc_contacts_copy_pair_forces(contacts, pairs, of_pair, all, at));
        for (size_t i = 0; i < all; ++i) CHECK(isfinite(at[i].force[0] + at[i].force[1] + at[i].force[2]));
      }
      *place = kept;
    }
    CHECK(taken > 300 && refused > 0);
  }
  options = before;
  options.stiffness = 1e300;
  const double kept = *place;
  *place = 1e9;
  CHECK_STATUS(call(POSITIONS), RAYC_STATUS_INVALID_OPTION, "give a smaller stiffness");
  *place = kept;
  options = before;
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
  check_shared();
  check_decades();
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
