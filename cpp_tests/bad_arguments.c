/* NULL, zero struct_size, unknown enum numbers, options out of range, unknown bodies: each has its own status, and
   outputs stay untouched. */
#include "check.h"
#include "shapes.h"

static const double no_shift[3] = {0, 0, 0};

static void default_options_check_their_size(void) {
  rayc_mesh_options mesh_options;
  rayc_response_options response_options;
  rayc_scene_options scene_options;
  CHECK_STATUS(rayc_default_mesh_options(0, &mesh_options), RAYC_STATUS_INVALID_STRUCT_SIZE, "rayc_mesh_options is 0");
  CHECK_STATUS(rayc_default_response_options(0, &response_options), RAYC_STATUS_INVALID_STRUCT_SIZE,
               "rayc_response_options is 0");
  CHECK_STATUS(rayc_default_scene_options(0, &scene_options), RAYC_STATUS_INVALID_STRUCT_SIZE,
               "rayc_scene_options is 0");
  CHECK_STATUS(rayc_default_mesh_options(sizeof mesh_options, NULL), RAYC_STATUS_NULL_POINTER, "options");
  CHECK_STATUS(rayc_default_response_options(sizeof response_options, NULL), RAYC_STATUS_NULL_POINTER, "options");
  CHECK_STATUS(rayc_default_scene_options(sizeof scene_options, NULL), RAYC_STATUS_NULL_POINTER, "options");
}

static void mesh_create_checks_its_arguments(void) {
  const rayc_vectors positions = packed(octahedron_positions, OCTAHEDRON_VERTICES);
  rayc_mesh* mesh = NULL;
  CHECK_STATUS(rayc_mesh_create(NULL, NULL, octahedron_triangles, OCTAHEDRON_TRIANGLES, &mesh),
               RAYC_STATUS_NULL_POINTER, "positions");
  CHECK_STATUS(rayc_mesh_create(NULL, &positions, NULL, OCTAHEDRON_TRIANGLES, &mesh), RAYC_STATUS_NULL_POINTER,
               "triangles");
  CHECK_STATUS(rayc_mesh_create(NULL, &positions, octahedron_triangles, OCTAHEDRON_TRIANGLES, NULL),
               RAYC_STATUS_NULL_POINTER, "mesh");
  CHECK_STATUS(rayc_mesh_create_from_obj(NULL, "octahedron.obj", NULL), RAYC_STATUS_NULL_POINTER, "mesh");

  rayc_mesh_options options;
  memset(&options, 0, sizeof options);
  CHECK_STATUS(rayc_mesh_create(&options, &positions, octahedron_triangles, OCTAHEDRON_TRIANGLES, &mesh),
               RAYC_STATUS_INVALID_STRUCT_SIZE, "rayc_mesh_options is 0");
  CHECK_OK(rayc_default_mesh_options(sizeof options, &options));
  options.precision = 7;
  CHECK_STATUS(rayc_mesh_create(&options, &positions, octahedron_triangles, OCTAHEDRON_TRIANGLES, &mesh),
               RAYC_STATUS_UNKNOWN_ENUM, "7");
  CHECK(mesh == NULL);
}

static void mesh_readers_check_their_arguments(void) {
  rayc_mesh* mesh = octahedron_mesh(no_shift);
  size_t count = 42;
  CHECK_STATUS(rayc_mesh_vertex_count(NULL, &count), RAYC_STATUS_NULL_POINTER, "mesh");
  CHECK_STATUS(rayc_mesh_vertex_count(mesh, NULL), RAYC_STATUS_NULL_POINTER, "count");
  CHECK_STATUS(rayc_mesh_triangle_count(NULL, &count), RAYC_STATUS_NULL_POINTER, "mesh");
  CHECK_STATUS(rayc_mesh_triangle_count(mesh, NULL), RAYC_STATUS_NULL_POINTER, "count");
  CHECK(count == 42);

  double positions[3 * OCTAHEDRON_VERTICES] = {42};
  rayc_vectors_mut out = packed_mut(positions, OCTAHEDRON_VERTICES);
  CHECK_STATUS(rayc_mesh_copy_positions(NULL, &out), RAYC_STATUS_NULL_POINTER, "mesh");
  CHECK_STATUS(rayc_mesh_copy_positions(mesh, NULL), RAYC_STATUS_NULL_POINTER, "positions");
  out.count = 5;
  CHECK_STATUS(rayc_mesh_copy_positions(mesh, &out), RAYC_STATUS_WRONG_COUNT, "5");
  CHECK(positions[0] == 42);

  uint32_t triangles[3 * OCTAHEDRON_TRIANGLES] = {42};
  CHECK_STATUS(rayc_mesh_copy_triangles(NULL, 24, triangles), RAYC_STATUS_NULL_POINTER, "mesh");
  CHECK_STATUS(rayc_mesh_copy_triangles(mesh, 24, NULL), RAYC_STATUS_NULL_POINTER, "triangles");
  CHECK_STATUS(rayc_mesh_copy_triangles(mesh, 8, triangles), RAYC_STATUS_WRONG_COUNT, "24");
  CHECK(triangles[0] == 42);
  CHECK_OK(rayc_mesh_copy_triangles(mesh, 24, triangles));
  CHECK(memcmp(triangles, octahedron_triangles, sizeof triangles) == 0);
  CHECK_OK(rayc_mesh_destroy(mesh));
  CHECK_OK(rayc_mesh_destroy(NULL));
}

