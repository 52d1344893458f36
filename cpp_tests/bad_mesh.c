/* Every mesh that is not a closed outward surface is refused with its own status, and no handle is made. */
#include "check.h"
#include "shapes.h"
#include <math.h>

#define MAX_TRIANGLES 16

typedef struct mesh_case {
  double positions[3 * 12];
  size_t vertex_count;
  uint32_t triangles[3 * MAX_TRIANGLES];
  size_t triangle_count;
} mesh_case;

static mesh_case octahedron(void) {
  mesh_case mesh;
  memset(&mesh, 0, sizeof mesh);
  memcpy(mesh.positions, octahedron_positions, sizeof octahedron_positions);
  memcpy(mesh.triangles, octahedron_triangles, sizeof octahedron_triangles);
  mesh.vertex_count = OCTAHEDRON_VERTICES;
  mesh.triangle_count = OCTAHEDRON_TRIANGLES;
  return mesh;
}

static void flip(mesh_case* mesh, size_t triangle) {
  const uint32_t first = mesh->triangles[3 * triangle];
  mesh->triangles[3 * triangle] = mesh->triangles[3 * triangle + 1];
  mesh->triangles[3 * triangle + 1] = first;
}

/* The mesh is refused with `status`, the message says each of the two parts, and the output stays untouched. */
static void check_refused(const char* name, const mesh_case* mesh, rayc_status status, const char* part,
                          const char* other_part) {
  static int sentinel;
  rayc_mesh* const untouched = (rayc_mesh*)(void*)&sentinel;
  rayc_mesh* handle = untouched;
  const int failures_before = check_failures;
  const rayc_vectors vectors = packed(mesh->positions, mesh->vertex_count);

  const rayc_status actual = rayc_mesh_create(NULL, &vectors, mesh->triangles, mesh->triangle_count, &handle);
  CHECK_STATUS(actual, status, part);
  CHECK_STATUS(actual, status, other_part);
  CHECK(handle == untouched);
  if (check_failures != failures_before) {
    fprintf(stderr, "  in case: %s\n", name);
  }
}

static void refuses_an_empty_mesh(void) {
  mesh_case mesh = octahedron();
  mesh.triangle_count = 0;
  check_refused("no triangles", &mesh, RAYC_STATUS_MESH_EMPTY, "triangle", NULL);
  mesh = octahedron();
  mesh.vertex_count = 0;
  mesh.triangle_count = 0;
  check_refused("no vertices", &mesh, RAYC_STATUS_MESH_EMPTY, NULL, NULL);
}

static void refuses_an_index_out_of_range(void) {
  mesh_case mesh = octahedron();
  mesh.triangles[3 * 5 + 1] = 6;
  check_refused("index 6 of 6", &mesh, RAYC_STATUS_MESH_INDEX_OUT_OF_RANGE, "triangle 5", "6");
  mesh.triangles[3 * 5 + 1] = UINT32_MAX;
  check_refused("largest index", &mesh, RAYC_STATUS_MESH_INDEX_OUT_OF_RANGE, "triangle 5", "4294967295");
}

static void refuses_a_degenerate_triangle(void) {
  mesh_case mesh = octahedron();
  mesh.triangles[3 * 3 + 2] = mesh.triangles[3 * 3];
  check_refused("one vertex twice", &mesh, RAYC_STATUS_MESH_DEGENERATE_TRIANGLE, "triangle 3", NULL);

  /* Corners on a line: +z between +x and +y. Triangle 0 is the only one with all three. */
  static const double halfway[3] = {0.5, 0.5, 0};
  mesh = octahedron();
  memcpy(&mesh.positions[3 * 4], halfway, sizeof halfway);
  check_refused("corners on a line", &mesh, RAYC_STATUS_MESH_DEGENERATE_TRIANGLE, "triangle 0", NULL);
}

