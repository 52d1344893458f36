/* Two overlapping octahedra, where every number of the answer is known in closed form, given as double, as float and
   with a stride, to meshes of either precision. */
#include "check.h"
#include "shapes.h"

static const double no_shift[3] = {0, 0, 0};
#define RSQRT3 0.57735026918962576451

typedef struct query {
  rayc_mesh* meshes[2];
  rayc_octree* octrees[2];
  rayc_contacts* contacts;
} query;

static query make_query(uint32_t precision, const rayc_vectors* first, const rayc_vectors* second) {
  query q = {{NULL, NULL}, {NULL, NULL}, NULL};
  rayc_mesh_options options;
  CHECK_OK(rayc_default_mesh_options(sizeof options, &options));
  options.precision = precision;
  const rayc_vectors* const vectors[2] = {first, second};
  for (int i = 0; i < 2; ++i) {
    CHECK_OK(rayc_mesh_create(&options, vectors[i], octahedron_triangles, OCTAHEDRON_TRIANGLES, &q.meshes[i]));
    CHECK_OK(rayc_octree_create(NULL, q.meshes[i], &q.octrees[i]));
  }
  CHECK_OK(rayc_contacts_create(&q.contacts));
  const rayc_detection_options detection = from_vertices();
  CHECK_OK(rayc_query_pair(&detection, q.meshes[0], q.octrees[0], q.meshes[1], q.octrees[1], q.contacts));
  return q;
}

static void destroy_query(query* q) {
  for (int i = 0; i < 2; ++i) {
    CHECK_OK(rayc_octree_destroy(q->octrees[i]));
    CHECK_OK(rayc_mesh_destroy(q->meshes[i]));
  }
  CHECK_OK(rayc_contacts_destroy(q->contacts));
}

/* Weight of `vertex` at a surface point; 0 when it is not a corner. */
static double weight_of(const rayc_surface_point* point, uint32_t vertex) {
  for (int i = 0; i < 3; ++i) {
    if (point->vertices[i] == vertex) {
      return point->weights[i];
    }
  }
  return 0;
}

/* The ray starts at `vertex` of the colliding mesh at `p1`, runs along sign * x, and ends on the corners
   `target[0..3]` with weights that repeat the shift. */
static void check_contact(const rayc_contact* contact, uint32_t colliding, uint32_t vertex, const double p1[3],
                          double sign, const uint32_t target[3], double tolerance) {
  const double weights[3] = {0.8125, 0.125, 0.0625};
  CHECK(contact->colliding == colliding);
  CHECK(contact->collided == 1 - colliding);
  CHECK(contact->p1.vertices[0] == vertex);
  CHECK_NEAR(contact->p1.weights[0], 1, tolerance);
  CHECK_NEAR(contact->depth, SHIFTED_DEPTH, tolerance);
  CHECK_NEAR(contact->cos_alpha, RSQRT3, tolerance);
  CHECK_NEAR(contact->area, RSQRT3,
             tolerance); /* four triangles of sqrt(3)/2: a third, and half as the load is shared */
  for (int i = 0; i < 3; ++i) {
    const double along = i == 0 ? sign : 0;
    CHECK_NEAR(contact->direction[i], along, tolerance);
    CHECK_NEAR(contact->p1.position[i], p1[i], tolerance);
    CHECK_NEAR(contact->p2.position[i], p1[i] + along * SHIFTED_DEPTH, tolerance);
    CHECK_NEAR(weight_of(&contact->p2, target[i]), weights[i], tolerance);
  }
}

