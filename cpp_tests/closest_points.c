/* Nearest points and winding numbers of an octahedron, |x| + |y| + |z| = 1: the distance to a face from within is
   (1 - |x| - |y| - |z|) / √3. */
#include "check.h"
#include "shapes.h"

#define POINTS 8

static const double no_shift[3] = {0, 0, 0};

/* Inside; in the middle; outside before a face, an edge and a vertex; on a vertex; on an edge; very far away. */
static const double points[3 * POINTS] = {0.1, 0.2, 0.3, 0,  0, 0, 1,   1,   1, 2,   2, 0,
                                          3,   0,   0,   -1, 0, 0, 0.5, 0.5, 0, 1e6, 0, 0};
static const double distances[POINTS] = {
    0.4 / 1.7320508075688772, 1 / 1.7320508075688772, 2 / 1.7320508075688772, 3 / 1.4142135623730951, 2, 0, 0, 999999};
/* That of the middle is not told: all faces are as far. */
static const double nearest[3 * POINTS] = {0.7 / 3, 1.0 / 3, 1.3 / 3, 0,  0, 0, 1.0 / 3, 1.0 / 3, 1.0 / 3, 0.5, 0.5, 0,
                                           1,       0,       0,       -1, 0, 0, 0.5,     0.5,     0,       1,   0,   0};

static rayc_octree* octree_of(const rayc_mesh* mesh) {
  rayc_octree* octree = NULL;
  CHECK_OK(rayc_octree_create(NULL, mesh, &octree));
  return octree;
}

static rayc_mesh* mesh_of(rayc_scalar precision) {
  rayc_mesh_options options;
  CHECK_OK(rayc_default_mesh_options(sizeof options, &options));
  options.precision = precision;
  const rayc_vectors positions = packed(octahedron_positions, OCTAHEDRON_VERTICES);
  rayc_mesh* mesh = NULL;
  CHECK_OK(rayc_mesh_create(&options, &positions, octahedron_triangles, OCTAHEDRON_TRIANGLES, &mesh));
  return mesh;
}

static void answers_are_those_of_the_formula(rayc_scalar precision, double rounding_unit) {
  rayc_mesh* mesh = mesh_of(precision);
  rayc_octree* octree = octree_of(mesh);
  const rayc_vectors asked = packed(points, POINTS);
  rayc_closest_point closest[POINTS];
  int32_t numbers[POINTS];
  CHECK_OK(rayc_octree_closest_points(octree, mesh, &asked, NULL, closest));
  CHECK_OK(rayc_octree_winding_numbers(octree, mesh, &asked, numbers));
  for (int i = 0; i < POINTS; ++i) {
    const rayc_closest_point* found = &closest[i];
    const double reach = 1 + fabs(points[3 * i]) + fabs(points[3 * i + 1]) + fabs(points[3 * i + 2]);
    CHECK(found->is_found == 1 && found->triangle < OCTAHEDRON_TRIANGLES);
    CHECK_NEAR(found->distance, distances[i], 64 * rounding_unit * reach);
    double sum[3] = {0, 0, 0};
    for (int corner = 0; corner < 3; ++corner) {
      const uint32_t vertex = octahedron_triangles[3 * found->triangle + corner];
      CHECK(found->weights[corner] >= 0);
      for (int axis = 0; axis < 3; ++axis)
        sum[axis] += found->weights[corner] * octahedron_positions[3 * vertex + axis];
    }
    for (int axis = 0; axis < 3; ++axis) {
      CHECK_NEAR(found->position[axis], sum[axis], 8 * rounding_unit);
      if (i != 1) CHECK_NEAR(found->position[axis], nearest[3 * i + axis], 128 * rounding_unit * reach);
    }
    if (i != 5 && i != 6) CHECK(numbers[i] == (i < 2 ? 1 : 0));
  }
  /* On a vertex and on an edge: one of the sides. */
  CHECK((numbers[5] == 0 || numbers[5] == 1) && (numbers[6] == 0 || numbers[6] == 1));

  /* Bounds: as far as it is, hardly less, and none. */
  double bounds[POINTS];
  for (int i = 0; i < POINTS; ++i)
    bounds[i] = i == 3 ? INFINITY : i % 2 == 0 ? closest[i].distance : closest[i].distance * 0.999;
  rayc_closest_point bounded[POINTS];
  CHECK_OK(rayc_octree_closest_points(octree, mesh, &asked, bounds, bounded));
  for (int i = 0; i < POINTS; ++i) {
    if (i % 2 == 0 || i == 3 || i == 5) {
      CHECK(bounded[i].triangle == closest[i].triangle && bounded[i].distance == closest[i].distance);
    } else {
      CHECK(bounded[i].triangle == RAYC_NO_TRIANGLE && bounded[i].is_found == 0 && bounded[i].distance == 0);
      CHECK(bounded[i].weights[0] == 0 && bounded[i].position[0] == 0);
    }
  }
  CHECK_OK(rayc_octree_destroy(octree));
  CHECK_OK(rayc_mesh_destroy(mesh));
}

