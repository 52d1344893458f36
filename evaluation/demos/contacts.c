/* Where do two closed surfaces overlap, and what would part them? Plain C, linking only raycontact. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "raycontact.h"

/* 1 is left to programs whose answer may be no. */
enum { EXIT_OK = 0, EXIT_TROUBLE = 2 };

typedef struct arguments {
  const char* paths[2];
  double shift[3];
  double spacing;
  int has_spacing;
  int csv;
} arguments;

/* What the run owns; zero at the start, freed in one place. */
typedef struct run {
  rayc_mesh* meshes[2];
  rayc_octree* octrees[2];
  rayc_contacts* contacts;
  rayc_response_options response;
  size_t count;
  rayc_contact* list;
  double* coefficients;
} run;

typedef struct summary {
  size_t count[2]; /* rays of the first body, of the second */
  double deepest[2];
  double force[3], torque[3]; /* on the first body */
} summary;

static void print_usage(FILE* out) {
  fputs(
      "usage: contacts [--shift x y z] [--spacing s] [--csv] first.obj second.obj\n"
      "\n"
      "Finds the contacts between two closed, outward-oriented surfaces in Wavefront files, and the penalty\n"
      "force and torque on the first (stiffness 1 N/m^3, lengths in m, torque about the origin).\n"
      "\n"
      "  --shift x y z   move the second surface before looking\n"
      "  --spacing s     rays start about s apart on the surfaces; 0: from each vertex; without the option: as the\n"
      "                  size of the overlap asks\n"
      "  --csv           print one row per contact instead of the table\n"
      "  --help          print this\n"
      "\n"
      "Exit status: 0 done, 2 wrong usage or unusable input.\n",
      out);
}

static int usage_error(const char* what, const char* argument) {
  fprintf(stderr, "contacts: %s%s\n\n", what, argument);
  print_usage(stderr);
  return EXIT_TROUBLE;
}

static int parse_number(const char* text, double* number) {
  char* end = NULL;
  *number = strtod(text, &end);
  return end != text && *end == '\0' && isfinite(*number);
}

/* EXIT_OK when the run can start. */
static int parse_arguments(int argc, char** argv, arguments* out) {
  int path_count = 0;
  for (int i = 1; i < argc; ++i) {
    if (strcmp(argv[i], "--csv") == 0) {
      out->csv = 1;
    } else if (strcmp(argv[i], "--shift") == 0) {
      for (int axis = 0; axis < 3; ++axis) {
        if (++i >= argc) {
          return usage_error("--shift needs three numbers", "");
        }
        if (!parse_number(argv[i], &out->shift[axis])) {
          return usage_error("--shift needs three finite numbers, not ", argv[i]);
        }
      }
    } else if (strcmp(argv[i], "--spacing") == 0) {
      if (++i >= argc || !parse_number(argv[i], &out->spacing) || out->spacing < 0) {
        return usage_error("--spacing needs a finite number, 0 or more", "");
      }
      out->has_spacing = 1;
    } else if (argv[i][0] == '-') {
      return usage_error("unknown option ", argv[i]);
    } else if (path_count == 2) {
      return usage_error("two files are enough; there is also ", argv[i]);
    } else {
      out->paths[path_count++] = argv[i];
    }
  }
  return path_count == 2 ? EXIT_OK : usage_error("give two .obj files", "");
}

/* Prints what the library said; 1 when the call succeeded. `what` is NULL where the message says it itself. */
static int succeeded(rayc_status status, const char* what) {
  if (status == RAYC_STATUS_OK) {
    return 1;
  }
  fprintf(stderr, "contacts: %s%s%s (%s)\n", what != NULL ? what : "", what != NULL ? ": " : "",
          rayc_last_error_message(), rayc_status_name((uint32_t)status));
  return 0;
}

static void* allocate(size_t count, size_t size) {
  void* memory = calloc(count != 0 ? count : 1, size);
  if (memory == NULL) {
    fprintf(stderr, "contacts: out of memory for %zu items\n", count);
    exit(EXIT_TROUBLE);
  }
  return memory;
}

static rayc_vectors_mut vectors_mut(double* data, size_t count) {
  const rayc_vectors_mut vectors = {data, count, 0, RAYC_SCALAR_F64};
  return vectors;
}

