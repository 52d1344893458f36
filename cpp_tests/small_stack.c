/* What calls need of the stack of the thread that makes them: every kind of query, in both precisions and with each
   kind of instructions, in threads that have RAYC_STACK_SIZE and the system's own part. A stack filled with a pattern
   beforehand tells how much is used; one with a guard behind it shows that it is enough. */
#define _DEFAULT_SOURCE
#include <pthread.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "check.h"
#include "shapes.h"

#define PATTERN 0xA5
#define LARGE_STACK ((size_t)8 << 20)

static const double no_shift[3] = {0, 0, 0};

static void one_by_one(void* context, size_t count, rayc_task task, void* data) {
  (void)context;
  for (size_t i = 0; i < count; ++i) task(data, i);
}

static void add(rayc_scene* scene, rayc_mesh* mesh, int touches_itself) {
  uint32_t body = 42;
  CHECK_OK(rayc_scene_add_mesh(scene, mesh, &body));
  CHECK_OK(rayc_scene_set_self_collision(scene, body, (uint32_t)touches_itself));
  CHECK_OK(rayc_mesh_destroy(mesh));
}

/* Queries until what is escaping has turned once, reads everything, saves and restores. */
static void use_scene(uint32_t precision, const rayc_detection_options* detection, rayc_parallel_for parallel_for,
                      int nested, int touches_itself) {
  static double data[2][3 * TORUS_VERTICES];
  rayc_scene_options options;
  rayc_scene* scene = NULL;
  rayc_contacts* contacts = NULL;
  CHECK_OK(rayc_default_scene_options(sizeof options, &options));
  options.precision = precision;
  options.parallel_for = parallel_for;
  CHECK_OK(rayc_scene_create(&options, &scene));
  CHECK_OK(rayc_contacts_create(&contacts));
  CHECK_OK(rayc_scene_set_detection_options(scene, detection));
  add(scene, torus_mesh(precision, no_shift), touches_itself);
  add(scene, torus_mesh(precision, nested ? no_shift : torus_shift), touches_itself);
  torus_shifted(no_shift, data[0]);
  torus_shifted(nested ? no_shift : torus_shift, data[1]);
  if (touches_itself) { /* one side is moved into the other */
    for (int i = 0; i < TORUS_VERTICES; ++i) data[0][3 * i] -= 1.8 * fmin(fmax(2 * data[0][3 * i], 0), 1);
  }
  const rayc_vectors positions[2] = {packed(data[0], TORUS_VERTICES), packed(data[1], TORUS_VERTICES)};
  for (int step = 0; step < (nested ? 30 : 3); ++step) {
    CHECK_OK(rayc_scene_set_positions(scene, 0, &positions[0]));
    CHECK_OK(rayc_scene_query(scene, contacts));
  }
  size_t length = 0;
  rayc_statistics statistics;
  CHECK_OK(rayc_contacts_statistics(contacts, sizeof statistics, &statistics));
  CHECK(statistics.contacts > 20);
  CHECK((statistics.self_contacts > 0) == touches_itself);
  CHECK((statistics.escaping_pairs > 0) == nested);
  rayc_response_options response;
  CHECK_OK(rayc_default_response_options(sizeof response, &response));
  static double forces[2][3 * TORUS_VERTICES];
  double joules = 0;
  const rayc_vectors_mut out[2] = {packed_mut(forces[0], TORUS_VERTICES), packed_mut(forces[1], TORUS_VERTICES)};
  CHECK_OK(rayc_contacts_add_forces(contacts, &response, 2, positions, positions, out));
  CHECK_OK(rayc_contacts_add_differential(contacts, &response, 1, 1, 2, positions, out));
  CHECK_OK(rayc_contacts_energy(contacts, &response, 2, positions, &joules));
  uint8_t saved[4096];
  CHECK_OK(rayc_scene_saved_length(scene, &length));
  CHECK(length <= sizeof saved);
  CHECK_OK(rayc_scene_save_pair_memories(scene, length, saved));
  CHECK_OK(rayc_scene_restore_pair_memories(scene, length, saved));
  /* A failure is told on the same stack. */
  CHECK_STATUS(rayc_scene_restore_pair_memories(scene, length - 1, saved), RAYC_STATUS_SAVED_STATE_BROKEN, "bytes");
  CHECK_OK(rayc_contacts_destroy(contacts));
  CHECK_OK(rayc_scene_destroy(scene));
}