static void bad_input_is_refused_and_nothing_written(void) {
  rayc_mesh *mesh = mesh_of(RAYC_SCALAR_F64), *single = mesh_of(RAYC_SCALAR_F32), *other = octahedron_mesh(no_shift);
  rayc_octree *octree = octree_of(mesh), *octree_single = octree_of(single);
  double at[6] = {0.1, 0.2, 0.3, 0.2, 0, 0};
  rayc_vectors asked = packed(at, 2);
  rayc_closest_point closest[2];
  int32_t numbers[2] = {42, 42};
  memset(closest, 0x2A, sizeof closest);
  const rayc_closest_point before = closest[0];

  CHECK_STATUS(rayc_octree_closest_points(NULL, mesh, &asked, NULL, closest), RAYC_STATUS_NULL_POINTER, "octree");
  CHECK_STATUS(rayc_octree_closest_points(octree, NULL, &asked, NULL, closest), RAYC_STATUS_NULL_POINTER, "mesh");
  CHECK_STATUS(rayc_octree_closest_points(octree, mesh, NULL, NULL, closest), RAYC_STATUS_NULL_POINTER, "points");
  CHECK_STATUS(rayc_octree_closest_points(octree, mesh, &asked, NULL, NULL), RAYC_STATUS_NULL_POINTER, "closest");
  CHECK_STATUS(rayc_octree_winding_numbers(NULL, mesh, &asked, numbers), RAYC_STATUS_NULL_POINTER, "octree");
  CHECK_STATUS(rayc_octree_winding_numbers(octree, NULL, &asked, numbers), RAYC_STATUS_NULL_POINTER, "mesh");
  CHECK_STATUS(rayc_octree_winding_numbers(octree, mesh, NULL, numbers), RAYC_STATUS_NULL_POINTER, "points");
  CHECK_STATUS(rayc_octree_winding_numbers(octree, mesh, &asked, NULL), RAYC_STATUS_NULL_POINTER, "numbers");
  const rayc_vectors nowhere = packed(NULL, 2);
  CHECK_STATUS(rayc_octree_closest_points(octree, mesh, &nowhere, NULL, closest), RAYC_STATUS_NULL_POINTER,
               "points.data");
  asked.stride = 8;
  CHECK_STATUS(rayc_octree_closest_points(octree, mesh, &asked, NULL, closest), RAYC_STATUS_INVALID_STRIDE, "stride");
  CHECK_STATUS(rayc_octree_winding_numbers(octree, mesh, &asked, numbers), RAYC_STATUS_INVALID_STRIDE, "stride");
  asked = packed(at, 2);
  asked.scalar = 7;
  CHECK_STATUS(rayc_octree_closest_points(octree, mesh, &asked, NULL, closest), RAYC_STATUS_UNKNOWN_ENUM,
               "points.scalar");
  asked = packed(at, 2);

  const double odd[3] = {NAN, INFINITY, -INFINITY};
  for (int i = 0; i < 3; ++i) {
    at[4] = odd[i];
    CHECK_STATUS(rayc_octree_closest_points(octree, mesh, &asked, NULL, closest), RAYC_STATUS_NOT_FINITE, "point 1");
    CHECK_STATUS(rayc_octree_winding_numbers(octree, mesh, &asked, numbers), RAYC_STATUS_NOT_FINITE, "point 1");
  }
  at[4] = 1e300; /* no float */
  CHECK_STATUS(rayc_octree_closest_points(octree_single, single, &asked, NULL, closest), RAYC_STATUS_MESH_BEYOND_RANGE,
               "point 1");
  at[4] = 0;
  const double bad_bounds[2][2] = {{1, NAN}, {1, -0.5}};
  for (int i = 0; i < 2; ++i)
    CHECK_STATUS(rayc_octree_closest_points(octree, mesh, &asked, bad_bounds[i], closest), RAYC_STATUS_INVALID_OPTION,
                 "point 1");

  CHECK_STATUS(rayc_octree_closest_points(octree, single, &asked, NULL, closest), RAYC_STATUS_PRECISION_MISMATCH, "");
  CHECK_STATUS(rayc_octree_winding_numbers(octree_single, mesh, &asked, numbers), RAYC_STATUS_PRECISION_MISMATCH, "");
  CHECK_STATUS(rayc_octree_closest_points(octree, other, &asked, NULL, closest), RAYC_STATUS_OCTREE_OF_OTHER_MESH, "");
  CHECK_STATUS(rayc_octree_winding_numbers(octree, other, &asked, numbers), RAYC_STATUS_OCTREE_OF_OTHER_MESH, "");
  const rayc_vectors positions = packed(octahedron_positions, OCTAHEDRON_VERTICES);
  CHECK_OK(rayc_mesh_set_positions(mesh, &positions));
  CHECK_STATUS(rayc_octree_closest_points(octree, mesh, &asked, NULL, closest), RAYC_STATUS_OCTREE_STALE, "older");
  CHECK_STATUS(rayc_octree_winding_numbers(octree, mesh, &asked, numbers), RAYC_STATUS_OCTREE_STALE, "older");
  CHECK(memcmp(&before, &closest[0], sizeof before) == 0 && numbers[0] == 42);

  /* No points: nothing to do, and no arrays to have. */
  CHECK_OK(rayc_octree_update(octree, mesh));
  const rayc_vectors none = packed(NULL, 0);
  CHECK_OK(rayc_octree_closest_points(octree, mesh, &none, NULL, NULL));
  CHECK_OK(rayc_octree_winding_numbers(octree, mesh, &none, NULL));

  CHECK_OK(rayc_octree_destroy(octree));
  CHECK_OK(rayc_octree_destroy(octree_single));
  CHECK_OK(rayc_mesh_destroy(mesh));
  CHECK_OK(rayc_mesh_destroy(single));
  CHECK_OK(rayc_mesh_destroy(other));
}

