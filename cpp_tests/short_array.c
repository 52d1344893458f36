/* A fault made on purpose, which scripts/sanitize.sh must see within the library: an array that is one vector shorter
   than the library is told. */
#include <stdlib.h>
#include <string.h>

#include "shapes.h"

int main(void) {
  double positions[3 * OCTAHEDRON_VERTICES];
  octahedron_shifted(octahedron_shift, positions);
  const size_t size = sizeof positions - 3 * sizeof *positions;
  double* shorter = malloc(size);
  if (shorter == NULL) {
    return 1;
  }
  memcpy(shorter, positions, size);
  const rayc_vectors vectors = packed(shorter, OCTAHEDRON_VERTICES);
  rayc_mesh* mesh = NULL;
  rayc_mesh_create(NULL, &vectors, octahedron_triangles, OCTAHEDRON_TRIANGLES, &mesh);
  rayc_mesh_destroy(mesh);
  free(shorter);
  return 0;
}
