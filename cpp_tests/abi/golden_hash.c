/* golden_hash <file>: the five scenes of the Rust example `hash`, through C: the last line printed must be the file's.
   Linked with the shared and with the static library. */
#include <stdlib.h>

#include "check.h"

#define FNV_OFFSET UINT64_C(0xcbf29ce484222325)
#define MOST_BODIES 5
#define STEPS 8

/* FNV-1a over 64-bit words. */
static void add_word(uint64_t* hash, uint64_t word) {
  for (int byte = 0; byte < 8; ++byte) *hash = (*hash ^ (word >> 8 * byte & 0xff)) * UINT64_C(0x100000001b3);
}

static void add_number(uint64_t* hash, double number) {
  uint64_t bits;
  memcpy(&bits, &number, sizeof bits);
  add_word(hash, bits);
}

static void add_numbers(uint64_t* hash, const double* numbers) {
  for (int i = 0; i < 3; ++i) add_number(hash, numbers[i]);
}

static void add_point(uint64_t* hash, const rayc_surface_point* point) {
  add_word(hash, point->triangle);
  for (int i = 0; i < 3; ++i) add_word(hash, point->vertices[i]);
  add_numbers(hash, point->weights);
  add_numbers(hash, point->position);
}

static void add_contacts(uint64_t* hash, const rayc_contacts* contacts) {
  size_t count = 0;
  CHECK_OK(rayc_contacts_count(contacts, &count));
  rayc_contact* list = malloc((count + 1) * sizeof *list);
  CHECK_OK(rayc_contacts_copy(contacts, 0, count, list));
  add_word(hash, count);
  for (size_t i = 0; i < count; ++i) {
    const rayc_contact* contact = &list[i];
    add_word(hash, contact->kind - 1); /* Rust counts from 0 */
    add_word(hash, contact->colliding);
    add_word(hash, contact->collided);
    add_point(hash, &contact->p1);
    add_point(hash, &contact->p2);
    add_numbers(hash, contact->direction);
    add_number(hash, contact->depth);
    add_number(hash, contact->cos_alpha);
    add_number(hash, contact->area);
  }
  free(list);
}

/* Corners and triangles. */
struct surface {
  size_t vertex_count, triangle_count;
  double* positions;
  uint32_t* triangles;
  uint32_t is_open, collides_with_itself;
};

/* What is hashed. */
struct setting {
  const char* name;
  uint32_t count, weighting;
  struct surface bodies[MOST_BODIES];
  rayc_detection_options detection;
};

static struct surface surface_with(size_t vertex_count, size_t triangle_count) {
  struct surface surface = {.vertex_count = vertex_count, .triangle_count = triangle_count};
  surface.positions = malloc(3 * vertex_count * sizeof *surface.positions);
  surface.triangles = malloc(3 * triangle_count * sizeof *surface.triangles);
  return surface;
}

static struct surface moved(struct surface surface, double x, double y, double z) {
  const double by[3] = {x, y, z};
  for (size_t i = 0; i < 3 * surface.vertex_count; ++i) surface.positions[i] += by[i % 3];
  return surface;
}

/* About x by the angle of the 3-4-5 triangle. */
static struct surface turned(struct surface surface) {
  for (size_t i = 0; i < surface.vertex_count; ++i) {
    double* point = surface.positions + 3 * i;
    const double y = point[1], z = point[2];
    point[1] = 0.8 * y - 0.6 * z;
    point[2] = 0.6 * y + 0.8 * z;
  }
  return surface;
}

/* A point of the unit circle: of a square's border, at equal distances, drawn to the circle. */
static void on_circle(uint32_t place, uint32_t count, double out[2]) {
  const double along = 4.0 * place / count, across = 2 * (along - floor(along)) - 1;
  const double sides[4][2] = {{1, across}, {-across, 1}, {-1, -across}, {across, -1}};
  const double* point = sides[(int)floor(along) % 4];
  const double length = sqrt(point[0] * point[0] + point[1] * point[1]);
  out[0] = point[0] / length;
  out[1] = point[1] / length;
}

static void add_quad(struct surface* surface, size_t quad, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
  const uint32_t corners[6] = {a, b, c, a, c, d};
  memcpy(surface->triangles + 6 * quad, corners, sizeof corners);
}

static struct surface torus(uint32_t around, uint32_t across, double ring, double tube) {
  struct surface surface = surface_with(around * across, 2 * around * across);
  for (uint32_t i = 0; i < around; ++i) {
    for (uint32_t j = 0; j < across; ++j) {
      double ring_point[2], tube_point[2];
      on_circle(i, around, ring_point);
      on_circle(j, across, tube_point);
      const uint32_t place = i * across + j;
      double* point = surface.positions + 3 * place;
      point[0] = (ring + tube * tube_point[0]) * ring_point[0];
      point[1] = (ring + tube * tube_point[0]) * ring_point[1];
      point[2] = tube * tube_point[1];
      const uint32_t next_i = (i + 1) % around * across, next_j = (j + 1) % across;
      add_quad(&surface, place, place, next_i + j, next_i + next_j, i * across + next_j);
    }
  }
  return surface;
}

