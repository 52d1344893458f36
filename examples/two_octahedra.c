#include <raycontact.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { BODIES = 2, VERTICES = 6, FACES = 8 };

static const double octahedron[VERTICES][3] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
static const uint32_t faces[3 * FACES] = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};

typedef struct body {
  double x[VERTICES][3], v[VERTICES][3], f[VERTICES][3];
  uint32_t number; /* in the scene */
} body;

/* Ends the program where a call failed, with the library's message. */
static void check(rayc_status status) {
  if (status == RAYC_STATUS_OK) return;
  fprintf(stderr, "%s: %s\n", rayc_status_name(status), rayc_last_error_message());
  exit(EXIT_FAILURE);
}

/* Shows the library where numbers are: how many, 0 for packed, and their type. */
static rayc_vectors vectors(double (*data)[3]) {
  const rayc_vectors shown = {data, VERTICES, 0, RAYC_SCALAR_F64};
  return shown;
}

static void add_spring(body* b, int i, int j, double stiffness) {
  double d[3], length = 0, rest = 0;
  for (int k = 0; k < 3; ++k) {
    const double at_rest = octahedron[j][k] - octahedron[i][k];
    d[k] = b->x[j][k] - b->x[i][k];
    length += d[k] * d[k];
    rest += at_rest * at_rest;
  }
  const double tension = stiffness * (1 - sqrt(rest / length));
  for (int k = 0; k < 3; ++k) {
    b->f[i][k] += tension * d[k];
    b->f[j][k] -= tension * d[k];
  }
}

int main(void) {
  const double dt = 0.002, mass = 0.1; /* s, kg for each vertex */
  static body bodies[BODIES];
  rayc_scene* scene = NULL;
  rayc_contacts* contacts = NULL;
  size_t count = 0;
  check(rayc_scene_create(NULL, &scene)); /* NULL: the defaults */
  check(rayc_contacts_create(&contacts));
  for (int n = 0; n < BODIES; ++n) {
    for (int i = 0; i < VERTICES; ++i)
      for (int k = 0; k < 3; ++k) bodies[n].x[i][k] = octahedron[i][k] + (n == 1 && k == 0 ? 0.5 : 0);
    const rayc_vectors x = vectors(bodies[n].x);
    rayc_mesh* mesh = NULL;
    check(rayc_mesh_create(NULL, &x, faces, FACES, &mesh));
    check(rayc_scene_add_mesh(scene, mesh, &bodies[n].number));
    check(rayc_mesh_destroy(mesh)); /* the scene has a copy */
  }
  rayc_response_options response;
  check(rayc_default_response_options(sizeof response, &response));
  response.stiffness = 100;     /* N/m^3: pressure for each metre below the surface */
  response.damping_time = 0.05; /* s */

  for (int step = 0; step < 500; ++step) {
    rayc_vectors x[BODIES], v[BODIES];
    rayc_vectors_mut f[BODIES];
    for (int n = 0; n < BODIES; ++n) {
      x[n] = vectors(bodies[n].x), v[n] = vectors(bodies[n].v);
      const rayc_vectors_mut forces = {bodies[n].f, VERTICES, 0, RAYC_SCALAR_F64};
      f[n] = forces;
      for (int i = 0; i < VERTICES; ++i) bodies[n].f[i][0] = bodies[n].f[i][1] = bodies[n].f[i][2] = 0;
      check(rayc_scene_set_positions(scene, bodies[n].number, &x[n]));
    }
    check(rayc_scene_query(scene, contacts));
    check(rayc_contacts_add_forces(contacts, &response, BODIES, x, v, f));
    check(rayc_scene_advance(scene, dt));
    for (int n = 0; n < BODIES; ++n) {
      for (int i = 0; i < VERTICES; ++i)
        for (int j = 0; j < i; ++j) add_spring(&bodies[n], i, j, 50);
      for (int i = 0; i < VERTICES; ++i)
        for (int k = 0; k < 3; ++k) {
          bodies[n].v[i][k] += dt * bodies[n].f[i][k] / mass;
          bodies[n].x[i][k] += dt * bodies[n].v[i][k];
        }
    }
    check(rayc_contacts_count(contacts, &count));
    if (step % 100 == 0) printf("step %3d: %zu contacts\n", step, count);
  }
  double momentum = 0;
  for (int n = 0; n < BODIES; ++n)
    for (int i = 0; i < VERTICES; ++i) momentum += mass * bodies[n].v[i][0];
  printf("%zu contacts left, momentum %s\n", count, fabs(momentum) < 1e-12 ? "kept" : "lost");
  check(rayc_contacts_destroy(contacts));
  check(rayc_scene_destroy(scene));
  return EXIT_SUCCESS;
}