static void refuses_an_open_mesh(void) {
  mesh_case mesh = octahedron();
  mesh.triangle_count = 7; /* without 0 3 5: its edges are 0-3, 3-5, 5-0 */
  check_refused("a hole", &mesh, RAYC_STATUS_MESH_OPEN, "edge", NULL);
  mesh.triangle_count = 1;
  check_refused("one triangle", &mesh, RAYC_STATUS_MESH_OPEN, "triangle 0", NULL);

  /* Unless the options say that it may be. */
  rayc_mesh_options options;
  CHECK_OK(rayc_default_mesh_options(sizeof options, &options));
  CHECK(options.open == 0);
  options.open = 1;
  const rayc_vectors positions = packed(mesh.positions, OCTAHEDRON_VERTICES);
  rayc_mesh* made = NULL;
  CHECK_OK(rayc_mesh_create(&options, &positions, mesh.triangles, 7, &made));
  CHECK_OK(rayc_mesh_destroy(made));
  options.open = 2;
  CHECK_STATUS(rayc_mesh_create(&options, &positions, mesh.triangles, 7, &made), RAYC_STATUS_INVALID_OPTION, "open");

  /* Or that holes are to be closed. */
  options.open = 0;
  options.close_holes = 0.2;
  size_t count = 0;
  rayc_hole hole;
  CHECK_OK(rayc_mesh_create(&options, &positions, mesh.triangles, 7, &made));
  CHECK_OK(rayc_mesh_triangle_count(made, &count));
  CHECK(count == 8);
  CHECK_OK(rayc_mesh_hole_count(made, &count));
  CHECK(count == 1);
  CHECK_OK(rayc_mesh_copy_holes(made, 1, &hole));
  CHECK(hole.first_triangle == 7 && hole.triangle_count == 1 && fabs(hole.area_share - 1.0 / 7) < 1e-15);
  CHECK_STATUS(rayc_mesh_copy_holes(made, 2, &hole), RAYC_STATUS_WRONG_COUNT, "holes");
  CHECK_OK(rayc_mesh_destroy(made));
  options.close_holes = 0.1;
  CHECK_STATUS(rayc_mesh_create(&options, &positions, mesh.triangles, 7, &made), RAYC_STATUS_MESH_OPEN, "0.143");
  options.close_holes = 2;
  CHECK_STATUS(rayc_mesh_create(&options, &positions, mesh.triangles, 7, &made), RAYC_STATUS_INVALID_OPTION, "0 to 1");
  options.close_holes = 0.2;
  options.open = 1;
  CHECK_STATUS(rayc_mesh_create(&options, &positions, mesh.triangles, 7, &made), RAYC_STATUS_INVALID_OPTION,
               "leave one of them 0");
}

static void refuses_an_inconsistent_orientation(void) {
  mesh_case mesh = octahedron();
  flip(&mesh, 2);
  check_refused("one triangle flipped", &mesh, RAYC_STATUS_MESH_INCONSISTENT_ORIENTATION, "triangle", "2");
}

static void refuses_a_non_manifold_mesh(void) {
  /* Two tetrahedra, each closed and outward, that share the edge 0-1: four triangles meet there. */
  static const double positions[] = {0, 0, 0, 0, 0, 1, 1, 0, 0, 0, 1, 0, -1, 0, 0, 0, -1, 0};
  static const uint32_t triangles[] = {0, 3, 2, 0, 2, 1, 0, 1, 3, 2, 3, 1, 0, 5, 4, 0, 4, 1, 0, 1, 5, 4, 5, 1};
  mesh_case mesh = octahedron();
  memcpy(mesh.positions, positions, sizeof positions);
  memcpy(mesh.triangles, triangles, sizeof triangles);
  check_refused("four triangles at an edge", &mesh, RAYC_STATUS_MESH_NON_MANIFOLD, "edge (0, 1)", "4 triangles");
}

static void refuses_an_inward_mesh(void) {
  mesh_case mesh = octahedron();
  for (size_t i = 0; i < mesh.triangle_count; ++i) {
    flip(&mesh, i);
  }
  check_refused("inside out", &mesh, RAYC_STATUS_MESH_INWARD, "inside out", NULL);
}

/* A second octahedron of half the size and inside out, `away` from the first along x. */
static mesh_case with_inward_part(double away) {
  mesh_case mesh = octahedron();
  for (size_t i = 0; i < 3 * OCTAHEDRON_VERTICES; ++i) {
    mesh.positions[3 * OCTAHEDRON_VERTICES + i] = mesh.positions[i] / 2 + (i % 3 == 0 ? away : 0);
  }
  for (size_t i = 0; i < OCTAHEDRON_TRIANGLES; ++i) {
    for (size_t k = 0; k < 3; ++k) {
      mesh.triangles[3 * (OCTAHEDRON_TRIANGLES + i) + k] = mesh.triangles[3 * i + k] + OCTAHEDRON_VERTICES;
    }
    flip(&mesh, OCTAHEDRON_TRIANGLES + i);
  }
  mesh.vertex_count = 2 * OCTAHEDRON_VERTICES;
  mesh.triangle_count = 2 * OCTAHEDRON_TRIANGLES;
  return mesh;
}

static void refuses_an_inward_part(void) {
  mesh_case mesh = with_inward_part(5);
  /* Its triangles are 8 to 15; the sum of both volumes is positive. */
  mesh_case turned = mesh;
  check_refused("beside", &mesh, RAYC_STATUS_MESH_INWARD, "inside out", "with triangle 1");
  for (size_t i = 0; i < turned.triangle_count; ++i) {
    flip(&turned, i);
  }
  check_refused("the other one", &turned, RAYC_STATUS_MESH_INWARD, "inside out", "count from 0");
  mesh = with_inward_part(0.75);
  check_refused("sticks out", &mesh, RAYC_STATUS_MESH_INWARD, "inside out", "with triangle ");
}

