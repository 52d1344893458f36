/* Rays that stand for patches of triangles: a fine sphere half way in another, with few rays and with all of them. */
#include <math.h>

#include "check.h"

enum { RINGS = 40, SECTORS = 80, VERTICES = (RINGS - 1) * SECTORS + 2, TRIANGLES = 2 * SECTORS * (RINGS - 1) };

static double positions[2][3 * VERTICES];
static uint32_t triangles[3 * TRIANGLES];

static uint32_t vertex_at(int ring, int sector) { return (uint32_t)(1 + (ring - 1) * SECTORS + sector % SECTORS); }

static void add_triangle(size_t* count, uint32_t a, uint32_t b, uint32_t c) {
  uint32_t* triangle = triangles + 3 * (*count)++;
  triangle[0] = a;
  triangle[1] = b;
  triangle[2] = c;
}

/* A unit sphere by latitude and longitude, poles first and last, `shift` along x. */
static void make_sphere(double shift, double* out) {
  const double pi = 3.14159265358979323846;
  for (int ring = 0; ring <= RINGS; ++ring) {
    for (int sector = 0; sector < (ring % RINGS ? SECTORS : 1); ++sector) {
      const double u = pi * ring / RINGS, v = 2 * pi * sector / SECTORS;
      const size_t vertex = ring == 0 ? 0 : ring == RINGS ? VERTICES - 1 : vertex_at(ring, sector);
      out[3 * vertex] = sin(u) * cos(v) + shift;
      out[3 * vertex + 1] = sin(u) * sin(v);
      out[3 * vertex + 2] = cos(u);
    }
  }
}

static void make_triangles(void) {
  size_t count = 0;
  for (int sector = 0; sector < SECTORS; ++sector) {
    add_triangle(&count, 0, vertex_at(1, sector), vertex_at(1, sector + 1));
    for (int ring = 1; ring + 1 < RINGS; ++ring) {
      const uint32_t a = vertex_at(ring, sector), b = vertex_at(ring + 1, sector);
      const uint32_t c = vertex_at(ring + 1, sector + 1), d = vertex_at(ring, sector + 1);
      add_triangle(&count, a, b, c);
      add_triangle(&count, a, c, d);
    }
    add_triangle(&count, vertex_at(RINGS - 1, sector), VERTICES - 1, vertex_at(RINGS - 1, sector + 1));
  }
  CHECK(count == TRIANGLES);
}

/* The force on the first sphere along x, and how many rays it took. */
static double force(rayc_mesh* const meshes[2], rayc_octree* const octrees[2], const rayc_detection_options* options,
                    rayc_statistics* statistics) {
  rayc_contacts* contacts;
  CHECK_OK(rayc_contacts_create(&contacts));
  CHECK_OK(rayc_query_pair(options, meshes[0], octrees[0], meshes[1], octrees[1], contacts));
  CHECK_OK(rayc_contacts_statistics(contacts, sizeof *statistics, statistics));
  CHECK(statistics->rays ==
        statistics->contacts + statistics->misses + statistics->entry_hits + statistics->own_surface_hits);
  size_t count = 0;
  CHECK_OK(rayc_contacts_count(contacts, &count));
  double sum = 0;
  for (size_t i = 0; i < count; ++i) {
    rayc_contact contact;
    CHECK_OK(rayc_contacts_copy(contacts, i, 1, &contact));
    const double pressure = contact.area * contact.depth * contact.cos_alpha;
    sum += contact.direction[0] * (contact.colliding == 0 ? pressure : -pressure);
  }
  CHECK_OK(rayc_contacts_destroy(contacts));
  return sum;
}

/* How many triangles of both spheres have their middles where the boxes of both overlap. */
static uint64_t triangles_of_the_overlap(void) {
  uint64_t count = 0;
  for (size_t triangle = 0; triangle < 2 * (size_t)TRIANGLES; ++triangle) {
    const uint32_t* corners = triangles + 3 * (triangle % TRIANGLES);
    const double* points = positions[triangle / TRIANGLES];
    const double middle = (points[3 * corners[0]] + points[3 * corners[1]] + points[3 * corners[2]]) / 3;
    count += middle > 0.3 && middle < 1;
  }
  return count;
}

