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

/* The first body slides at 0.5 m/s across the rays: √(0.5² + 1.2²) is 1.3. */
static const double slide[3] = {0, 0.3, 0.4};

static rayc_response_options rubbing(void) {
  rayc_response_options rough = options;
  rough.friction = 0.5;
  rough.slip_speed = 1.2;
  return rough;
}

/* cos α is the root of a third. */
static double friction_of_both(int axis) {
  return -2 * 0.5 * sqrt(1.0 / 3) * SHIFTED_DEPTH * slide[axis] / 1.3;
}

static void friction_brakes_the_slip(void) {
  field forces, velocities;
  memset(&forces, 0, sizeof forces);
  memset(&velocities, 0, sizeof velocities);
  for (int i = 0; i < 3 * OCTAHEDRON_VERTICES; ++i) velocities.values[0][i] = slide[i % 3];
  rayc_vectors speeds[2];
  rayc_vectors_mut out[2];
  views(&velocities, speeds);
  views_mut(&forces, out);
  const rayc_response_options rough = rubbing();
  CHECK_OK(rayc_contacts_add_forces(contacts, &rough, 2, NULL, speeds, out));
  for (int axis = 1; axis < 3; ++axis) {
    CHECK_NEAR(sum(&forces, 0, axis), friction_of_both(axis), 1e-14);
    CHECK_NEAR(sum(&forces, 1, axis), -friction_of_both(axis), 1e-14);
    forces.values[0][axis] -= friction_of_both(axis);
    forces.values[1][axis] += friction_of_both(axis);
  }
  check_sums(&forces, -2 * SHIFTED_DEPTH);
}

/* What the wrenches held is added to. Forces and torques about the origin add up to zero. */
static void wrenches_balance(void) {
  const rayc_response_options rough = rubbing();
  const double points[6] = {0, 0, 0, 0.5, 7, 0};
  double velocities[12] = {0, slide[1], slide[2]}, wrenches[12] = {10};
  CHECK_OK(rayc_contacts_add_wrenches(contacts, &rough, 2, points, velocities, wrenches));
  CHECK_NEAR(wrenches[0], 10 - 2 * SHIFTED_DEPTH, 1e-14);
  wrenches[0] -= 10;
  double moment[3];
  for (int axis = 0; axis < 3; ++axis) {
    const int next = (axis + 1) % 3, last = (axis + 2) % 3;
    if (axis > 0) CHECK_NEAR(wrenches[axis], friction_of_both(axis), 1e-14);
    CHECK_NEAR(wrenches[axis], -wrenches[6 + axis], 1e-14);
    moment[axis] = points[3 + next] * wrenches[6 + last] - points[3 + last] * wrenches[6 + next];
    CHECK_NEAR(wrenches[3 + axis] + wrenches[9 + axis] + moment[axis], 0, 1e-13);
  }
  /* Where the rays start: at (1, 0, 0), and at (-1, 0, 0) moved by the shift. */
  CHECK_NEAR(wrenches[4], -octahedron_shift[0] * 0.5 * wrenches[2] + octahedron_shift[2] * 0.5 * wrenches[0], 1e-13);
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
    bad = rubbing();
    bad.friction = numbers[i];
    CHECK_STATUS(rayc_contacts_add_forces(contacts, &bad, 2, NULL, speeds, out), RAYC_STATUS_INVALID_OPTION,
                 "friction is");
    bad = rubbing();
    bad.slip_speed = i == 0 ? 0 : numbers[i];
    CHECK_STATUS(rayc_contacts_add_forces(contacts, &bad, 2, NULL, speeds, out), RAYC_STATUS_INVALID_OPTION,
                 "slip_speed is");
  }
  bad = rubbing();
  CHECK_STATUS(rayc_contacts_add_forces(contacts, &bad, 2, NULL, NULL, out), RAYC_STATUS_INVALID_OPTION,
               "friction is 0.5, but there are no velocities to rub against");

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

static void bad_wrenches_change_nothing(void) {
  const rayc_response_options rough = rubbing();
  double points[6] = {0}, velocities[12] = {0}, wrenches[18] = {0};
#define ADD(count, points, velocities, wrenches) \
  rayc_contacts_add_wrenches(contacts, &rough, count, points, velocities, wrenches)
  CHECK_STATUS(rayc_contacts_add_wrenches(NULL, &rough, 2, points, velocities, wrenches), RAYC_STATUS_NULL_POINTER,
               "contacts");
  CHECK_STATUS(ADD(2, NULL, velocities, wrenches), RAYC_STATUS_NULL_POINTER, "points");
  CHECK_STATUS(ADD(2, points, NULL, wrenches), RAYC_STATUS_NULL_POINTER, "velocities");
  CHECK_STATUS(ADD(2, points, velocities, NULL), RAYC_STATUS_NULL_POINTER, "wrenches");
  CHECK_STATUS(ADD(1, points, velocities, wrenches), RAYC_STATUS_WRONG_COUNT, "body 1, but there are 1");
  CHECK_STATUS(ADD(2, points, wrenches, wrenches + 6), RAYC_STATUS_INVALID_OPTION, "overlaps");
  CHECK_STATUS(ADD(2, wrenches, velocities, wrenches + 5), RAYC_STATUS_INVALID_OPTION, "overlaps");
  const double numbers[] = {NAN, INFINITY};
  for (int i = 0; i < 2; ++i) {
    points[4] = numbers[i];
    CHECK_STATUS(ADD(2, points, velocities, wrenches), RAYC_STATUS_NOT_FINITE, "points: body 1");
    points[4] = 0;
    velocities[4] = numbers[i];
    CHECK_STATUS(ADD(2, points, velocities, wrenches), RAYC_STATUS_NOT_FINITE, "velocities: body 0");
    velocities[4] = 0;
  }
  points[3] = 1e308;
  velocities[11] = 1e308;
  rayc_response_options damped = rough;
  damped.damping_time = 1;
  CHECK_STATUS(rayc_contacts_add_wrenches(contacts, &damped, 2, points, velocities, wrenches),
               RAYC_STATUS_INVALID_OPTION, "beyond");
  rayc_response_options bad = rough;
  bad.slip_speed = NAN;
  CHECK_STATUS(rayc_contacts_add_wrenches(contacts, &bad, 2, points, velocities, wrenches), RAYC_STATUS_INVALID_OPTION,
               "slip_speed");
  for (int k = 0; k < 18; ++k) CHECK(wrenches[k] == 0);
#undef ADD
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
  CHECK(options.friction == 0 && options.slip_speed == 0);
  CHECK(options.stiffness == 1 && options.damping_time == 0 && options.weighting == RAYC_WEIGHTING_AREA);
  options.stiffness = 3;

  coefficients_are_stiffness_times_area_times_cosine();
  forces_part_the_bodies_and_are_added();
  damping_brakes_the_approach();
  friction_brakes_the_slip();
  wrenches_balance();
  differential_resists_displacement();
  energy_is_that_of_two_springs();
  bad_arguments_change_nothing();
  bad_wrenches_change_nothing();

  CHECK_OK(rayc_contacts_destroy(contacts));
  for (int i = 0; i < 2; ++i) {
    CHECK_OK(rayc_octree_destroy(octrees[i]));
    CHECK_OK(rayc_mesh_destroy(meshes[i]));
  }
  return check_result();
}
