/* What a host must not do, and what a cheap mark can tell: a handle of another type, one that is none, one that has
   been destroyed; a scene that is called again from within its own query, or from another thread meanwhile. */
#define _POSIX_C_SOURCE 200809L
#include <pthread.h>

#include "check.h"
#include "shapes.h"

static const double no_shift[3] = {0, 0, 0};

#define CHECK_INVALID(call) CHECK_STATUS(call, RAYC_STATUS_INVALID_HANDLE, NULL)
#define CHECK_BUSY(call) CHECK_STATUS(call, RAYC_STATUS_BUSY, "in use")

static void call_with_mesh(rayc_mesh* mesh, rayc_octree* octree, rayc_scene* scene, const rayc_vectors* positions) {
  size_t count = 0;
  uint32_t body = 0, triangles[3 * OCTAHEDRON_TRIANGLES];
  double out[3 * OCTAHEDRON_VERTICES];
  const rayc_vectors_mut copy = packed_mut(out, OCTAHEDRON_VERTICES);
  rayc_octree* made = NULL;
  CHECK_INVALID(rayc_mesh_set_positions(mesh, positions));
  CHECK_INVALID(rayc_mesh_vertex_count(mesh, &count));
  CHECK_INVALID(rayc_mesh_triangle_count(mesh, &count));
  CHECK_INVALID(rayc_mesh_copy_positions(mesh, &copy));
  CHECK_INVALID(rayc_mesh_copy_triangles(mesh, 3 * OCTAHEDRON_TRIANGLES, triangles));
  CHECK_INVALID(rayc_octree_create(NULL, mesh, &made));
  CHECK_INVALID(rayc_octree_update(octree, mesh));
  CHECK_INVALID(rayc_scene_add_mesh(scene, mesh, &body));
  CHECK_INVALID(rayc_mesh_destroy(mesh));
}

static void call_with_octree(rayc_octree* octree, const rayc_mesh* mesh, rayc_contacts* contacts) {
  const rayc_ray ray = {{0, 0, 0}, {1, 0, 0}, 9};
  rayc_hit hit;
  CHECK_INVALID(rayc_octree_update(octree, mesh));
  CHECK_INVALID(rayc_octree_trace_ray(octree, mesh, &ray, &hit));
  CHECK_INVALID(rayc_octree_trace_rays(octree, mesh, &ray, 1, &hit));
  CHECK_INVALID(rayc_query_pair(NULL, mesh, octree, mesh, octree, contacts));
  CHECK_INVALID(rayc_query_self(NULL, mesh, octree, contacts));
  CHECK_INVALID(rayc_octree_destroy(octree));
}

static void call_with_contacts(rayc_contacts* contacts, rayc_scene* scene) {
  size_t count = 0;
  double number = 0;
  rayc_contact contact;
  rayc_statistics statistics;
  CHECK_INVALID(rayc_contacts_count(contacts, &count));
  CHECK_INVALID(rayc_contacts_copy(contacts, 0, 1, &contact));
  CHECK_INVALID(rayc_contacts_statistics(contacts, sizeof statistics, &statistics));
  CHECK_INVALID(rayc_contacts_escape_push_count(contacts, &count));
  CHECK_INVALID(rayc_contacts_copy_coefficients(contacts, NULL, 0, 1, &number));
  CHECK_INVALID(rayc_contacts_add_forces(contacts, NULL, 0, NULL, NULL, NULL));
  CHECK_INVALID(rayc_contacts_add_differential(contacts, NULL, 1, 1, 0, NULL, NULL));
  CHECK_INVALID(rayc_contacts_energy(contacts, NULL, 0, NULL, &number));
  CHECK_INVALID(rayc_scene_query(scene, contacts));
  CHECK_INVALID(rayc_contacts_destroy(contacts));
}

