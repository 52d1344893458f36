/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* What a library has to answer: four functions, and two for self-contact. Build them into a shared library, and run
 * python -m penetration_benchmark --c-library <file>. One thread calls, one pair at a time; lengths have no unit. */
#ifndef PENETRATION_H
#define PENETRATION_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Returned by the functions; those that return a number give the last two as -1 and -2. */
enum { PENETRATION_OK = 0, PENETRATION_NOT_SUPPORTED = 1, PENETRATION_FAILED = 2 };

/* A closed surface, triangles counter-clockwise seen from outside. */
typedef struct penetration_surface {
  const double* positions;   /* vertex_count times x, y, z */
  const uint32_t* triangles; /* triangle_count times three vertex numbers from 0 */
  size_t vertex_count;
  size_t triangle_count;
  int is_convex; /* 1 or 0 */
} penetration_surface;

/* Its force is weight * depth * direction on the first body, the opposite on the second. */
typedef struct penetration_contact {
  double first[3];     /* where it acts on the first body */
  double second[3];    /* and on the second */
  double direction[3]; /* of unit length: where it pushes the first body */
  double depth;        /* how far */
  double weight;       /* in a unit of the library's own */
} penetration_contact;

/* Takes a pair of bodies in place of the one before, which is freed; copies what it needs. Not timed. */
int penetration_load(const penetration_surface* first, const penetration_surface* second);

/* Moves both: a step begins. poses: for each body three rows of rotation and translation, r r r t; positions: the
 * vertices so placed, which stay until the next call. Take which you need. */
int penetration_move(const double poses[24], const double* first_positions, const double* second_positions);

/* Sets 1 for each vertex inside the other body, 0 for the others. */
int penetration_inside(uint8_t* first, uint8_t* second);

/* Writes the first `capacity` contacts at most and returns how many there are. It is called again with room for all. */
ptrdiff_t penetration_contacts(penetration_contact* contacts, size_t capacity);

/* For the task self. A library that has not got these two leaves them out. */

/* A body that may overlap itself. */
typedef struct penetration_body {
  const double* positions;    /* vertex_count times x, y, z, those of the surface first */
  const uint32_t* triangles;  /* of the surface, counter-clockwise seen from outside */
  const uint32_t* tetrahedra; /* tetrahedron_count times four vertex numbers, none inside out */
  size_t vertex_count;
  size_t triangle_count;
  size_t tetrahedron_count;
} penetration_body;

/* The shortest way out for a vertex of the surface that is inside another part of the body. */
typedef struct penetration_exit {
  uint32_t vertex;
  double point[3]; /* where it leads out */
} penetration_exit;

/* Takes a body in place of all before; copies what it needs. Not timed. */
int penetration_load_body(const penetration_body* body);

/* Moves the body's vertices: a step begins. Then as penetration_contacts(). */
ptrdiff_t penetration_exits(const double* positions, penetration_exit* exits, size_t capacity);

#ifdef __cplusplus
}
#endif

#endif
