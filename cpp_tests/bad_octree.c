/* An octree that does not fit its mesh is refused, and the contacts of the last query stay. */
#include "check.h"
#include "shapes.h"

static rayc_detection_options detection;

static const double no_shift[3] = {0, 0, 0};
static const double far_away[3] = {100, 0, 0};

int main(void) {
  detection = from_vertices();
  rayc_mesh *a = octahedron_mesh(no_shift), *b = octahedron_mesh(octahedron_shift);
  rayc_octree *octree_a = NULL, *octree_b = NULL;
  rayc_contacts* contacts = NULL;
  CHECK_OK(rayc_octree_create(NULL, a, &octree_a));
  CHECK_OK(rayc_octree_create(NULL, b, &octree_b));
  CHECK_OK(rayc_contacts_create(&contacts));
  CHECK_OK(rayc_query_pair(&detection, a, octree_a, b, octree_b, contacts));
  size_t count = 0;
  CHECK_OK(rayc_contacts_count(contacts, &count));
  CHECK(count == 2);

  /* Older than its mesh's positions, first for one mesh, then for the other. */
  const rayc_ray ray = {{-2, 0.1, 0.1}, {1, 0, 0}, 10};
  rayc_hit hit = {42, 42, 42, {42, 42, 42}};
  double positions[3 * OCTAHEDRON_VERTICES];
  octahedron_shifted(far_away, positions);
  const rayc_vectors vectors = packed(positions, OCTAHEDRON_VERTICES);
  CHECK_OK(rayc_mesh_set_positions(a, &vectors));
  CHECK_STATUS(rayc_query_pair(&detection, a, octree_a, b, octree_b, contacts), RAYC_STATUS_OCTREE_STALE,
               "older than its mesh");
  CHECK_STATUS(rayc_query_pair(&detection, b, octree_b, a, octree_a, contacts), RAYC_STATUS_OCTREE_STALE,
               "older than its mesh");
  CHECK_STATUS(rayc_octree_trace_ray(octree_a, a, &ray, &hit), RAYC_STATUS_OCTREE_STALE, "older than its mesh");
  CHECK_STATUS(rayc_octree_trace_rays(octree_a, a, &ray, 1, &hit), RAYC_STATUS_OCTREE_STALE, "older than its mesh");
  CHECK(hit.triangle == 42 && hit.is_exit == 42 && hit.t == 42);
  count = 0;
  CHECK_OK(rayc_contacts_count(contacts, &count));
  CHECK(count == 2);

  /* Updated, it is good again. */
  CHECK_OK(rayc_octree_update(octree_a, a));
  CHECK_OK(rayc_query_pair(&detection, a, octree_a, b, octree_b, contacts));
  CHECK_OK(rayc_contacts_count(contacts, &count));
  CHECK(count == 0);

  /* Another mesh's octree. */
  CHECK_STATUS(rayc_query_pair(&detection, a, octree_b, b, octree_a, contacts), RAYC_STATUS_OCTREE_OF_OTHER_MESH,
               "octree");
  CHECK_STATUS(rayc_octree_trace_ray(octree_b, a, &ray, &hit), RAYC_STATUS_OCTREE_OF_OTHER_MESH, "octree");
  CHECK_STATUS(rayc_octree_update(octree_b, a), RAYC_STATUS_OCTREE_OF_OTHER_MESH, "octree");

  /* Two precisions in one query. */
  rayc_mesh_options options;
  CHECK_OK(rayc_default_mesh_options(sizeof options, &options));
  options.precision = RAYC_SCALAR_F32;
  rayc_mesh* single = NULL;
  rayc_octree* octree_single = NULL;
  CHECK_OK(rayc_mesh_create(&options, &vectors, octahedron_triangles, OCTAHEDRON_TRIANGLES, &single));
  CHECK_OK(rayc_octree_create(NULL, single, &octree_single));
  CHECK_STATUS(rayc_query_pair(&detection, a, octree_a, single, octree_single, contacts),
               RAYC_STATUS_PRECISION_MISMATCH, "precision");

  /* Rays of doubles that are no floats: their numbers end beyond all floats, or their directions at zero. */
  const rayc_ray wide[] = {{{-2, 0.1, 0.1}, {1, 0, 0}, 1e300},
                           {{-2, 0.1, -1e39}, {1, 0, 0}, 10},
                           {{-2, 0, 0}, {1e39, 0, 0}, 10},
                           {{-2, 0, 0}, {1e-60, 0, 1e-80}, 10}};
  const uint32_t refused[] = {RAYC_STATUS_OK, RAYC_STATUS_MESH_BEYOND_RANGE, RAYC_STATUS_MESH_BEYOND_RANGE,
                              RAYC_STATUS_INVALID_OPTION};
  const char* const parts[] = {NULL, "ray 1: its origin has -1e39, beyond 3.4",
                               "ray 1: its direction has 1e39, beyond 3.4", "ray 1: its direction is zero"};
  for (int i = 0; i < 4; ++i) {
    const rayc_ray both[] = {ray, wide[i]};
    rayc_hit hits[2] = {hit, hit};
    CHECK_STATUS(rayc_octree_trace_rays(octree_single, single, both, 2, hits), refused[i], parts[i]);
    CHECK(i == 0 || (hits[0].t == 42 && hits[1].t == 42));
    CHECK_OK(rayc_octree_trace_rays(octree_a, a, both, 2, hits));
    CHECK(hits[0].t != 42 && hits[1].t != 42);
  }

  CHECK_OK(rayc_octree_destroy(octree_single));
  CHECK_OK(rayc_mesh_destroy(single));
  CHECK_OK(rayc_contacts_destroy(contacts));
  CHECK_OK(rayc_octree_destroy(octree_a));
  CHECK_OK(rayc_octree_destroy(octree_b));
  CHECK_OK(rayc_mesh_destroy(a));
  CHECK_OK(rayc_mesh_destroy(b));
  return check_result();
}