static void check_contacts(const query* q, rayc_contact out[2], double tolerance) {
  static const uint32_t negative_corners[3] = {1, 3, 5}, positive_corners[3] = {0, 2, 4};
  static const double first_tip[3] = {1, 0, 0}, second_tip[3] = {0.5, 0.125, 0.0625};
  size_t count = 0;
  CHECK_OK(rayc_contacts_count(q->contacts, &count));
  CHECK(count == 2);
  if (count != 2) {
    return;
  }
  memset(out, 0, 2 * sizeof *out);
  CHECK_OK(rayc_contacts_copy(q->contacts, 0, 2, out));
  check_contact(&out[0], 0, 0, first_tip, -1, negative_corners, tolerance);
  check_contact(&out[1], 1, 1, second_tip, 1, positive_corners, tolerance);

  rayc_contact second;
  CHECK_OK(rayc_contacts_copy(q->contacts, 1, 1, &second));
  CHECK(second.colliding == 1);
  CHECK_STATUS(rayc_contacts_copy(q->contacts, 1, 2, out), RAYC_STATUS_WRONG_COUNT, "2");
  CHECK_STATUS(rayc_contacts_copy(q->contacts, 0, 1, NULL), RAYC_STATUS_NULL_POINTER, NULL);

  rayc_statistics statistics;
  CHECK_OK(rayc_contacts_statistics(q->contacts, sizeof statistics, &statistics));
  CHECK(statistics.contacts == 2);
  CHECK(statistics.rays ==
        statistics.contacts + statistics.misses + statistics.entry_hits + statistics.own_surface_hits);
}

static int equal(const rayc_contact* a, const rayc_contact* b) {
  return a->colliding == b->colliding && a->collided == b->collided && a->depth == b->depth &&
         a->cos_alpha == b->cos_alpha && a->area == b->area && a->p1.triangle == b->p1.triangle &&
         a->p2.triangle == b->p2.triangle && memcmp(a->p1.weights, b->p1.weights, sizeof a->p1.weights) == 0 &&
         memcmp(a->p2.weights, b->p2.weights, sizeof a->p2.weights) == 0 &&
         memcmp(a->p2.position, b->p2.position, sizeof a->p2.position) == 0 &&
         memcmp(a->direction, b->direction, sizeof a->direction) == 0;
}

/* A host's own vertex: the position lies between other things, which must never be read as positions. */
typedef struct host_vertex {
  float mass;
  float position[3];
  float other[5];
} host_vertex;

int main(void) {
  double first[3 * OCTAHEDRON_VERTICES], second[3 * OCTAHEDRON_VERTICES];
  float first_float[3 * OCTAHEDRON_VERTICES];
  host_vertex second_strided[OCTAHEDRON_VERTICES];
  octahedron_shifted(no_shift, first);
  octahedron_shifted(octahedron_shift, second);
  memset(second_strided, 0xff, sizeof second_strided); /* NaN everywhere else */
  for (size_t i = 0; i < 3 * OCTAHEDRON_VERTICES; ++i) {
    first_float[i] = (float)first[i];
    second_strided[i / 3].position[i % 3] = (float)second[i];
  }
  const rayc_vectors doubles[2] = {packed(first, OCTAHEDRON_VERTICES), packed(second, OCTAHEDRON_VERTICES)};
  const rayc_vectors floats[2] = {
      {first_float, OCTAHEDRON_VERTICES, 0, RAYC_SCALAR_F32},
      {second_strided[0].position, OCTAHEDRON_VERTICES, sizeof(host_vertex), RAYC_SCALAR_F32},
  };

  rayc_contact from_doubles[2], from_floats[2], in_float[2];
  query q = make_query(RAYC_SCALAR_F64, &doubles[0], &doubles[1]);
  check_contacts(&q, from_doubles, 1e-14);
  destroy_query(&q);

  q = make_query(RAYC_SCALAR_F64, &floats[0], &floats[1]);
  check_contacts(&q, from_floats, 1e-14);
  destroy_query(&q);
  CHECK(equal(&from_doubles[0], &from_floats[0]));
  CHECK(equal(&from_doubles[1], &from_floats[1]));

  q = make_query(RAYC_SCALAR_F32, &doubles[0], &floats[1]);
  check_contacts(&q, in_float, 1e-6);
  destroy_query(&q);
  return check_result();
}
