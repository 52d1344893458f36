#include "shapes.h"

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
  options.sample_spacing = 0;
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
