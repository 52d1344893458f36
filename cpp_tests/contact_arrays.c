/* A contact system in the arrays of its host: the matrix in compressed rows, and floats in place of doubles, for
   systems of either precision. */
#include "check.h"
#include "shapes.h"

#define NODES TORUS_VERTICES
#define UNKNOWNS (3 * NODES + 12)
#define LENGTH 0.01

static const double origin[3] = {0, 0, 0};
static const double inertia[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
static const rayc_material material = {sizeof material, 1e4, 0.01, 0.3, 0.05, 0};
static double x[3 * NODES], v[UNKNOWNS], change[UNKNOWNS], product[UNKNOWNS], forces[UNKNOWNS];
static float float_x[3 * NODES], float_v[UNKNOWNS], float_change[UNKNOWNS], float_sums[UNKNOWNS];

/* A soft torus among two rigid ones, all of which overlap. */
static void make(uint32_t precision, rayc_scene** scene, rayc_contact_system** contacts) {
  rayc_scene_options scene_options;
  rayc_contact_system_options options;
  CHECK_OK(rayc_default_scene_options(sizeof scene_options, &scene_options));
  CHECK_OK(rayc_default_contact_system_options(sizeof options, &options));
  scene_options.precision = options.precision = precision;
  options.keeps_rigid_unknowns = 1;
  CHECK_OK(rayc_scene_create(&scene_options, scene));
  CHECK_OK(rayc_contact_system_create(&options, contacts));
  static double masses[NODES];
  for (int k = 0; k < NODES; ++k) masses[k] = 0.01;
  CHECK_OK(rayc_contact_system_set_node_masses(*contacts, NODES, masses));
  for (uint32_t k = 0; k < 3; ++k) {
    uint32_t body = 42;
    rayc_mesh* mesh = torus_mesh(precision, origin);
    CHECK_OK(rayc_scene_add_mesh(*scene, mesh, &body));
    CHECK_OK(rayc_mesh_destroy(mesh));
    if (k == 0) {
      CHECK_OK(rayc_contact_system_add_deformable(*contacts, *scene, body, 0, NODES, NULL, 0, NULL, NULL, &material));
      continue;
    }
    CHECK_OK(rayc_contact_system_add_rigid(*contacts, *scene, body, 1, inertia, &material));
    rayc_motion motion = {{0, 0, 0}, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0}, {0}};
    for (int axis = 0; axis < 3; ++axis) motion.position[axis] = torus_shift[axis] * (k == 1 ? 1 : -0.75);
    CHECK_OK(rayc_contact_system_set_motion(*contacts, body, &motion));
  }
}

static double entry(const rayc_csr* matrix, int32_t row, int32_t column) {
  for (int32_t at = matrix->offsets[row]; at < matrix->offsets[row + 1]; ++at)
    if (matrix->columns[at] == column) return matrix->values[at];
  return NAN;
}

static double largest(const double* numbers) {
  double most = 0;
  for (int k = 0; k < UNKNOWNS; ++k) most = fmax(most, fabs(numbers[k]));
  return most;
}

static void the_rows_are_those_of_the_products(rayc_contact_system* contacts) {
  rayc_csr matrix;
  CHECK_OK(rayc_contact_system_csr(contacts, LENGTH, &matrix));
  CHECK(matrix.row_count == UNKNOWNS && matrix.offsets[0] == 0);
  CHECK((size_t)matrix.offsets[UNKNOWNS] == matrix.value_count && matrix.value_count > 36);
  double most = 0;
  for (size_t at = 0; at < matrix.value_count; ++at) most = fmax(most, fabs(matrix.values[at]));
  memset(product, 0, sizeof product);
  CHECK_OK(rayc_contact_system_add_product(contacts, LENGTH, UNKNOWNS, change, product));
  const double size = largest(product);
  CHECK(size > 0 && product[UNKNOWNS - 1] != 0);
  for (int32_t row = 0; row < UNKNOWNS; ++row) {
    double sum = 0;
    for (int32_t at = matrix.offsets[row]; at < matrix.offsets[row + 1]; ++at) {
      CHECK(at == matrix.offsets[row] || matrix.columns[at - 1] < matrix.columns[at]);
      CHECK_NEAR(entry(&matrix, matrix.columns[at], row), matrix.values[at], 1e-14 * most);
      sum += matrix.values[at] * change[matrix.columns[at]];
    }
    CHECK_NEAR(sum, product[row], 1e-12 * size);
  }
}

