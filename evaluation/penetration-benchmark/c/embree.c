/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* Algorithm 1 of Hermann, Faure and Raffin 2008 on Embree 3.13: from each vertex in the other body's box a ray along
 * the inward normal; where it leaves the other body before its own it is a contact. One tree a body, refitted in each
 * step, robust traversal. cc -std=c99 -O3 -march=native -shared -fPIC embree.c -o embree.so -lembree3 -lm
 * With -DEMBREE_4 for a library of Embree 4, whose headers need not be there: it differs in how a ray is asked for. */
#include <embree3/rtcore.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "penetration.h"

typedef struct {
  size_t vertex_count, triangle_count;
  uint32_t* triangles;
  float *positions, *normals;
  float low[3], high[3];
  RTCScene scene;
  RTCGeometry geometry;
} body;

#ifdef EMBREE_4
/* As Embree 4 has them, from its manual (rtcIntersect1, rtcInitIntersectArguments). */
typedef struct {
  unsigned instance, part_of_instance;
} query_context;
typedef struct {
  unsigned flags, features;
  query_context* context;
  RTCFilterFunctionN filter;
  void (*intersect)(const void*);
} query_arguments;
enum { INVOKES_FILTER = 1 << 1 };
/* Its hits have one number more than Embree 3's, which ends in the padding. */
typedef union {
  struct RTCRayHit ray;
  char of_4[sizeof(struct RTCRayHit) + 16];
} ray_and_hit;
void intersect_4(RTCScene, ray_and_hit*, query_arguments*) __asm__("rtcIntersect1");
#else
typedef struct RTCIntersectContext query_context;
typedef union {
  struct RTCRayHit ray;
} ray_and_hit;
#endif

typedef struct {
  query_context embree;
  const uint32_t* triangles;
  uint32_t vertex;
} context;

static RTCDevice device;
static body bodies[2];

/* Refuses the triangles around the vertex that the ray starts from. Single rays only, so there is one hit. */
static void refuse_touched(const struct RTCFilterFunctionNArguments* arguments) {
  const context* c = (const context*)arguments->context;
  const uint32_t* corner = c->triangles + 3 * (size_t)((const struct RTCHit*)arguments->hit)->primID;
  if (corner[0] == c->vertex || corner[1] == c->vertex || corner[2] == c->vertex) arguments->valid[0] = 0;
}

static void release(body* b) {
  if (b->scene) {
    rtcReleaseGeometry(b->geometry);
    rtcReleaseScene(b->scene);
  }
  free(b->triangles);
  free(b->positions);
  free(b->normals);
  memset(b, 0, sizeof *b);
}

static int make(body* b, const penetration_surface* surface) {
  release(b);
  b->vertex_count = surface->vertex_count;
  b->triangle_count = surface->triangle_count;
  b->triangles = malloc(3 * surface->triangle_count * sizeof(uint32_t));
  b->positions = malloc((3 * surface->vertex_count + 1) * sizeof(float)); /* Embree reads 16 bytes at the last one */
  b->normals = malloc(3 * surface->vertex_count * sizeof(float));
  if (!b->triangles || !b->positions || !b->normals) return PENETRATION_FAILED;
  memcpy(b->triangles, surface->triangles, 3 * surface->triangle_count * sizeof(uint32_t));
  for (size_t i = 0; i < 3 * surface->vertex_count; ++i) b->positions[i] = (float)surface->positions[i];
  b->scene = rtcNewScene(device);
  rtcSetSceneFlags(b->scene, RTC_SCENE_FLAG_DYNAMIC | RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
  /* Only so does a scene keep one tree for each geometry, which alone can be refitted. */
  rtcSetSceneBuildQuality(b->scene, RTC_BUILD_QUALITY_LOW);
  b->geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetGeometryBuildQuality(b->geometry, RTC_BUILD_QUALITY_REFIT);
  rtcSetSharedGeometryBuffer(b->geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, b->positions, 0,
                             3 * sizeof(float), b->vertex_count);
  rtcSetSharedGeometryBuffer(b->geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, b->triangles, 0,
                             3 * sizeof(uint32_t), b->triangle_count);
  rtcCommitGeometry(b->geometry);
  rtcAttachGeometry(b->scene, b->geometry);
  rtcCommitScene(b->scene);
  return rtcGetDeviceError(device) == RTC_ERROR_NONE ? PENETRATION_OK : PENETRATION_FAILED;
}

static void find_normals(body* b) {
  memset(b->normals, 0, 3 * b->vertex_count * sizeof(float));
  for (size_t t = 0; t < b->triangle_count; ++t) {
    const uint32_t* v = b->triangles + 3 * t;
    const float *p = b->positions + 3 * (size_t)v[0], *q = b->positions + 3 * (size_t)v[1],
                *r = b->positions + 3 * (size_t)v[2];
    float u[3], w[3];
    for (int i = 0; i < 3; ++i) u[i] = q[i] - p[i], w[i] = r[i] - p[i];
    for (int i = 0; i < 3; ++i) {
      const float n = u[(i + 1) % 3] * w[(i + 2) % 3] - u[(i + 2) % 3] * w[(i + 1) % 3];
      for (int k = 0; k < 3; ++k) b->normals[3 * (size_t)v[k] + i] += n;
    }
  }
}

static struct RTCRayHit trace(const body* b, const float* origin, const float* direction, context* c, float reach,
                              RTCFilterFunctionN filter) {
  ray_and_hit with_room;
  struct RTCRayHit* ray = &with_room.ray;
  memset(&with_room, 0, sizeof with_room);
  ray->ray.org_x = origin[0], ray->ray.org_y = origin[1], ray->ray.org_z = origin[2];
  ray->ray.dir_x = direction[0], ray->ray.dir_y = direction[1], ray->ray.dir_z = direction[2];
  ray->ray.tfar = reach;
  ray->ray.mask = UINT32_MAX;
  ray->hit.geomID = RTC_INVALID_GEOMETRY_ID;
#ifdef EMBREE_4
  {
    query_arguments arguments = {filter ? INVOKES_FILTER : 0, UINT32_MAX, &c->embree, filter, NULL};
    c->embree.instance = c->embree.part_of_instance = RTC_INVALID_GEOMETRY_ID;
    intersect_4(b->scene, &with_room, &arguments);
  }
#else
  rtcInitIntersectContext(&c->embree);
  c->embree.filter = filter;
  rtcIntersect1(b->scene, &c->embree, ray);
#endif
  return *ray;
}

typedef struct {
  float direction[3], length, cosine;
} found;

/* Whether vertex v of body i has a contact: then where its ray leads, how far it runs, and the cosine there. */
static int find_contact(int i, uint32_t v, found* out) {
  const body *own = &bodies[i], *other = &bodies[1 - i];
  const float *p = own->positions + 3 * (size_t)v, *n = own->normals + 3 * (size_t)v;
  const float size = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  float *direction = out->direction, along;
  struct RTCRayHit hit;
  context c;
  if (!(size > 0)) return 0;
  for (int k = 0; k < 3; ++k) {
    if (p[k] < other->low[k] || p[k] > other->high[k]) return 0;
    direction[k] = -n[k] / size;
  }
  hit = trace(other, p, direction, &c, HUGE_VALF, NULL);
  if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) return 0;
  along = hit.hit.Ng_x * direction[0] + hit.hit.Ng_y * direction[1] + hit.hit.Ng_z * direction[2];
  if (along <= 0) return 0;
  out->cosine = along / sqrtf(hit.hit.Ng_x * hit.hit.Ng_x + hit.hit.Ng_y * hit.hit.Ng_y + hit.hit.Ng_z * hit.hit.Ng_z);
  out->length = hit.ray.tfar;
  c.triangles = own->triangles;
  c.vertex = v;
  return trace(own, p, direction, &c, out->length, refuse_touched).hit.geomID == RTC_INVALID_GEOMETRY_ID;
}

