/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* The example: every vertex against every triangle. Each vertex inside is pushed to the nearest point of the other
 * surface, with a third of the area around it as weight.
 * cc -std=c99 -O2 -shared -fPIC brute_force.c -o brute_force.so -lm */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "penetration.h"

typedef struct {
  penetration_surface surface; /* with triangles of our own, and positions as they were moved */
  uint32_t* triangles;
} body;

static body bodies[2];

static void subtract(const double* a, const double* b, double* out) {
  for (int i = 0; i < 3; ++i) out[i] = a[i] - b[i];
}

static double dot(const double* a, const double* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void cross(const double* a, const double* b, double* out) {
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}

static void corners_of(const body* b, size_t triangle, const double* corners[3]) {
  for (int i = 0; i < 3; ++i) corners[i] = b->surface.positions + 3 * (size_t)b->triangles[3 * triangle + i];
}

/* The sum of the solid angles of all triangles: 4 pi inside, 0 outside (Van Oosterom and Strackee 1983). */
static int is_inside(const double* point, const body* other) {
  double sum = 0;
  for (size_t t = 0; t < other->surface.triangle_count; ++t) {
    const double* corners[3];
    double v[3][3], length[3], normal[3];
    corners_of(other, t, corners);
    for (int i = 0; i < 3; ++i) {
      subtract(corners[i], point, v[i]);
      length[i] = sqrt(dot(v[i], v[i]));
    }
    cross(v[1], v[2], normal);
    sum += 2 * atan2(dot(v[0], normal), length[0] * length[1] * length[2] + dot(v[0], v[1]) * length[2] +
                                            dot(v[1], v[2]) * length[0] + dot(v[2], v[0]) * length[1]);
  }
  return sum > 6.283185307179586;
}

/* The nearest point of a segment. */
static void nearest_on_edge(const double* p, const double* a, const double* b, double* out) {
  double along[3], way[3], share;
  subtract(b, a, along);
  subtract(p, a, way);
  share = fmin(fmax(dot(way, along) / dot(along, along), 0), 1);
  for (int i = 0; i < 3; ++i) out[i] = a[i] + share * along[i];
}

/* The nearest point of the surface and the distance to it. */
static double nearest(const double* p, const body* other, double* out) {
  double least = HUGE_VAL;
  for (size_t t = 0; t < other->surface.triangle_count; ++t) {
    const double* c[3];
    double candidates[4][3], u[3], v[3], w[3], normal[3], turned[3], x, y, square;
    int count = 3;
    corners_of(other, t, c);
    for (int i = 0; i < 3; ++i) nearest_on_edge(p, c[i], c[(i + 1) % 3], candidates[i]);
    subtract(c[1], c[0], u);
    subtract(c[2], c[0], v);
    subtract(p, c[0], w);
    cross(u, v, normal);
    square = dot(normal, normal);
    cross(w, v, turned);
    x = dot(turned, normal) / square;
    cross(u, w, turned);
    y = dot(turned, normal) / square;
    if (x >= 0 && y >= 0 && x + y <= 1) {
      for (int i = 0; i < 3; ++i) candidates[3][i] = c[0][i] + x * u[i] + y * v[i];
      count = 4;
    }
    for (int i = 0; i < count; ++i) {
      double way[3], distance;
      subtract(candidates[i], p, way);
      distance = sqrt(dot(way, way));
      if (distance < least) {
        least = distance;
        memcpy(out, candidates[i], sizeof candidates[i]);
      }
    }
  }
  return least;
}

static double area_around(const body* b, uint32_t vertex) {
  double area = 0;
  for (size_t t = 0; t < b->surface.triangle_count; ++t) {
    const uint32_t* v = b->triangles + 3 * t;
    if (v[0] == vertex || v[1] == vertex || v[2] == vertex) {
      const double* c[3];
      double p[3], q[3], normal[3];
      corners_of(b, t, c);
      subtract(c[1], c[0], p);
      subtract(c[2], c[0], q);
      cross(p, q, normal);
      area += sqrt(dot(normal, normal)) / 6;
    }
  }
  return area;
}

int penetration_load(const penetration_surface* first, const penetration_surface* second) {
  const penetration_surface* surfaces[2] = {first, second};
  for (int i = 0; i < 2; ++i) {
    const size_t size = 3 * surfaces[i]->triangle_count * sizeof(uint32_t);
    uint32_t* triangles = realloc(bodies[i].triangles, size);
    if (!triangles) return PENETRATION_FAILED;
    memcpy(triangles, surfaces[i]->triangles, size);
    bodies[i].triangles = triangles;
    bodies[i].surface = *surfaces[i];
  }
  return PENETRATION_OK;
}

int penetration_move(const double poses[24], const double* first_positions, const double* second_positions) {
  (void)poses;
  bodies[0].surface.positions = first_positions;
  bodies[1].surface.positions = second_positions;
  return PENETRATION_OK;
}

int penetration_inside(uint8_t* first, uint8_t* second) {
  uint8_t* marks[2] = {first, second};
  for (int i = 0; i < 2; ++i)
    for (size_t v = 0; v < bodies[i].surface.vertex_count; ++v)
      marks[i][v] = (uint8_t)is_inside(bodies[i].surface.positions + 3 * v, &bodies[1 - i]);
  return PENETRATION_OK;
}

ptrdiff_t penetration_contacts(penetration_contact* contacts, size_t capacity) {
  size_t count = 0;
  for (int i = 0; i < 2; ++i) {
    for (uint32_t v = 0; v < bodies[i].surface.vertex_count; ++v) {
      const double* point = bodies[i].surface.positions + 3 * (size_t)v;
      double end[3], depth;
      if (!is_inside(point, &bodies[1 - i])) continue;
      depth = nearest(point, &bodies[1 - i], end);
      if (depth == 0) continue; /* on the surface: nowhere to be pushed */
      if (count < capacity) {
        penetration_contact* contact = contacts + count;
        memcpy(i ? contact->second : contact->first, point, sizeof end);
        memcpy(i ? contact->first : contact->second, end, sizeof end);
        for (int k = 0; k < 3; ++k) contact->direction[k] = (i ? -1 : 1) * (end[k] - point[k]) / depth;
        contact->depth = depth;
        contact->weight = area_around(&bodies[i], v);
      }
      ++count;
    }
  }
  return (ptrdiff_t)count;
}