/* A box by two squares of its eight corners. */
static struct surface block(double x, double y, double z) {
  static const uint32_t faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                       {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  const double half[3] = {x, y, z};
  struct surface surface = surface_with(8, 12);
  for (size_t i = 0; i < 24; ++i) surface.positions[i] = i / 3 >> i % 3 & 1 ? half[i % 3] : -half[i % 3];
  for (size_t face = 0; face < 6; ++face) {
    add_quad(&surface, face, faces[face][0], faces[face][1], faces[face][2], faces[face][3]);
  }
  return surface;
}

/* A square sheet at height 0, seen from above. */
static struct surface sheet(uint32_t cells, double half) {
  const uint32_t side = cells + 1;
  struct surface surface = surface_with(side * side, 2 * cells * cells);
  surface.is_open = 1;
  for (uint32_t place = 0; place < side * side; ++place) {
    double* point = surface.positions + 3 * place;
    point[0] = (2.0 * (place % side) / cells - 1) * half;
    point[1] = (2.0 * (place / side) / cells - 1) * half;
    point[2] = 0;
  }
  for (uint32_t place = 0; place < cells * cells; ++place) {
    const uint32_t a = place / cells * side + place % cells;
    add_quad(&surface, place, a, a + 1, a + 1 + side, a + side);
  }
  return surface;
}

static void add_body(struct setting* setting, struct surface body) { setting->bodies[setting->count++] = body; }

static void make_settings(struct setting settings[5]) {
  memset(settings, 0, 5 * sizeof *settings);
  for (int i = 0; i < 5; ++i) {
    CHECK_OK(rayc_default_detection_options(sizeof settings[i].detection, &settings[i].detection));
    settings[i].weighting = RAYC_WEIGHTING_AREA;
  }
  struct setting* setting = settings;
  setting->name = "deep tori";
  for (int k = 0; k < 3; ++k) add_body(setting, moved(turned(torus(64, 32, 1, 0.4)), 0.3 * k, 0.1 * k, 0.2 * k));

  ++setting;
  setting->name = "paper";
  setting->weighting = RAYC_WEIGHTING_VERTEX;
  CHECK_OK(rayc_paper_detection_options(sizeof setting->detection, &setting->detection));
  add_body(setting, torus(64, 32, 1, 0.4));
  add_body(setting, moved(turned(torus(64, 32, 1, 0.4)), 0.2, 0.1, 0.5));

  ++setting;
  setting->name = "pile";
  for (int k = 0; k < 4; ++k) add_body(setting, block(0.5, 0.4, 0.3));
  add_body(setting, moved(torus(32, 12, 0.1, 0.04), 0.05, 0.02, 0.01));

  ++setting;
  setting->name = "self and others";
  add_body(setting, torus(64, 52, 0.3, 0.4));
  setting->bodies[0].collides_with_itself = 1;
  add_body(setting, moved(block(0.3, 0.3, 0.3), 0.6, 0.1, 0.2));

  ++setting;
  setting->name = "sheet and patches";
  setting->detection.sampling = RAYC_SAMPLING_ACCURACY;
  setting->detection.sampling_value = 0.3;
  add_body(setting, sheet(8, 3));
  add_body(setting, moved(torus(64, 32, 1, 0.4), 0.1, 0.2, 0.25));
  add_body(setting, moved(turned(torus(64, 32, 1, 0.4)), 0.4, 0.3, 0.8));
}

#define REAL float
#define SCALAR RAYC_SCALAR_F32
#define ROUND roundf
#define NAME(name) name##_f32
#include "golden_hash_steps.h"
#undef REAL
#undef SCALAR
#undef ROUND
#undef NAME
#define REAL double
#define SCALAR RAYC_SCALAR_F64
#define ROUND round
#define NAME(name) name##_f64
#include "golden_hash_steps.h"

int main(int argument_count, char** arguments) {
  struct setting settings[5];
  uint64_t all = FNV_OFFSET;
  make_settings(settings);
  for (int i = 0; i < 5; ++i) {
    const uint64_t one = hash_of_f32(&settings[i]), two = hash_of_f64(&settings[i]);
    printf("%-17s f32 %016llx  f64 %016llx\n", settings[i].name, (unsigned long long)one, (unsigned long long)two);
    add_word(&all, one);
    add_word(&all, two);
    for (uint32_t k = 0; k < settings[i].count; ++k) {
      free(settings[i].bodies[k].positions);
      free(settings[i].bodies[k].triangles);
    }
  }
  char found[32], expected[32] = "";
  snprintf(found, sizeof found, "hash=%016llx", (unsigned long long)all);
  printf("%s\n", found);
  FILE* file = argument_count == 2 ? fopen(arguments[1], "r") : NULL;
  CHECK(file != NULL);
  if (file != NULL) {
    CHECK(fscanf(file, "%31s", expected) == 1);
    fclose(file);
  }
  CHECK(strcmp(found, expected) == 0);
  return check_result();
}
