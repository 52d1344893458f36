/* Small closed shapes with known answers. */
#ifndef SHAPES_H
#define SHAPES_H

#include "raycontact.h"

#define OCTAHEDRON_VERTICES 6
#define OCTAHEDRON_TRIANGLES 8

/* Radius 1 around the origin. Vertices: +x, -x, +y, -y, +z, -z, so each vertex normal is exactly an axis. */
extern const double octahedron_positions[3 * OCTAHEDRON_VERTICES];
extern const uint32_t octahedron_triangles[3 * OCTAHEDRON_TRIANGLES];

/* Overlapped like this, the vertex +x of the first and the vertex -x of the second octahedron are inside the other,
   each at SHIFTED_DEPTH along its ray; every number is a sum of a few powers of two, exact in float. */
extern const double octahedron_shift[3];
#define SHIFTED_DEPTH 0.3125

void octahedron_shifted(const double shift[3], double positions[3 * OCTAHEDRON_VERTICES]);

/* Packed 3-vectors of doubles. */
rayc_vectors packed(const double* data, size_t count);
rayc_vectors_mut packed_mut(double* data, size_t count);

/* The paper's rays, from the vertices: few enough to be known one by one. */
rayc_detection_options from_vertices(void);

/* A mesh with default options; ends the program if it cannot be made. */
rayc_mesh* octahedron_mesh(const double shift[3]);

#define TORUS_VERTICES 2048

/* Around the z axis, of radii 1 and 0.4. */
void torus_shifted(const double shift[3], double positions[3 * TORUS_VERTICES]);

/* Two that overlap have rays enough to be shared between threads. precision: a rayc_scalar. */
rayc_mesh* torus_mesh(uint32_t precision, const double shift[3]);

/* Overlapped like this with one that is not shifted. */
extern const double torus_shift[3];

#endif