/* A sheet has distances, but no inside. */
static void an_open_mesh_has_no_inside(void) {
  const double corners[12] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  const uint32_t triangles[6] = {0, 1, 2, 0, 2, 3};
  rayc_mesh_options options;
  CHECK_OK(rayc_default_mesh_options(sizeof options, &options));
  options.open = 1;
  const rayc_vectors positions = packed(corners, 4);
  rayc_mesh* mesh = NULL;
  CHECK_OK(rayc_mesh_create(&options, &positions, triangles, 2, &mesh));
  rayc_octree* octree = octree_of(mesh);
  const double at[3] = {0.25, 2, 0.75};
  const rayc_vectors asked = packed(at, 1);
  rayc_closest_point closest;
  int32_t number = 42;
  CHECK_OK(rayc_octree_closest_points(octree, mesh, &asked, NULL, &closest));
  CHECK(closest.triangle == 1 && closest.distance == 1.25);
  CHECK(closest.position[0] == 0.25 && closest.position[1] == 1 && closest.position[2] == 0);
  CHECK_STATUS(rayc_octree_winding_numbers(octree, mesh, &asked, &number), RAYC_STATUS_MESH_OPEN, "no inside");
  CHECK(number == 42);
  rayc_own_exit exits[4];
  size_t count = 42;
  CHECK_STATUS(rayc_octree_own_exits(octree, mesh, 4, exits, &count), RAYC_STATUS_MESH_OPEN, "no inside");
  CHECK(count == 42);
  CHECK_OK(rayc_octree_destroy(octree));
  CHECK_OK(rayc_mesh_destroy(mesh));
}

/* One mesh of two octahedra: the vertex +x of the first and -x of the second are inside the other, whose nearest face
   is (1 - |x| - |y| - |z|) / √3 away from within, the other's middle subtracted. */
