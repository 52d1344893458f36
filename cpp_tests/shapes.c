#include "shapes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

const double octahedron_positions[3 * OCTAHEDRON_VERTICES] = {
    1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1,
};

const uint32_t octahedron_triangles[3 * OCTAHEDRON_TRIANGLES] = {
    0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5,
};

const double octahedron_shift[3] = {1.5, 0.125, 0.0625};

void octahedron_shifted(const double shift[3], double positions[3 * OCTAHEDRON_VERTICES]) {
  for (size_t i = 0; i < 3 * OCTAHEDRON_VERTICES; ++i) {
    positions[i] = octahedron_positions[i] + shift[i % 3];
  }
}

rayc_vectors packed(const double* data, size_t count) {
  const rayc_vectors vectors = {data, count, 0, RAYC_SCALAR_F64};
  return vectors;
}

rayc_vectors_mut packed_mut(double* data, size_t count) {
  const rayc_vectors_mut vectors = {data, count, 0, RAYC_SCALAR_F64};
  return vectors;
}

rayc_detection_options from_vertices(void) {
  rayc_detection_options options;
  if (rayc_default_detection_options(sizeof options, &options) != RAYC_STATUS_OK) {
    fprintf(stderr, "no default options: %s\n", rayc_last_error_message());
    exit(1);
  }
  options.sampling = RAYC_SAMPLING_VERTICES;
  return options;
}

rayc_mesh* octahedron_mesh(const double shift[3]) {
  double positions[3 * OCTAHEDRON_VERTICES];
  octahedron_shifted(shift, positions);
  const rayc_vectors vectors = packed(positions, OCTAHEDRON_VERTICES);
  rayc_mesh* mesh = NULL;
  if (rayc_mesh_create(NULL, &vectors, octahedron_triangles, OCTAHEDRON_TRIANGLES, &mesh) != RAYC_STATUS_OK) {
    fprintf(stderr, "cannot make an octahedron: %s\n", rayc_last_error_message());
    exit(1);
  }
  return mesh;
}

#define ALONG 64
#define ACROSS 32

const double torus_shift[3] = {0.2, 0.1, 0.35};

void torus_shifted(const double shift[3], double positions[3 * TORUS_VERTICES]) {
  const double turn = 6.283185307179586;
  for (int i = 0; i < TORUS_VERTICES; ++i) {
    const double u = turn * (i / ACROSS) / ALONG, v = turn * (i % ACROSS) / ACROSS;
    const double radius = 1 + 0.4 * cos(v);
    positions[3 * i] = radius * cos(u) + shift[0];
    positions[3 * i + 1] = radius * sin(u) + shift[1];
    positions[3 * i + 2] = 0.4 * sin(v) + shift[2];
  }
}

rayc_mesh* torus_mesh(uint32_t precision, const double shift[3]) {
  static double positions[3 * TORUS_VERTICES];
  static uint32_t triangles[3 * 2 * TORUS_VERTICES];
  torus_shifted(shift, positions);
  for (uint32_t i = 0; i < ALONG; ++i) {
    for (uint32_t j = 0; j < ACROSS; ++j) {
      const uint32_t next = (i + 1) % ALONG * ACROSS, above = (j + 1) % ACROSS;
      const uint32_t a = i * ACROSS + j, b = next + j, c = next + above, d = i * ACROSS + above;
      const uint32_t both[6] = {a, b, c, a, c, d};
      for (uint32_t k = 0; k < 6; ++k) triangles[6 * a + k] = both[k];
    }
  }
  rayc_mesh_options options;
  rayc_mesh* mesh = NULL;
  const rayc_vectors vectors = packed(positions, TORUS_VERTICES);
  rayc_status status = rayc_default_mesh_options(sizeof options, &options);
  options.precision = precision;
  if (status == RAYC_STATUS_OK) status = rayc_mesh_create(&options, &vectors, triangles, 2 * TORUS_VERTICES, &mesh);
  if (status != RAYC_STATUS_OK) {
    fprintf(stderr, "cannot make a torus: %s\n", rayc_last_error_message());
    exit(1);
  }
  return mesh;
}
