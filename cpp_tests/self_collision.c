/* One mesh of two octahedra, which overlap as those of query_pair.c do: the contacts of that pair are contacts of the
   body with itself, alone and in a scene. */
#include "check.h"
#include "shapes.h"

#define VERTICES (2 * OCTAHEDRON_VERTICES)
#define TRIANGLES (2 * OCTAHEDRON_TRIANGLES)

static rayc_mesh* two_lobes(void) {
  static const double no_shift[3] = {0, 0, 0};
  double positions[3 * VERTICES];
  uint32_t triangles[3 * TRIANGLES];
  octahedron_shifted(no_shift, positions);
  octahedron_shifted(octahedron_shift, positions + 3 * OCTAHEDRON_VERTICES);
  for (uint32_t i = 0; i < 3 * OCTAHEDRON_TRIANGLES; ++i) {
    triangles[i] = octahedron_triangles[i];
    triangles[3 * OCTAHEDRON_TRIANGLES + i] = octahedron_triangles[i] + OCTAHEDRON_VERTICES;
  }
  const rayc_vectors vectors = packed(positions, VERTICES);
  rayc_mesh* mesh = NULL;
  CHECK_OK(rayc_mesh_create(NULL, &vectors, triangles, TRIANGLES, &mesh));
  return mesh;
}

static void check_contacts(const rayc_contacts* contacts, uint32_t body) {
  static const uint32_t from[2] = {0, OCTAHEDRON_VERTICES + 1};
  rayc_contact found[2];
  rayc_statistics statistics;
  size_t count = 0;
  CHECK_OK(rayc_contacts_count(contacts, &count));
  CHECK(count == 2);
  if (count != 2) {
    return;
  }
  CHECK_OK(rayc_contacts_copy(contacts, 0, 2, found));
  for (int i = 0; i < 2; ++i) {
    CHECK(found[i].kind == RAYC_CONTACT_KIND_RAY);
    CHECK(found[i].colliding == body && found[i].collided == body);
    CHECK(found[i].p1.vertices[0] == from[i]);
    CHECK_NEAR(found[i].depth, SHIFTED_DEPTH, 1e-14);
    CHECK_NEAR(found[i].direction[0], i == 0 ? -1 : 1, 1e-14);
  }
  CHECK_OK(rayc_contacts_statistics(contacts, sizeof statistics, &statistics));
  CHECK(statistics.contacts == 2 && statistics.self_contacts == 2);
  CHECK(statistics.past_folds == 0);
}

static void check_forces(const rayc_contacts* contacts) {
  double forces[3 * VERTICES] = {0}, sum[3] = {0, 0, 0};
  const rayc_vectors_mut out = packed_mut(forces, VERTICES);
  CHECK_OK(rayc_contacts_add_forces(contacts, NULL, 1, NULL, NULL, &out));
  for (int i = 0; i < 3 * VERTICES; ++i) {
    sum[i % 3] += forces[i];
  }
  CHECK(forces[0] < -0.01); /* the tip of the first is pulled out of the second */
  for (int i = 0; i < 3; ++i) {
    CHECK_NEAR(sum[i], 0, 1e-14);
  }
}

int main(void) {
  const rayc_detection_options options = from_vertices();
  rayc_contacts* contacts = NULL;
  rayc_octree* octree = NULL;
  rayc_scene* scene = NULL;
  rayc_mesh* mesh = two_lobes();
  CHECK_OK(rayc_contacts_create(&contacts));
  CHECK_OK(rayc_octree_create(NULL, mesh, &octree));
  CHECK_OK(rayc_query_self(&options, mesh, octree, contacts));
  check_contacts(contacts, 0);
  check_forces(contacts);

  CHECK_STATUS(rayc_query_self(&options, NULL, octree, contacts), RAYC_STATUS_NULL_POINTER, "mesh");
  CHECK_STATUS(rayc_query_self(&options, mesh, NULL, contacts), RAYC_STATUS_NULL_POINTER, "octree");
  CHECK_STATUS(rayc_query_self(&options, mesh, octree, NULL), RAYC_STATUS_NULL_POINTER, "contacts");
  rayc_mesh* other = two_lobes();
  CHECK_STATUS(rayc_query_self(&options, other, octree, contacts), RAYC_STATUS_OCTREE_OF_OTHER_MESH, NULL);
  CHECK_OK(rayc_mesh_destroy(other));
  rayc_detection_options refused = options;
  refused.past_folds = 2;
  CHECK_STATUS(rayc_query_self(&refused, mesh, octree, contacts), RAYC_STATUS_INVALID_OPTION, "past_folds");
  check_contacts(contacts, 0); /* as before */

  CHECK_OK(rayc_scene_create(NULL, &scene));
  CHECK_OK(rayc_scene_set_detection_options(scene, &options));
  uint32_t body = 42;
  rayc_mesh* alone = octahedron_mesh((double[3]){100, 0, 0});
  CHECK_OK(rayc_scene_add_mesh(scene, alone, &body));
  CHECK_OK(rayc_scene_add_mesh(scene, mesh, &body));
  size_t count = 42;
  CHECK_OK(rayc_scene_query(scene, contacts));
  CHECK_OK(rayc_contacts_count(contacts, &count));
  CHECK(count == 0); /* off for a new body */
  CHECK_OK(rayc_scene_set_self_collision(scene, 0, 1));
  CHECK_OK(rayc_scene_set_self_collision(scene, body, 1));
  CHECK_STATUS(rayc_scene_set_self_collision(scene, body, 2), RAYC_STATUS_INVALID_OPTION, "2");
  CHECK_STATUS(rayc_scene_set_self_collision(scene, 7, 1), RAYC_STATUS_UNKNOWN_BODY, "7");
  CHECK_OK(rayc_scene_query(scene, contacts));
  check_contacts(contacts, 1);

  CHECK_OK(rayc_scene_destroy(scene));
  CHECK_OK(rayc_mesh_destroy(alone));
  CHECK_OK(rayc_octree_destroy(octree));
  CHECK_OK(rayc_mesh_destroy(mesh));
  CHECK_OK(rayc_contacts_destroy(contacts));
  return check_result();
}
