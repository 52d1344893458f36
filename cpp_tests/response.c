/* Forces, differential and energy of the two octahedra: with the stiffness 3 every contact's coefficient is 1. */
#include "check.h"
#include "raycontact/distributed.h"
#include "shapes.h"

static const double no_shift[3] = {0, 0, 0};
static rayc_contacts* contacts;
static rayc_response_options options;

typedef struct field {
  double values[2][3 * OCTAHEDRON_VERTICES];
} field;

static void views(const field* field, rayc_vectors out[2]) {
  out[0] = packed(field->values[0], OCTAHEDRON_VERTICES);
  out[1] = packed(field->values[1], OCTAHEDRON_VERTICES);
}

static void views_mut(field* field, rayc_vectors_mut out[2]) {
  out[0] = packed_mut(field->values[0], OCTAHEDRON_VERTICES);
  out[1] = packed_mut(field->values[1], OCTAHEDRON_VERTICES);
}

static double sum(const field* field, int body, int axis) {
  double total = 0;
  for (int i = 0; i < OCTAHEDRON_VERTICES; ++i) {
    total += field->values[body][3 * i + axis];
  }
  return total;
}

static void check_sums(const field* forces, double first_x) {
  CHECK_NEAR(sum(forces, 0, 0), first_x, 1e-13);
  CHECK_NEAR(sum(forces, 1, 0), -first_x, 1e-13);
  for (int axis = 1; axis < 3; ++axis) {
    CHECK_NEAR(sum(forces, 0, axis), 0, 1e-13);
    CHECK_NEAR(sum(forces, 1, axis), 0, 1e-13);
  }
}

static void coefficients_are_stiffness_times_area_times_cosine(void) {
  double coefficients[2] = {0, 0};
  CHECK_OK(rayc_contacts_copy_coefficients(contacts, &options, 0, 2, coefficients));
  CHECK_NEAR(coefficients[0], 1, 1e-14);
  CHECK_NEAR(coefficients[1], 1, 1e-14);

  rayc_response_options by_vertex = options;
  by_vertex.weighting = RAYC_WEIGHTING_VERTEX;
  CHECK_OK(rayc_contacts_copy_coefficients(contacts, &by_vertex, 1, 1, coefficients));
  CHECK_NEAR(coefficients[0], 1.7320508075688772935, 1e-14);
}

static void forces_part_the_bodies_and_are_added(void) {
  field forces;
  memset(&forces, 0, sizeof forces);
  forces.values[0][0] = 10; /* what the host had there before */
  rayc_vectors_mut out[2];
  views_mut(&forces, out);
  CHECK_OK(rayc_contacts_add_forces(contacts, &options, 2, NULL, NULL, out));
  CHECK_NEAR(forces.values[0][0], 10 - SHIFTED_DEPTH * (1 + 0.8125), 1e-14);
  CHECK_NEAR(forces.values[0][3 * 2], -SHIFTED_DEPTH * 0.125, 1e-14);
  CHECK_NEAR(forces.values[1][3 * 1], SHIFTED_DEPTH * (1 + 0.8125), 1e-14);
  CHECK_NEAR(forces.values[1][3 * 5], SHIFTED_DEPTH * 0.0625, 1e-14);
  forces.values[0][0] -= 10;
  check_sums(&forces, -2 * SHIFTED_DEPTH);
}

static void damping_brakes_the_approach(void) {
  field forces, velocities;
  memset(&forces, 0, sizeof forces);
  memset(&velocities, 0, sizeof velocities);
  for (int i = 0; i < OCTAHEDRON_VERTICES; ++i) {
    velocities.values[0][3 * i] = 0.5; /* towards the second body */
  }
  rayc_response_options damped = options;
  damped.damping_time = 0.25;
  rayc_vectors speeds[2];
  rayc_vectors_mut out[2];
  views(&velocities, speeds);
  views_mut(&forces, out);
  CHECK_OK(rayc_contacts_add_forces(contacts, &damped, 2, NULL, speeds, out));
  check_sums(&forces, -2 * (SHIFTED_DEPTH + 0.25 * 0.5));
}

static void differential_resists_displacement(void) {
  field forces, displacements;
  memset(&forces, 0, sizeof forces);
  memset(&displacements, 0, sizeof displacements);
  for (int i = 0; i < OCTAHEDRON_VERTICES; ++i) {
    displacements.values[0][3 * i] = 0.5;
    displacements.values[0][3 * i + 1] = 0.25; /* across the rays: no answer */
  }
  rayc_vectors moves[2];
  rayc_vectors_mut out[2];
  views(&displacements, moves);
  views_mut(&forces, out);
  CHECK_OK(rayc_contacts_add_differential(contacts, &options, 1, 0, 2, moves, out));
  check_sums(&forces, -2 * 0.5);
  CHECK_OK(rayc_contacts_add_differential(contacts, &options, -1, 0, 2, moves, out));
  check_sums(&forces, 0);
}

static void energy_is_that_of_two_springs(void) {
  double energy = 0;
  CHECK_OK(rayc_contacts_energy(contacts, &options, 2, NULL, &energy));
  CHECK_NEAR(energy, 2 * 0.5 * SHIFTED_DEPTH * SHIFTED_DEPTH, 1e-14);
}