static void call_with_scene(rayc_scene* scene, const rayc_mesh* mesh, rayc_contacts* contacts,
                            const rayc_vectors* positions) {
  size_t count = 0;
  uint32_t number = 0;
  CHECK_INVALID(rayc_scene_add_mesh(scene, mesh, &number));
  CHECK_INVALID(rayc_scene_remove_body(scene, 0));
  CHECK_INVALID(rayc_scene_release_body_numbers(scene));
  CHECK_INVALID(rayc_scene_set_positions(scene, 0, positions));
  CHECK_INVALID(rayc_scene_set_detection_options(scene, NULL));
  CHECK_INVALID(rayc_scene_set_self_collision(scene, 0, 1));
  CHECK_INVALID(rayc_scene_set_carrier_spacing(scene, 0, 0.1));
  CHECK_INVALID(rayc_scene_set_pair_collision(scene, 0, 1, 1));
  CHECK_INVALID(rayc_scene_query(scene, contacts));
  CHECK_INVALID(rayc_scene_allow_escape(scene, 0, 1, 1));
  CHECK_INVALID(rayc_scene_may_escape(scene, 0, 1, &number));
  CHECK_INVALID(rayc_scene_pair_memory_count(scene, &count));
  CHECK_INVALID(rayc_scene_saved_length(scene, &count));
  CHECK_INVALID(rayc_scene_destroy(scene));
}

static void handles_know_their_type(void) {
  double data[3 * OCTAHEDRON_VERTICES];
  octahedron_shifted(no_shift, data);
  const rayc_vectors positions = packed(data, OCTAHEDRON_VERTICES);
  rayc_mesh* mesh = octahedron_mesh(no_shift);
  rayc_octree* octree = NULL;
  rayc_contacts* contacts = NULL;
  rayc_scene* scene = NULL;
  CHECK_OK(rayc_octree_create(NULL, mesh, &octree));
  CHECK_OK(rayc_contacts_create(&contacts));
  CHECK_OK(rayc_scene_create(NULL, &scene));

  /* Memory of the host's that never was a handle, and a place where none can lie. */
  double zeros[64];
  memset(zeros, 0, sizeof zeros);
  void* const others[] = {mesh, octree, contacts, scene, zeros, (char*)zeros + 4, (char*)mesh + 1};
  for (size_t i = 0; i < sizeof others / sizeof others[0]; ++i) {
    if (others[i] != mesh) call_with_mesh(others[i], octree, scene, &positions);
    if (others[i] != octree) call_with_octree(others[i], mesh, contacts);
    if (others[i] != contacts) call_with_contacts(others[i], scene);
    if (others[i] != scene) call_with_scene(others[i], mesh, contacts, &positions);
  }
  size_t count = 0;
  CHECK_STATUS(rayc_mesh_vertex_count((rayc_mesh*)(void*)scene, &count), RAYC_STATUS_INVALID_HANDLE,
               "mesh is a handle of an rayc_scene, not of an rayc_mesh");
  CHECK_STATUS(rayc_mesh_vertex_count((rayc_mesh*)(void*)zeros, &count), RAYC_STATUS_INVALID_HANDLE, "destroyed");

  /* Refused, and as before. */
  uint32_t body = 42;
  CHECK_OK(rayc_octree_update(octree, mesh));
  CHECK_OK(rayc_query_pair(NULL, mesh, octree, mesh, octree, contacts));
  CHECK_OK(rayc_scene_add_mesh(scene, mesh, &body));
  CHECK_OK(rayc_scene_query(scene, contacts));

  CHECK_OK(rayc_mesh_destroy(mesh));
  CHECK_OK(rayc_octree_destroy(octree));
  CHECK_OK(rayc_contacts_destroy(contacts));
  CHECK_OK(rayc_scene_destroy(scene));
#ifndef __SANITIZE_ADDRESS__ /* which ends the program here, as it should */
  /* Told while their memory has not been used again. */
  CHECK_INVALID(rayc_mesh_destroy(mesh));
  CHECK_INVALID(rayc_octree_destroy(octree));
  CHECK_INVALID(rayc_contacts_destroy(contacts));
  CHECK_INVALID(rayc_scene_destroy(scene));
  CHECK_INVALID(rayc_mesh_vertex_count(mesh, &count));
#endif
}

/* A scene whose parallel_for makes every call that there is. */
typedef struct host {
  rayc_scene* scene;
  rayc_contacts* contacts;
  rayc_mesh* mesh;
  int calls;
  int in_other_thread;
} host;