int main(void) {
  make_triangles();
  rayc_mesh* meshes[2];
  rayc_octree* octrees[2];
  for (int i = 0; i < 2; ++i) {
    make_sphere(1.3 * i, positions[i]);
    const rayc_vectors vectors = {positions[i], VERTICES, 0, RAYC_SCALAR_F64};
    CHECK_OK(rayc_mesh_create(NULL, &vectors, triangles, TRIANGLES, &meshes[i]));
    CHECK_OK(rayc_octree_create(NULL, meshes[i], &octrees[i]));
  }

  const uint64_t in_overlap = triangles_of_the_overlap();

  rayc_detection_options options;
  CHECK_OK(rayc_default_detection_options(sizeof options, &options));
  rayc_statistics all, few;
  CHECK(options.sampling == RAYC_SAMPLING_ACCURACY && options.sampling_value == 0);
  const double by_default = force(meshes, octrees, &options, &few);
  /* The judge: a dozen rays from each triangle. */
  options.sampling = RAYC_SAMPLING_SPACING;
  options.sampling_value = 0.02;
  const double exact = force(meshes, octrees, &options, &all);
  CHECK(exact < 0 && all.patches == 0 && all.estimate_rays == 0);
  /* Of true spheres it is 2π ∫ (1 − r) μ dμ, r² = 2.69 − 2.6 μ, μ from 0.65 to 1. */
  CHECK(fabs(exact + 0.56332) <= 0.01 * 0.56332);
  printf("exact %g from %g rays; %g triangles\n", exact, (double)all.rays, (double)in_overlap);
  const double accuracies[3] = {0.01, 0.02, 0.1};
  options.sampling = RAYC_SAMPLING_ACCURACY;
  for (int i = 0; i < 3; ++i) {
    options.sampling_value = accuracies[i];
    const double near_enough = force(meshes, octrees, &options, &few);
    printf("accuracy %g: %.3g %% off, %g + %g rays\n", accuracies[i], 100 * fabs(near_enough / exact - 1),
           (double)few.rays, (double)few.estimate_rays);
    CHECK(fabs(near_enough - exact) <= accuracies[i] * fabs(exact));
    CHECK(few.estimate_rays > 0);
    CHECK(i > 0 || near_enough == by_default); /* 0 stands for 0.01 */
  }
  CHECK(few.patches > 0 && 2 * (few.rays + few.estimate_rays) < in_overlap);

  options.sampling = RAYC_SAMPLING_SPACING;
  options.sampling_value = 0.15;
  const double apart = force(meshes, octrees, &options, &few);
  printf("%g rays 0.15 apart: %.3g %% off\n", (double)few.rays, 100 * fabs(apart / exact - 1));
  CHECK(fabs(apart - exact) <= 0.05 * fabs(exact));
  CHECK(few.patches > 0 && few.estimate_rays == 0 && 4 * few.rays < in_overlap);

  /* Each way to choose has values of its own. */
  rayc_contacts* contacts;
  CHECK_OK(rayc_contacts_create(&contacts));
  const struct {
    rayc_sampling sampling;
    double value;
    const char* message;
  } bad[] = {
      {RAYC_SAMPLING_VERTICES, 0.15, "RAYC_SAMPLING_VERTICES; give 0"},
      {RAYC_SAMPLING_SPACING, 0, "a finite length > 0"},
      {RAYC_SAMPLING_SPACING, -1, "a finite length > 0"},
      {RAYC_SAMPLING_SPACING, INFINITY, "a finite length > 0"},
      {RAYC_SAMPLING_ACCURACY, -0.1, "RAYC_SAMPLING_ACCURACY; give a part > 0 and at most 1, or 0 for the default"},
      {RAYC_SAMPLING_ACCURACY, 1.5, "a part > 0 and at most 1, or 0 for the default"},
      {RAYC_SAMPLING_ACCURACY, NAN, "a part > 0 and at most 1, or 0 for the default"},
  };
  for (size_t i = 0; i < sizeof bad / sizeof *bad; ++i) {
    options.sampling = bad[i].sampling;
    options.sampling_value = bad[i].value;
    CHECK_STATUS(rayc_query_pair(&options, meshes[0], octrees[0], meshes[1], octrees[1], contacts),
                 RAYC_STATUS_INVALID_OPTION, bad[i].message);
  }
  options.sampling = 3;
  CHECK_STATUS(rayc_query_pair(&options, meshes[0], octrees[0], meshes[1], octrees[1], contacts),
               RAYC_STATUS_UNKNOWN_ENUM, "rayc_sampling");
  CHECK_OK(rayc_default_detection_options(sizeof options, &options));
  options.reserved = 1;
  CHECK_STATUS(rayc_query_pair(&options, meshes[0], octrees[0], meshes[1], octrees[1], contacts),
               RAYC_STATUS_INVALID_OPTION, "reserved of rayc_detection_options is 1");
  CHECK_OK(rayc_contacts_destroy(contacts));
  for (int i = 0; i < 2; ++i) {
    CHECK_OK(rayc_octree_destroy(octrees[i]));
    CHECK_OK(rayc_mesh_destroy(meshes[i]));
  }
  return check_result();
}