int penetration_load(const penetration_surface* first, const penetration_surface* second) {
  int status;
  if (!device) device = rtcNewDevice("threads=1");
  if (!device) return PENETRATION_FAILED;
  status = make(&bodies[0], first);
  return status ? status : make(&bodies[1], second);
}

int penetration_move(const double poses[24], const double* first_positions, const double* second_positions) {
  const double* positions[2] = {first_positions, second_positions};
  (void)poses;
  for (int i = 0; i < 2; ++i) {
    body* b = &bodies[i];
    for (int k = 0; k < 3; ++k) b->low[k] = HUGE_VALF, b->high[k] = -HUGE_VALF;
    for (size_t v = 0; v < b->vertex_count; ++v)
      for (int k = 0; k < 3; ++k) {
        const float x = (float)positions[i][3 * v + k];
        b->positions[3 * v + k] = x;
        b->low[k] = fminf(b->low[k], x);
        b->high[k] = fmaxf(b->high[k], x);
      }
  }
  return PENETRATION_OK;
}

static void refit(void) {
  for (int i = 0; i < 2; ++i) {
    rtcUpdateGeometryBuffer(bodies[i].geometry, RTC_BUFFER_TYPE_VERTEX, 0);
    rtcCommitGeometry(bodies[i].geometry);
    rtcCommitScene(bodies[i].scene);
    find_normals(&bodies[i]);
  }
}

/* Its own opinion: the vertices that have a contact. */
int penetration_inside(uint8_t* first, uint8_t* second) {
  uint8_t* marks[2] = {first, second};
  refit();
  for (int i = 0; i < 2; ++i)
    for (uint32_t v = 0; v < bodies[i].vertex_count; ++v) {
      found ray;
      marks[i][v] = (uint8_t)find_contact(i, v, &ray);
    }
  return PENETRATION_OK;
}

ptrdiff_t penetration_contacts(penetration_contact* contacts, size_t capacity) {
  size_t count = 0;
  refit();
  for (int i = 0; i < 2; ++i)
    for (uint32_t v = 0; v < bodies[i].vertex_count; ++v) {
      found ray;
      if (!find_contact(i, v, &ray)) continue;
      if (count < capacity) {
        penetration_contact* contact = contacts + count;
        for (int k = 0; k < 3; ++k) {
          const double p = bodies[i].positions[3 * (size_t)v + k];
          (i ? contact->second : contact->first)[k] = p;
          (i ? contact->first : contact->second)[k] = p + (double)ray.length * ray.direction[k];
          contact->direction[k] = (i ? -1 : 1) * ray.direction[k];
        }
        contact->depth = ray.length;
        contact->weight = ray.cosine;
      }
      ++count;
    }
  return (ptrdiff_t)count;
}