static void own_exits_of_two_octahedra(rayc_scalar precision, double rounding_unit) {
  double corners[6 * OCTAHEDRON_VERTICES];
  uint32_t triangles[6 * OCTAHEDRON_TRIANGLES];
  octahedron_shifted(no_shift, corners);
  octahedron_shifted(octahedron_shift, corners + 3 * OCTAHEDRON_VERTICES);
  for (int i = 0; i < 6 * OCTAHEDRON_TRIANGLES; ++i)
    triangles[i] =
        octahedron_triangles[i % (3 * OCTAHEDRON_TRIANGLES)] + (i < 3 * OCTAHEDRON_TRIANGLES ? 0 : OCTAHEDRON_VERTICES);
  rayc_mesh_options options;
  CHECK_OK(rayc_default_mesh_options(sizeof options, &options));
  options.precision = precision;
  const rayc_vectors positions = packed(corners, 2 * OCTAHEDRON_VERTICES);
  rayc_mesh *mesh = NULL, *other = octahedron_mesh(no_shift), *unlike = mesh_of(RAYC_SCALAR_F32);
  CHECK_OK(rayc_mesh_create(&options, &positions, triangles, 2 * OCTAHEDRON_TRIANGLES, &mesh));
  rayc_octree *octree = octree_of(mesh), *octree_double = octree_of(other);
  rayc_own_exit exits[2 * OCTAHEDRON_VERTICES];
  size_t count = 42;
  CHECK_OK(rayc_octree_own_exits(octree, mesh, 2 * OCTAHEDRON_VERTICES, exits, &count));
  CHECK(count == 2 && exits[0].vertex == 0 && exits[1].vertex == OCTAHEDRON_VERTICES + 1);
  const double *shift = octahedron_shift, depth = fabs(1 - shift[0]) + fabs(shift[1]) + fabs(shift[2]);
  for (int i = 0; i < 2; ++i) {
    const rayc_own_exit* found = &exits[i];
    CHECK_NEAR(found->distance, (1 - depth) / sqrt(3), 128 * rounding_unit);
    CHECK(found->triangle / OCTAHEDRON_TRIANGLES == (i == 0 ? 1u : 0u));
    for (int axis = 0; axis < 3; ++axis) {
      double sum = 0;
      for (int corner = 0; corner < 3; ++corner)
        sum += found->weights[corner] * corners[3 * triangles[3 * found->triangle + corner] + axis];
      CHECK_NEAR(found->position[axis], sum, 16 * rounding_unit);
    }
  }

  const rayc_own_exit before = exits[1];
  count = 42;
  CHECK_STATUS(rayc_octree_own_exits(octree, mesh, 1, exits, &count), RAYC_STATUS_WRONG_COUNT, "there are 2 own exits");
  CHECK_STATUS(rayc_octree_own_exits(NULL, mesh, 2, exits, &count), RAYC_STATUS_NULL_POINTER, "octree");
  CHECK_STATUS(rayc_octree_own_exits(octree, NULL, 2, exits, &count), RAYC_STATUS_NULL_POINTER, "mesh");
  CHECK_STATUS(rayc_octree_own_exits(octree, mesh, 2, NULL, &count), RAYC_STATUS_NULL_POINTER, "exits");
  CHECK_STATUS(rayc_octree_own_exits(octree, mesh, 2, exits, NULL), RAYC_STATUS_NULL_POINTER, "count");
  CHECK_STATUS(rayc_octree_own_exits(octree_double, unlike, 2, exits, &count), RAYC_STATUS_PRECISION_MISMATCH, "");
  if (precision == RAYC_SCALAR_F64)
    CHECK_STATUS(rayc_octree_own_exits(octree, other, 2, exits, &count), RAYC_STATUS_OCTREE_OF_OTHER_MESH, "");
  CHECK_OK(rayc_mesh_set_positions(mesh, &positions));
  CHECK_STATUS(rayc_octree_own_exits(octree, mesh, 2, exits, &count), RAYC_STATUS_OCTREE_STALE, "older");
  CHECK(count == 42 && memcmp(&before, &exits[1], sizeof before) == 0);
  CHECK_OK(rayc_octree_own_exits(octree_double, other, 0, NULL, &count));
  CHECK(count == 0);

  CHECK_OK(rayc_octree_destroy(octree));
  CHECK_OK(rayc_octree_destroy(octree_double));
  CHECK_OK(rayc_mesh_destroy(mesh));
  CHECK_OK(rayc_mesh_destroy(other));
  CHECK_OK(rayc_mesh_destroy(unlike));
}

int main(void) {
  answers_are_those_of_the_formula(RAYC_SCALAR_F64, 1.1102230246251565e-16);
  answers_are_those_of_the_formula(RAYC_SCALAR_F32, 5.9604644775390625e-08);
  bad_input_is_refused_and_nothing_written();
  an_open_mesh_has_no_inside();
  own_exits_of_two_octahedra(RAYC_SCALAR_F64, 1.1102230246251565e-16);
  own_exits_of_two_octahedra(RAYC_SCALAR_F32, 5.9604644775390625e-08);
  return check_result();
}