/* Refused, and not one force was changed. */
static void bad_arguments_change_nothing(void) {
  field forces, velocities;
  memset(&forces, 0, sizeof forces);
  memset(&velocities, 0, sizeof velocities);
  const field before = forces;
  rayc_vectors speeds[2];
  rayc_vectors_mut out[2];
  views(&velocities, speeds);
  views_mut(&forces, out);

  rayc_response_options bad;
  memset(&bad, 0, sizeof bad);
  CHECK_STATUS(rayc_contacts_add_forces(contacts, &bad, 2, NULL, NULL, out), RAYC_STATUS_INVALID_STRUCT_SIZE,
               "rayc_response_options is 0");
  bad = options;
  bad.weighting = 12;
  CHECK_STATUS(rayc_contacts_add_forces(contacts, &bad, 2, NULL, NULL, out), RAYC_STATUS_UNKNOWN_ENUM, "12");
  const double numbers[] = {-1, NAN, INFINITY};
  for (int i = 0; i < 3; ++i) {
    bad = options;
    bad.stiffness = numbers[i];
    CHECK_STATUS(rayc_contacts_add_forces(contacts, &bad, 2, NULL, NULL, out), RAYC_STATUS_INVALID_OPTION, "stiffness");
    bad = options;
    bad.damping_time = numbers[i];
    CHECK_STATUS(rayc_contacts_add_forces(contacts, &bad, 2, NULL, NULL, out), RAYC_STATUS_INVALID_OPTION,
                 "damping_time");
  }

  bad = options;
  bad.damping_time = 0.25;
  size_t pairs = 7, summed = 7;
  const char* without = "damping_time is 0.25, but there are no velocities to damp";
  CHECK_STATUS(rayc_contacts_add_forces(contacts, &bad, 2, NULL, NULL, out), RAYC_STATUS_INVALID_OPTION, without);
  CHECK_STATUS(rayc_contacts_sum_pair_forces(contacts, &bad, 0, NULL, NULL, &pairs, &summed),
               RAYC_STATUS_INVALID_OPTION, without);
  CHECK(pairs == 7 && summed == 7);

  CHECK_STATUS(rayc_contacts_add_forces(NULL, &options, 2, NULL, NULL, out), RAYC_STATUS_NULL_POINTER, "contacts");
  CHECK_STATUS(rayc_contacts_add_forces(contacts, &options, 2, NULL, NULL, NULL), RAYC_STATUS_NULL_POINTER, "forces");
  CHECK_STATUS(rayc_contacts_add_forces(contacts, &options, 1, NULL, NULL, out), RAYC_STATUS_WRONG_COUNT, "1");
  out[1].count = 5;
  CHECK_STATUS(rayc_contacts_add_forces(contacts, &options, 2, NULL, NULL, out), RAYC_STATUS_WRONG_COUNT, "5");
  out[1].count = OCTAHEDRON_VERTICES;
  out[1].scalar = 3;
  CHECK_STATUS(rayc_contacts_add_forces(contacts, &options, 2, NULL, NULL, out), RAYC_STATUS_UNKNOWN_ENUM, "3");
  out[1].scalar = RAYC_SCALAR_F64;
  speeds[1].count = 4;
  CHECK_STATUS(rayc_contacts_add_forces(contacts, &options, 2, NULL, speeds, out), RAYC_STATUS_WRONG_COUNT, "4");
  CHECK_STATUS(rayc_contacts_add_differential(contacts, &options, 1, 0, 2, NULL, out), RAYC_STATUS_NULL_POINTER,
               "displacements");
  CHECK_STATUS(rayc_contacts_add_differential(contacts, &options, 1, 0, 2, speeds, out), RAYC_STATUS_WRONG_COUNT, "4");
  CHECK_STATUS(rayc_contacts_energy(contacts, &options, 2, NULL, NULL), RAYC_STATUS_NULL_POINTER, "joules");
  CHECK(memcmp(&forces, &before, sizeof forces) == 0);
}

int main(void) {
  rayc_mesh* meshes[2] = {octahedron_mesh(no_shift), octahedron_mesh(octahedron_shift)};
  rayc_octree* octrees[2] = {NULL, NULL};
  for (int i = 0; i < 2; ++i) {
    CHECK_OK(rayc_octree_create(NULL, meshes[i], &octrees[i]));
  }
  CHECK_OK(rayc_contacts_create(&contacts));
  const rayc_detection_options detection = from_vertices();
  CHECK_OK(rayc_query_pair(&detection, meshes[0], octrees[0], meshes[1], octrees[1], contacts));
  CHECK_OK(rayc_default_response_options(sizeof options, &options));
  CHECK(options.stiffness == 1 && options.damping_time == 0 && options.weighting == RAYC_WEIGHTING_AREA);
  options.stiffness = 3;

  coefficients_are_stiffness_times_area_times_cosine();
  forces_part_the_bodies_and_are_added();
  damping_brakes_the_approach();
  differential_resists_displacement();
  energy_is_that_of_two_springs();
  bad_arguments_change_nothing();

  CHECK_OK(rayc_contacts_destroy(contacts));
  for (int i = 0; i < 2; ++i) {
    CHECK_OK(rayc_octree_destroy(octrees[i]));
    CHECK_OK(rayc_mesh_destroy(meshes[i]));
  }
  return check_result();
}
