/* Both layouts of an octree give the same hits, nearest points and contacts, byte by byte, and ids tell contacts apart,
   from step to step too. */
#include <stdlib.h>

#include "check.h"
#include "shapes.h"

#define RAYS 200
#define MOST_CONTACTS 4096

static rayc_octree* octree_with(uint32_t layout, const rayc_mesh* mesh) {
  rayc_octree_options options;
  CHECK_OK(rayc_default_octree_options(sizeof options, &options));
  CHECK(options.layout == RAYC_OCTREE_LAYOUT_WIDE);
  options.layout = layout;
  rayc_octree* octree = NULL;
  CHECK_OK(rayc_octree_create(&options, mesh, &octree));
  return octree;
}

static int by_id(const void* a, const void* b) {
  const uint64_t first = ((const rayc_contact*)a)->id, second = ((const rayc_contact*)b)->id;
  return first < second ? -1 : first > second;
}

static size_t contacts_of(uint32_t layout, rayc_mesh* const meshes[2], rayc_contact* list) {
  rayc_octree* octrees[2] = {octree_with(layout, meshes[0]), octree_with(layout, meshes[1])};
  rayc_contacts* contacts = NULL;
  size_t count = 0;
  CHECK_OK(rayc_contacts_create(&contacts));
  CHECK_OK(rayc_query_pair(NULL, meshes[0], octrees[0], meshes[1], octrees[1], contacts));
  CHECK_OK(rayc_contacts_count(contacts, &count));
  CHECK(count > 20 && count <= MOST_CONTACTS);
  CHECK_OK(rayc_contacts_copy(contacts, 0, count, list));
  qsort(list, count, sizeof *list, by_id);
  for (size_t i = 1; i < count; ++i) CHECK(list[i - 1].id != list[i].id);
  CHECK_OK(rayc_contacts_destroy(contacts));
  for (int i = 0; i < 2; ++i) CHECK_OK(rayc_octree_destroy(octrees[i]));
  return count;
}

static void rays_and_points_agree(const rayc_mesh* mesh) {
  static rayc_ray rays[RAYS];
  static double points[3 * RAYS];
  static rayc_hit hits[2][RAYS];
  static rayc_closest_point closest[2][RAYS];
  for (int i = 0; i < RAYS; ++i) {
    rays[i].t_max = INFINITY;
    for (int axis = 0; axis < 3; ++axis) {
      rays[i].origin[axis] = points[3 * i + axis] = 1.5 * sin(1.0 + 7.3 * i + 2.1 * axis);
      rays[i].direction[axis] = 0.6 * cos(3.0 + 5.9 * i + 1.7 * axis) - points[3 * i + axis];
    }
  }
  const rayc_vectors asked = packed(points, RAYS);
  int found = 0;
  for (int k = 0; k < 2; ++k) {
    rayc_octree* octree = octree_with(k == 0 ? RAYC_OCTREE_LAYOUT_WIDE : RAYC_OCTREE_LAYOUT_CLASSIC, mesh);
    CHECK_OK(rayc_octree_trace_rays(octree, mesh, rays, RAYS, hits[k]));
    CHECK_OK(rayc_octree_closest_points(octree, mesh, &asked, NULL, closest[k]));
    CHECK_OK(rayc_octree_destroy(octree));
  }
  for (int i = 0; i < RAYS; ++i) found += hits[0][i].triangle != RAYC_NO_TRIANGLE;
  CHECK(found > RAYS / 4 && found < RAYS);
  CHECK(memcmp(hits[0], hits[1], sizeof hits[0]) == 0);
  CHECK(memcmp(closest[0], closest[1], sizeof closest[0]) == 0);
}

int main(void) {
  static rayc_contact lists[3][MOST_CONTACTS];
  const double no_shift[3] = {0, 0, 0};
  rayc_mesh* const meshes[2] = {octahedron_mesh(no_shift), octahedron_mesh(octahedron_shift)};
  rays_and_points_agree(meshes[0]);
  const size_t count = contacts_of(RAYC_OCTREE_LAYOUT_WIDE, meshes, lists[0]);
  CHECK(contacts_of(RAYC_OCTREE_LAYOUT_CLASSIC, meshes, lists[1]) == count);
  CHECK(memcmp(lists[0], lists[1], count * sizeof lists[0][0]) == 0);

  /* A little farther on, most contacts are there still: each has kept its id, and its point of the surface. */
  double positions[3 * OCTAHEDRON_VERTICES];
  const double farther[3] = {octahedron_shift[0] + 0.01, octahedron_shift[1], octahedron_shift[2] - 0.005};
  octahedron_shifted(farther, positions);
  const rayc_vectors vectors = packed(positions, OCTAHEDRON_VERTICES);
  CHECK_OK(rayc_mesh_set_positions(meshes[1], &vectors));
  const size_t later = contacts_of(RAYC_OCTREE_LAYOUT_WIDE, meshes, lists[2]);
  size_t kept = 0;
  for (size_t i = 0; i < later; ++i) {
    const rayc_contact* was = bsearch(&lists[2][i], lists[0], count, sizeof *was, by_id);
    if (was == NULL) continue;
    ++kept;
    CHECK(was->colliding == lists[2][i].colliding && was->piece == lists[2][i].piece);
    CHECK(was->p1.triangle == lists[2][i].p1.triangle);
  }
  CHECK(2 * kept > count);

  /* What is no layout. */
  rayc_octree_options options;
  CHECK_OK(rayc_default_octree_options(sizeof options, &options));
  options.layout = 3;
  rayc_octree* octree = NULL;
  CHECK_STATUS(rayc_octree_create(&options, meshes[0], &octree), RAYC_STATUS_UNKNOWN_ENUM, "rayc_octree_layout");
  options.layout = RAYC_OCTREE_LAYOUT_CLASSIC;
  options.reserved = 7;
  CHECK_STATUS(rayc_octree_create(&options, meshes[0], &octree), RAYC_STATUS_INVALID_OPTION, "reserved");
  CHECK(octree == NULL);
  for (int i = 0; i < 2; ++i) CHECK_OK(rayc_mesh_destroy(meshes[i]));
  return check_result();
}