static void use_pair(uint32_t precision, const rayc_detection_options* detection) {
  rayc_mesh *a = torus_mesh(precision, no_shift), *b = torus_mesh(precision, torus_shift);
  rayc_octree *octree_a = NULL, *octree_b = NULL;
  rayc_contacts* contacts = NULL;
  rayc_hit hit;
  const rayc_ray ray = {{0, 0.3, 0.1}, {1, 0.1, 0.05}, 9};
  CHECK_OK(rayc_octree_create(NULL, a, &octree_a));
  CHECK_OK(rayc_octree_create(NULL, b, &octree_b));
  CHECK_OK(rayc_contacts_create(&contacts));
  CHECK_OK(rayc_query_pair(detection, a, octree_a, b, octree_b, contacts));
  CHECK_OK(rayc_query_self(detection, a, octree_a, contacts));
  CHECK_OK(rayc_octree_update(octree_a, a));
  CHECK_OK(rayc_octree_trace_ray(octree_a, a, &ray, &hit));
  CHECK_OK(rayc_contacts_destroy(contacts));
  CHECK_OK(rayc_octree_destroy(octree_a));
  CHECK_OK(rayc_octree_destroy(octree_b));
  CHECK_OK(rayc_mesh_destroy(a));
  CHECK_OK(rayc_mesh_destroy(b));
}

static void* everything(void* context) {
  (void)context;
  for (uint32_t precision = RAYC_SCALAR_F32; precision <= RAYC_SCALAR_F64; ++precision) {
    rayc_detection_options all[5];
    for (int i = 0; i < 5; ++i) CHECK_OK(rayc_default_detection_options(sizeof all[i], &all[i]));
    all[1].sampling = RAYC_SAMPLING_VERTICES;
    all[2].sampling = RAYC_SAMPLING_SPACING;
    all[2].sampling_value = 0.2;
    all[3].sampling_value = 0.1; /* of RAYC_SAMPLING_ACCURACY */
    all[4].past_folds = 1;
    for (int i = 0; i < 5; ++i) {
      use_pair(precision, &all[i]);
      for (int host = 0; host < 2; ++host) {
        use_scene(precision, &all[i], host ? one_by_one : NULL, 0, 0);
        use_scene(precision, &all[i], host ? one_by_one : NULL, 0, 1);
      }
    }
    use_scene(precision, &all[0], NULL, 1, 0);
  }
  return NULL;
}

static void* nothing(void* context) { return context; }

/* How much of its stack a thread has used that does this. */
static size_t used_by(void* (*work)(void*)) {
  unsigned char* const stack = mmap(NULL, LARGE_STACK, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  CHECK(stack != MAP_FAILED);
  memset(stack, PATTERN, LARGE_STACK);
  pthread_attr_t attributes;
  pthread_t thread;
  CHECK(pthread_attr_init(&attributes) == 0);
  CHECK(pthread_attr_setstack(&attributes, stack, LARGE_STACK) == 0);
  CHECK(pthread_create(&thread, &attributes, work, NULL) == 0);
  CHECK(pthread_join(thread, NULL) == 0);
  size_t unused = 0;
  while (unused < LARGE_STACK && stack[unused] == PATTERN) ++unused;
  CHECK(munmap(stack, LARGE_STACK) == 0);
  return LARGE_STACK - unused;
}

static void run_in_small_stack(size_t size) {
  pthread_attr_t attributes;
  pthread_t thread;
  CHECK(pthread_attr_init(&attributes) == 0);
  CHECK(pthread_attr_setstacksize(&attributes, size) == 0);
  CHECK(pthread_create(&thread, &attributes, everything, NULL) == 0);
  CHECK(pthread_join(thread, NULL) == 0);
}

/* The library looks once which instructions there are, so each kind has a process of its own. */
static void try_with(const char* instructions) {
  const pid_t child = fork();
  if (child == 0) {
    setenv("RAYCONTACT_SIMD", instructions, 1);
    /* What the system keeps there itself: the thread's own variables above all. */
    const size_t systems = used_by(nothing), used = used_by(everything) - systems;
    printf("%s: %zu bytes of stack\n", instructions, used);
    CHECK(used <= RAYC_STACK_SIZE);
    run_in_small_stack(RAYC_STACK_SIZE + (systems + 4095) / 4096 * 4096);
    fflush(stdout);
    _exit(check_result());
  }
  int status = -1;
  CHECK(child > 0 && waitpid(child, &status, 0) == child);
  if (status != 0) fprintf(stderr, "%s: the process ended with status %d\n", instructions, status);
  CHECK(status == 0);
}

int main(void) {
  const char* const instructions[] = {"baseline", "avx2", "avx512"};
  for (int i = 0; i < 3; ++i) try_with(instructions[i]);
  return check_result();
}