/* The mesh's positions as a new array. */
static double* copy_positions(const rayc_mesh* mesh, size_t* count) {
  if (!succeeded(rayc_mesh_vertex_count(mesh, count), "counting vertices")) {
    exit(EXIT_TROUBLE);
  }
  double* positions = allocate(3 * *count, sizeof *positions);
  const rayc_vectors_mut out = vectors_mut(positions, *count);
  if (!succeeded(rayc_mesh_copy_positions(mesh, &out), "reading positions")) {
    exit(EXIT_TROUBLE);
  }
  return positions;
}

static int move(rayc_mesh* mesh, const double shift[3]) {
  size_t count = 0;
  double* positions = copy_positions(mesh, &count);
  for (size_t i = 0; i < 3 * count; ++i) {
    positions[i] += shift[i % 3];
  }
  const rayc_vectors vectors = {positions, count, 0, RAYC_SCALAR_F64};
  const int moved = succeeded(rayc_mesh_set_positions(mesh, &vectors), "moving the second surface");
  free(positions);
  return moved;
}

static int detect(const arguments* arguments, run* run) {
  for (int i = 0; i < 2; ++i) {
    const char* path = arguments->paths[i];
    if (!succeeded(rayc_mesh_create_from_obj(NULL, path, &run->meshes[i]), NULL)) {
      return 0;
    }
    if (i == 1 && !move(run->meshes[1], arguments->shift)) {
      return 0;
    }
    if (!succeeded(rayc_octree_create(NULL, run->meshes[i], &run->octrees[i]), path)) {
      return 0;
    }
  }
  rayc_detection_options detection;
  if (!succeeded(rayc_default_detection_options(sizeof detection, &detection), "default options")) {
    return 0;
  }
  if (arguments->has_spacing) {
    detection.sampling = arguments->spacing > 0 ? RAYC_SAMPLING_SPACING : RAYC_SAMPLING_VERTICES;
    detection.sampling_value = arguments->spacing;
  }
  return succeeded(rayc_contacts_create(&run->contacts), "making the list") &&
         succeeded(rayc_query_pair(&detection, run->meshes[0], run->octrees[0], run->meshes[1], run->octrees[1],
                                   run->contacts),
                   "finding contacts") &&
         succeeded(rayc_default_response_options(sizeof run->response, &run->response), "default options") &&
         succeeded(rayc_contacts_count(run->contacts, &run->count), "counting contacts");
}

static int read_contacts(run* run) {
  run->list = allocate(run->count, sizeof *run->list);
  run->coefficients = allocate(run->count, sizeof *run->coefficients);
  return succeeded(rayc_contacts_copy(run->contacts, 0, run->count, run->list), "reading contacts") &&
         succeeded(rayc_contacts_copy_coefficients(run->contacts, &run->response, 0, run->count, run->coefficients),
                   "reading coefficients");
}

/* Sums the forces on the first body's vertices. */
static int sum_forces(const run* run, summary* out) {
  size_t counts[2];
  double *positions[2], *forces[2];
  rayc_vectors_mut views[2];
  for (int i = 0; i < 2; ++i) {
    positions[i] = copy_positions(run->meshes[i], &counts[i]);
    forces[i] = allocate(3 * counts[i], sizeof *forces[i]);
    views[i] = vectors_mut(forces[i], counts[i]);
  }
  const int done =
      succeeded(rayc_contacts_add_forces(run->contacts, &run->response, 2, NULL, NULL, views), "adding forces");
  for (size_t vertex = 0; done && vertex < counts[0]; ++vertex) {
    const double *x = &positions[0][3 * vertex], *f = &forces[0][3 * vertex];
    for (int axis = 0; axis < 3; ++axis) {
      const int next = (axis + 1) % 3, last = (axis + 2) % 3;
      out->force[axis] += f[axis];
      out->torque[axis] += x[next] * f[last] - x[last] * f[next];
    }
  }
  for (int i = 0; i < 2; ++i) {
    free(positions[i]);
    free(forces[i]);
  }
  return done;
}

static void summarise_contacts(const run* run, summary* out) {
  for (size_t i = 0; i < run->count; ++i) {
    const rayc_contact* contact = &run->list[i];
    ++out->count[contact->colliding];
    out->deepest[contact->colliding] = fmax(out->deepest[contact->colliding], contact->depth);
  }
}