static void refuses_a_flat_part(void) {
  static const uint32_t both_sides[] = {0, 2, 4, 0, 4, 2};
  mesh_case mesh = octahedron();
  memcpy(mesh.triangles, both_sides, sizeof both_sides);
  mesh.triangle_count = 2;
  check_refused("two sides of one triangle", &mesh, RAYC_STATUS_MESH_FLAT, "encloses no volume", "triangle 0");
}

/* Numbers, but too large for the mesh's precision: by themselves, or as areas. */
static void refuses_what_is_beyond_the_range(void) {
  mesh_case mesh = octahedron();
  for (size_t i = 0; i < 3 * OCTAHEDRON_VERTICES; ++i) {
    mesh.positions[i] *= 1e200;
  }
  check_refused("areas overflow", &mesh, RAYC_STATUS_MESH_BEYOND_RANGE, "triangle 0", "largest number");

  rayc_mesh_options options;
  CHECK_OK(rayc_default_mesh_options(sizeof options, &options));
  options.precision = RAYC_SCALAR_F32;
  mesh = octahedron();
  mesh.positions[3 * 4 + 2] = 1e39;
  const rayc_vectors vectors = packed(mesh.positions, mesh.vertex_count);
  rayc_mesh* handle = NULL;
  const rayc_status actual = rayc_mesh_create(&options, &vectors, mesh.triangles, mesh.triangle_count, &handle);
  CHECK_STATUS(actual, RAYC_STATUS_MESH_BEYOND_RANGE, "vertex 4 has the coordinate 1e39");
  CHECK_STATUS(actual, RAYC_STATUS_MESH_BEYOND_RANGE, "double precision");
  CHECK(handle == NULL);
}

static void refuses_positions_that_are_not_finite(void) {
  const double bad[] = {NAN, INFINITY, -INFINITY};
  for (size_t i = 0; i < sizeof bad / sizeof *bad; ++i) {
    mesh_case mesh = octahedron();
    mesh.positions[3 * 4 + i] = bad[i];
    check_refused("not finite", &mesh, RAYC_STATUS_NOT_FINITE, "vertex 4", "check the input");
  }
}

static void check_accepted(const mesh_case* mesh) {
  const rayc_vectors vectors = packed(mesh->positions, mesh->vertex_count);
  rayc_mesh* handle = NULL;
  CHECK_OK(rayc_mesh_create(NULL, &vectors, mesh->triangles, mesh->triangle_count, &handle));
  CHECK(handle != NULL);
  CHECK_OK(rayc_mesh_destroy(handle));
}

static void accepts_a_vertex_without_triangle(void) {
  mesh_case mesh = octahedron();
  mesh.vertex_count = OCTAHEDRON_VERTICES + 1; /* the inner node of a volume mesh, at the origin */
  check_accepted(&mesh);
}

/* Modelled surfaces have such vertices, and inside and outside are clear all the same. */
static void accepts_sheets_that_touch_in_a_vertex(void) {
  static const double positions[] = {0, 0, 0, 0, 0, 1, 1, 0, 0, 0, 1, 0, -1, 0, 0, 0, -1, 0, -0.5, -0.5, 1};
  static const uint32_t triangles[] = {0, 3, 2, 0, 2, 1, 0, 1, 3, 2, 3, 1, 0, 5, 4, 0, 4, 6, 0, 6, 5, 4, 5, 6};
  mesh_case mesh = octahedron();
  memcpy(mesh.positions, positions, sizeof positions);
  memcpy(mesh.triangles, triangles, sizeof triangles);
  mesh.vertex_count = 7;
  check_accepted(&mesh);
}

/* A hollow body: its inner surface faces the hollow. */
static void accepts_a_cavity(void) {
  const mesh_case mesh = with_inward_part(0);
  check_accepted(&mesh);
}

int main(void) {
  refuses_an_empty_mesh();
  refuses_an_index_out_of_range();
  refuses_a_degenerate_triangle();
  refuses_an_open_mesh();
  refuses_an_inconsistent_orientation();
  refuses_a_non_manifold_mesh();
  refuses_an_inward_mesh();
  refuses_an_inward_part();
  refuses_a_flat_part();
  refuses_what_is_beyond_the_range();
  refuses_positions_that_are_not_finite();
  accepts_a_cavity();
  accepts_a_vertex_without_triangle();
  accepts_sheets_that_touch_in_a_vertex();
  return check_result();
}
