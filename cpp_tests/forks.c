/* A process that forks has no threads in its child: a scene with a pool works there all the same, and gives the same
   contacts to the bit. What hangs is ended by the alarm, and is a failure. */
#define _POSIX_C_SOURCE 200809L
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include "check.h"
#include "shapes.h"

static const double no_shift[3] = {0, 0, 0};

typedef struct found {
  rayc_contact* contacts;
  size_t count;
} found;

static rayc_scene* tori(uint32_t precision, uint32_t threads) {
  rayc_scene_options options;
  rayc_scene* scene = NULL;
  CHECK_OK(rayc_default_scene_options(sizeof options, &options));
  options.precision = precision;
  options.threads = threads;
  CHECK_OK(rayc_scene_create(&options, &scene));
  for (int k = 0; k < 2; ++k) {
    uint32_t body = 42;
    rayc_mesh* mesh = torus_mesh(precision, k == 0 ? no_shift : torus_shift);
    CHECK_OK(rayc_scene_add_mesh(scene, mesh, &body));
    CHECK_OK(rayc_mesh_destroy(mesh));
  }
  return scene;
}

static found query(rayc_scene* scene) {
  rayc_contacts* contacts = NULL;
  found all = {NULL, 0};
  CHECK_OK(rayc_contacts_create(&contacts));
  CHECK_OK(rayc_scene_query(scene, contacts));
  CHECK_OK(rayc_contacts_count(contacts, &all.count));
  all.contacts = malloc((all.count + 1) * sizeof *all.contacts);
  CHECK_OK(rayc_contacts_copy(contacts, 0, all.count, all.contacts));
  CHECK_OK(rayc_contacts_destroy(contacts));
  return all;
}

/* Queries the scene, and says whether it finds the same. */
static void check_same(rayc_scene* scene, const found* expected) {
  const found again = query(scene);
  CHECK(again.count == expected->count && again.count > 100);
  CHECK(memcmp(again.contacts, expected->contacts, again.count * sizeof *again.contacts) == 0);
  free(again.contacts);
}

/* Waits for a child that does this with the scene; 0 where all went well. */
static int status_of_child(void (*work)(rayc_scene*, const found*), rayc_scene* scene, const found* expected) {
  const int failures = check_failures;
  const pid_t child = fork();
  if (child == 0) {
    alarm(20);
    work(scene, expected);
    fflush(stderr);
    _exit(check_failures == failures ? 0 : 1);
  }
  int status = -1;
  CHECK(child > 0 && waitpid(child, &status, 0) == child);
  if (WIFSIGNALED(status)) fprintf(stderr, "the child was ended by signal %d\n", WTERMSIG(status));
  return status;
}

static void query_and_destroy(rayc_scene* scene, const found* expected) {
  for (int i = 0; i < 3; ++i) check_same(scene, expected);
  CHECK_OK(rayc_scene_destroy(scene));
}

static void destroy_alone(rayc_scene* scene, const found* expected) {
  (void)expected;
  CHECK_OK(rayc_scene_destroy(scene));
}

/* A child's child has to begin anew once more, whether or not its parent did. */
static void fork_again(rayc_scene* scene, const found* expected) {
  CHECK(status_of_child(query_and_destroy, scene, expected) == 0);
  check_same(scene, expected);
  CHECK(status_of_child(query_and_destroy, scene, expected) == 0);
  check_same(scene, expected);
  CHECK_OK(rayc_scene_destroy(scene));
}

int main(void) {
  alarm(100);
  const uint32_t precisions[] = {RAYC_SCALAR_F64, RAYC_SCALAR_F32};
  for (int i = 0; i < 2; ++i) {
    rayc_scene* alone = tori(precisions[i], 1);
    const found expected = query(alone);
    CHECK(status_of_child(query_and_destroy, alone, &expected) == 0);
    CHECK_OK(rayc_scene_destroy(alone));
    for (uint32_t threads = 0; threads <= 3; ++threads) {
      rayc_scene* scene = tori(precisions[i], threads);
      /* Before the pool has worked for the first time, and after. */
      CHECK(status_of_child(query_and_destroy, scene, &expected) == 0);
      check_same(scene, &expected);
      CHECK(status_of_child(query_and_destroy, scene, &expected) == 0);
      CHECK(status_of_child(destroy_alone, scene, &expected) == 0);
      CHECK(status_of_child(fork_again, scene, &expected) == 0);
      /* The parent has noticed nothing. */
      check_same(scene, &expected);
      CHECK_OK(rayc_scene_destroy(scene));
      if (check_failures != 0) return check_result();
    }
    free(expected.contacts);
  }
  return check_result();
}