static void octree_and_rays_check_their_arguments(void) {
  rayc_mesh* mesh = octahedron_mesh(no_shift);
  rayc_octree* octree = NULL;
  CHECK_STATUS(rayc_octree_create(NULL, NULL, &octree), RAYC_STATUS_NULL_POINTER, "mesh");
  CHECK_STATUS(rayc_octree_create(NULL, mesh, NULL), RAYC_STATUS_NULL_POINTER, "octree");
  CHECK_OK(rayc_octree_create(NULL, mesh, &octree));
  CHECK_STATUS(rayc_octree_update(NULL, mesh), RAYC_STATUS_NULL_POINTER, "octree");
  CHECK_STATUS(rayc_octree_update(octree, NULL), RAYC_STATUS_NULL_POINTER, "mesh");

  const rayc_ray ray = {{-2, 0.1, 0.1}, {1, 0, 0}, INFINITY};
  rayc_hit hit = {42, 42, 42, {42, 42, 42}};
  CHECK_STATUS(rayc_octree_trace_ray(NULL, mesh, &ray, &hit), RAYC_STATUS_NULL_POINTER, "octree");
  CHECK_STATUS(rayc_octree_trace_ray(octree, NULL, &ray, &hit), RAYC_STATUS_NULL_POINTER, "mesh");
  CHECK_STATUS(rayc_octree_trace_ray(octree, mesh, NULL, &hit), RAYC_STATUS_NULL_POINTER, "ray");
  CHECK_STATUS(rayc_octree_trace_ray(octree, mesh, &ray, NULL), RAYC_STATUS_NULL_POINTER, "hit");
  CHECK_STATUS(rayc_octree_trace_rays(octree, mesh, NULL, 1, &hit), RAYC_STATUS_NULL_POINTER, "rays");
  CHECK_STATUS(rayc_octree_trace_rays(octree, mesh, &ray, 1, NULL), RAYC_STATUS_NULL_POINTER, "hits");
  CHECK_OK(rayc_octree_trace_rays(octree, mesh, NULL, 0, NULL)); /* no rays: nothing to read */

  rayc_ray rays[2] = {ray, ray};
  rays[1].direction[1] = NAN;
  CHECK_STATUS(rayc_octree_trace_rays(octree, mesh, rays, 2, &hit), RAYC_STATUS_NOT_FINITE, "1");
  CHECK_STATUS(rayc_octree_trace_ray(octree, mesh, &rays[1], &hit), RAYC_STATUS_NOT_FINITE, "direction");
  CHECK(hit.triangle == 42 && hit.t == 42);

  CHECK_OK(rayc_octree_destroy(octree));
  CHECK_OK(rayc_octree_destroy(NULL));
  CHECK_OK(rayc_mesh_destroy(mesh));
}