/* The sums are those of doubles, rounded; what are no sums are the same numbers. */
static void floats_are_doubles_rounded(rayc_contact_system* one, rayc_contact_system* other, rayc_scene* of_other) {
  double number = 0, expected = 0;
  memset(forces, 0, sizeof forces);
  memset(float_sums, 0, sizeof float_sums);
  CHECK_OK(rayc_contact_system_add_forces(one, UNKNOWNS, v, forces));
  CHECK_OK(rayc_contact_system_add_forces_f32(other, UNKNOWNS, float_v, float_sums));
  for (int k = 0; k < UNKNOWNS; ++k) CHECK(float_sums[k] == (float)forces[k]);
  memset(float_sums, 0, sizeof float_sums);
  CHECK_OK(rayc_contact_system_add_product_f32(other, LENGTH, UNKNOWNS, float_change, float_sums));
  for (int k = 0; k < UNKNOWNS; ++k) CHECK(float_sums[k] == (float)product[k]);
  CHECK_OK(rayc_contact_system_energy(one, UNKNOWNS, v, &expected));
  CHECK_OK(rayc_contact_system_energy_f32(other, UNKNOWNS, float_v, &number));
  CHECK(number == expected && number > 0);
  CHECK_OK(rayc_contact_system_misjudged(one, UNKNOWNS, change, &expected));
  CHECK_OK(rayc_contact_system_misjudged_f32(other, UNKNOWNS, float_change, &number));
  CHECK(number == expected && number > 0);

  const rayc_status wrong = RAYC_STATUS_WRONG_COUNT;
  CHECK_STATUS(rayc_contact_system_add_forces_f32(other, 3, float_v, float_sums), wrong, "velocities");
  CHECK_STATUS(rayc_contact_system_add_forces_f32(other, UNKNOWNS, float_v, float_v), RAYC_STATUS_INVALID_OPTION,
               "overlaps");
  CHECK_STATUS(rayc_contact_system_add_product_f32(other, NAN, UNKNOWNS, float_change, float_sums),
               RAYC_STATUS_NOT_FINITE, "factor");
  float_v[7] = INFINITY;
  CHECK_STATUS(rayc_contact_system_add_forces_f32(other, UNKNOWNS, float_v, float_sums), RAYC_STATUS_NOT_FINITE,
               "velocities[7]");
  CHECK_STATUS(rayc_contact_system_finish_f32(other, UNKNOWNS, float_v), RAYC_STATUS_NOT_FINITE, "velocities[7]");
  float_v[7] = (float)v[7];
  for (int k = 0; k < UNKNOWNS; ++k) CHECK(float_sums[k] == (float)product[k]);

  uint32_t is_more = 42;
  CHECK_OK(rayc_contact_system_linearise(one, UNKNOWNS, v, &expected));
  CHECK_OK(rayc_contact_system_linearise_f32(other, UNKNOWNS, float_v, &number));
  CHECK(number == expected);
  CHECK_OK(rayc_contact_system_detect_again_f32(other, of_other, UNKNOWNS, float_v, &is_more));
  CHECK(is_more == 0);
  CHECK_OK(rayc_contact_system_finish(one, UNKNOWNS, v));
  CHECK_OK(rayc_contact_system_finish_f32(other, UNKNOWNS, float_v));
}

static void explicit_steps_are_alike(rayc_contact_system* one, rayc_scene* of_one, rayc_contact_system* other,
                                     rayc_scene* of_other) {
  double longest = 0, expected = 0;
  memset(forces, 0, sizeof forces);
  memset(float_sums, 0, sizeof float_sums);
  CHECK_OK(rayc_contact_system_explicit_step(one, of_one, LENGTH, 3 * NODES, x, v, UNKNOWNS, forces, &expected));
  CHECK_OK(rayc_contact_system_explicit_step_f32(other, of_other, LENGTH, 3 * NODES, float_x, float_v, UNKNOWNS,
                                                 float_sums, &longest));
  CHECK(longest == expected && longest > 0 && largest(forces) > 0);
  for (int k = 0; k < UNKNOWNS; ++k) CHECK(float_sums[k] == (float)forces[k]);
}

int main(void) {
  torus_shifted(origin, x);
  for (int k = 0; k < UNKNOWNS; ++k) {
    v[k] = float_v[k] = (float)(0.05 * sin(k + 0.5));
    change[k] = float_change[k] = (float)sin(k + 1.0);
    if (k < 3 * NODES) x[k] = float_x[k] = (float)x[k];
  }
  for (uint32_t precision = RAYC_SCALAR_F32; precision <= RAYC_SCALAR_F64; ++precision) {
    rayc_scene *of_one = NULL, *of_other = NULL;
    rayc_contact_system *one = NULL, *other = NULL;
    make(precision, &of_one, &one);
    make(precision, &of_other, &other);
    CHECK_OK(rayc_contact_system_begin(one, of_one, LENGTH, 3 * NODES, x, v, v));
    CHECK_OK(rayc_contact_system_begin_f32(other, of_other, LENGTH, 3 * NODES, float_x, float_v, float_v));
    the_rows_are_those_of_the_products(one);
    floats_are_doubles_rounded(one, other, of_other);
    explicit_steps_are_alike(one, of_one, other, of_other);
    CHECK_OK(rayc_contact_system_destroy(one));
    CHECK_OK(rayc_contact_system_destroy(other));
    CHECK_OK(rayc_scene_destroy(of_one));
    CHECK_OK(rayc_scene_destroy(of_other));
  }
  return check_result();
}