static void* call_everything(void* context) {
  host* own = context;
  size_t count = 0;
  uint32_t number = 0;
  rayc_contact contact;
  static double data[3 * TORUS_VERTICES];
  torus_shifted(no_shift, data);
  const rayc_vectors positions = packed(data, TORUS_VERTICES);
  rayc_contacts* others = NULL;
  CHECK_OK(rayc_contacts_create(&others));
  CHECK_BUSY(rayc_scene_query(own->scene, own->contacts));
  CHECK_BUSY(rayc_scene_query(own->scene, others));
  CHECK_BUSY(rayc_scene_set_positions(own->scene, 0, &positions));
  CHECK_BUSY(rayc_scene_add_mesh(own->scene, own->mesh, &number));
  CHECK_BUSY(rayc_scene_remove_body(own->scene, 0));
  CHECK_BUSY(rayc_scene_release_body_numbers(own->scene));
  CHECK_BUSY(rayc_scene_pair_memory_count(own->scene, &count));
  CHECK_BUSY(rayc_scene_destroy(own->scene));
  CHECK_BUSY(rayc_contacts_count(own->contacts, &count));
  CHECK_BUSY(rayc_contacts_copy(own->contacts, 0, 1, &contact));
  CHECK_BUSY(rayc_contacts_destroy(own->contacts));
  /* What is not in use works. */
  CHECK_OK(rayc_mesh_vertex_count(own->mesh, &count));
  CHECK_OK(rayc_contacts_destroy(others));
  return NULL;
}

static void work(void* context, size_t count, rayc_task task, void* data) {
  host* own = context;
  if (own->calls++ == 0) {
    if (own->in_other_thread) {
      pthread_t thread;
      CHECK(pthread_create(&thread, NULL, call_everything, own) == 0);
      CHECK(pthread_join(thread, NULL) == 0);
    } else {
      call_everything(own);
    }
  }
  for (size_t i = 0; i < count; ++i) task(data, i);
}

static size_t contact_count(rayc_scene* scene, rayc_contacts* contacts) {
  size_t count = 0;
  CHECK_OK(rayc_scene_query(scene, contacts));
  CHECK_OK(rayc_contacts_count(contacts, &count));
  return count;
}

static void a_scene_at_work_is_busy(int in_other_thread) {
  host own = {NULL, NULL, NULL, 0, in_other_thread};
  rayc_scene_options options;
  CHECK_OK(rayc_default_scene_options(sizeof options, &options));
  rayc_scene* alone = NULL;
  CHECK_OK(rayc_scene_create(&options, &alone));
  options.parallel_for = work;
  options.parallel_context = &own;
  CHECK_OK(rayc_scene_create(&options, &own.scene));
  CHECK_OK(rayc_contacts_create(&own.contacts));
  for (int k = 0; k < 2; ++k) {
    uint32_t body = 42;
    rayc_mesh* mesh = torus_mesh(RAYC_SCALAR_F64, k == 0 ? no_shift : torus_shift);
    CHECK_OK(rayc_scene_add_mesh(alone, mesh, &body));
    CHECK_OK(rayc_scene_add_mesh(own.scene, mesh, &body));
    CHECK_OK(rayc_mesh_destroy(own.mesh));
    own.mesh = mesh;
  }
  const size_t expected = contact_count(alone, own.contacts);
  CHECK(expected > 100);
  CHECK(contact_count(own.scene, own.contacts) == expected);
  CHECK(own.calls > 0);
  /* It is so no longer. */
  CHECK(contact_count(own.scene, own.contacts) == expected);
  CHECK_OK(rayc_scene_destroy(alone));
  CHECK_OK(rayc_scene_destroy(own.scene));
  CHECK_OK(rayc_contacts_destroy(own.contacts));
  CHECK_OK(rayc_mesh_destroy(own.mesh));
}

int main(void) {
  handles_know_their_type();
  a_scene_at_work_is_busy(0);
  a_scene_at_work_is_busy(1);
  return check_result();
}