static void query_checks_its_arguments(void) {
  rayc_mesh* mesh = octahedron_mesh(no_shift);
  rayc_octree* octree = NULL;
  rayc_contacts* contacts = NULL;
  CHECK_OK(rayc_octree_create(NULL, mesh, &octree));
  CHECK_STATUS(rayc_contacts_create(NULL), RAYC_STATUS_NULL_POINTER, "contacts");
  CHECK_OK(rayc_contacts_create(&contacts));
  CHECK_STATUS(rayc_query_pair(NULL, NULL, octree, mesh, octree, contacts), RAYC_STATUS_NULL_POINTER, "a is NULL");
  CHECK_STATUS(rayc_query_pair(NULL, mesh, NULL, mesh, octree, contacts), RAYC_STATUS_NULL_POINTER, "octree");
  CHECK_STATUS(rayc_query_pair(NULL, mesh, octree, NULL, octree, contacts), RAYC_STATUS_NULL_POINTER, "b is NULL");
  CHECK_STATUS(rayc_query_pair(NULL, mesh, octree, mesh, NULL, contacts), RAYC_STATUS_NULL_POINTER, "octree");
  CHECK_STATUS(rayc_query_pair(NULL, mesh, octree, mesh, octree, NULL), RAYC_STATUS_NULL_POINTER, "contacts");
  CHECK_OK(rayc_octree_destroy(octree));
  CHECK_OK(rayc_contacts_destroy(contacts));
  CHECK_OK(rayc_contacts_destroy(NULL));
  CHECK_OK(rayc_mesh_destroy(mesh));
}

static void scene_checks_its_arguments(void) {
  rayc_scene* scene = NULL;
  rayc_scene_options options;
  memset(&options, 0, sizeof options);
  CHECK_STATUS(rayc_scene_create(&options, &scene), RAYC_STATUS_INVALID_STRUCT_SIZE, "rayc_scene_options is 0");
  CHECK_OK(rayc_default_scene_options(sizeof options, &options));
  options.precision = 9;
  CHECK_STATUS(rayc_scene_create(&options, &scene), RAYC_STATUS_UNKNOWN_ENUM, "9");
  CHECK_STATUS(rayc_scene_create(NULL, NULL), RAYC_STATUS_NULL_POINTER, "scene");
  CHECK(scene == NULL);
  CHECK_OK(rayc_scene_create(NULL, &scene));

  rayc_mesh* mesh = octahedron_mesh(no_shift);
  uint32_t body = 42;
  CHECK_STATUS(rayc_scene_add_mesh(NULL, mesh, &body), RAYC_STATUS_NULL_POINTER, "scene");
  CHECK_STATUS(rayc_scene_add_mesh(scene, NULL, &body), RAYC_STATUS_NULL_POINTER, "mesh");
  CHECK_STATUS(rayc_scene_add_mesh(scene, mesh, NULL), RAYC_STATUS_NULL_POINTER, "body");
  CHECK(body == 42);
  CHECK_OK(rayc_scene_add_mesh(scene, mesh, &body));
  CHECK(body == 0);

  const rayc_vectors positions = packed(octahedron_positions, OCTAHEDRON_VERTICES);
  CHECK_STATUS(rayc_scene_set_positions(scene, 3, &positions), RAYC_STATUS_UNKNOWN_BODY, "3");
  CHECK_STATUS(rayc_scene_remove_body(scene, 3), RAYC_STATUS_UNKNOWN_BODY, "3");
  CHECK_STATUS(rayc_scene_set_positions(scene, body, NULL), RAYC_STATUS_NULL_POINTER, "positions");
  const rayc_vectors too_few = packed(octahedron_positions, 5);
  CHECK_STATUS(rayc_scene_set_positions(scene, body, &too_few), RAYC_STATUS_WRONG_COUNT, "5");
  CHECK_STATUS(rayc_scene_query(scene, NULL), RAYC_STATUS_NULL_POINTER, "contacts");
  CHECK_STATUS(rayc_scene_query(NULL, NULL), RAYC_STATUS_NULL_POINTER, "scene");

  CHECK_OK(rayc_scene_destroy(scene));
  CHECK_OK(rayc_scene_destroy(NULL));
  CHECK_OK(rayc_mesh_destroy(mesh));
}

int main(void) {
  default_options_check_their_size();
  mesh_create_checks_its_arguments();
  mesh_readers_check_their_arguments();
  octree_and_rays_check_their_arguments();
  query_checks_its_arguments();
  scene_checks_its_arguments();

  CHECK(strcmp(rayc_status_name(RAYC_STATUS_MESH_OPEN), "RAYC_STATUS_MESH_OPEN") == 0);
  CHECK(rayc_status_name(123456) != NULL);
  return check_result();
}