static int print_table(const arguments* arguments, const run* run) {
  summary summary = {{0, 0}, {0, 0}, {0, 0, 0}, {0, 0, 0}};
  rayc_statistics statistics;
  summarise_contacts(run, &summary);
  if (!sum_forces(run, &summary) ||
      !succeeded(rayc_contacts_statistics(run->contacts, sizeof statistics, &statistics), "reading statistics")) {
    return 0;
  }

  printf("first   %s\nsecond  %s\n\n", arguments->paths[0], arguments->paths[1]);
  printf("%-24s %14s %14s\n", "contacts", "count", "deepest (m)");
  printf("%-24s %14zu %14.6g\n", "first into second", summary.count[0], summary.deepest[0]);
  printf("%-24s %14zu %14.6g\n", "second into first", summary.count[1], summary.deepest[1]);
  printf("%-24s %14zu %14.6g\n\n", "both", run->count, fmax(summary.deepest[0], summary.deepest[1]));

  printf("%-24s %14s %14s %14s\n", "on the first body", "x", "y", "z");
  printf("%-24s %14.6g %14.6g %14.6g\n", "net force (N)", summary.force[0], summary.force[1], summary.force[2]);
  printf("%-24s %14.6g %14.6g %14.6g\n\n", "net torque (N m)", summary.torque[0], summary.torque[1], summary.torque[2]);

  printf("%-24s %14s\n", "rays", "count");
  printf("%-24s %14llu\n", "traced", (unsigned long long)statistics.rays);
  printf("%-24s %14llu\n", "made a contact", (unsigned long long)statistics.contacts);
  printf("%-24s %14llu\n", "hit nothing", (unsigned long long)statistics.misses);
  printf("%-24s %14llu\n", "entered from outside", (unsigned long long)statistics.entry_hits);
  printf("%-24s %14llu\n", "own surface was nearer", (unsigned long long)statistics.own_surface_hits);
  return 1;
}

static void print_csv(const run* run) {
  puts(
      "colliding,collided,p1_triangle,p1_vertex,p1_x,p1_y,p1_z,p2_triangle,p2_x,p2_y,p2_z,"
      "direction_x,direction_y,direction_z,depth,cos_alpha,area,coefficient");
  for (size_t i = 0; i < run->count; ++i) {
    const rayc_contact* c = &run->list[i];
    const double *p1 = c->p1.position, *p2 = c->p2.position, *d = c->direction;
    printf("%u,%u,%u,%u,%.17g,%.17g,%.17g,", c->colliding, c->collided, c->p1.triangle, c->p1.vertices[0], p1[0], p1[1],
           p1[2]);
    printf("%u,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,", c->p2.triangle, p2[0], p2[1], p2[2], d[0], d[1], d[2]);
    printf("%.17g,%.17g,%.17g,%.17g\n", c->depth, c->cos_alpha, c->area, run->coefficients[i]);
  }
}

static int report(const arguments* arguments, const run* run) {
  if (arguments->csv) {
    print_csv(run);
  } else if (!print_table(arguments, run)) {
    return 0;
  }
  if (fflush(stdout) != 0 || ferror(stdout)) {
    perror("contacts: cannot write the answer");
    return 0;
  }
  return 1;
}

static void free_run(run* run) {
  free(run->list);
  free(run->coefficients);
  rayc_contacts_destroy(run->contacts);
  for (int i = 0; i < 2; ++i) {
    rayc_octree_destroy(run->octrees[i]);
    rayc_mesh_destroy(run->meshes[i]);
  }
}

int main(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0) {
      print_usage(stdout);
      return EXIT_OK;
    }
  }
  arguments arguments = {{NULL, NULL}, {0, 0, 0}, 0, 0, 0};
  const int usage = parse_arguments(argc, argv, &arguments);
  if (usage != EXIT_OK) {
    return usage;
  }

  run run;
  memset(&run, 0, sizeof run);
  const int done = detect(&arguments, &run) && read_contacts(&run) && report(&arguments, &run);
  free_run(&run);
  return done ? EXIT_OK : EXIT_TROUBLE;
}
