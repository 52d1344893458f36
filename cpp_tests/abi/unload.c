/* A host that loads the library as a plugin may unload it: rounds of load, detection on several threads, failure,
   unload leave no thread, no mapping and no open file behind. */
#include <dirent.h>
#include <dlfcn.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "raycontact.h"

enum { ROUNDS_WITH_THREADS = 100, MAPPINGS_OF_MALLOC = 50 };

static const char* path;

static void fail(const char* what, const char* why) {
  fprintf(stderr, "%s: %s\n", what, why);
  exit(1);
}

/* ISO C has no conversion from an object pointer to a function pointer. */
static void find(void* library, const char* name, void* function) {
  void* symbol = dlsym(library, name);
  if (symbol == NULL) fail(name, dlerror());
  memcpy(function, &symbol, sizeof symbol);
}

static void detect(void* library, uint32_t threads) {
  static const double positions[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  static const uint32_t triangles[] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  double moved[12];
  for (int i = 0; i < 12; ++i) moved[i] = positions[i] + 0.2;

  rayc_status (*default_options)(size_t, rayc_scene_options*);
  rayc_status (*scene_create)(const rayc_scene_options*, rayc_scene**);
  rayc_status (*scene_add_mesh)(rayc_scene*, const rayc_mesh*, uint32_t*);
  rayc_status (*scene_query)(rayc_scene*, rayc_contacts*);
  rayc_status (*scene_destroy)(rayc_scene*);
  rayc_status (*mesh_create)(const rayc_mesh_options*, const rayc_vectors*, const uint32_t*, size_t, rayc_mesh**);
  rayc_status (*mesh_destroy)(rayc_mesh*);
  rayc_status (*contacts_create)(rayc_contacts**);
  rayc_status (*contacts_count)(const rayc_contacts*, size_t*);
  rayc_status (*contacts_destroy)(rayc_contacts*);
  find(library, "rayc_default_scene_options", &default_options);
  find(library, "rayc_scene_create", &scene_create);
  find(library, "rayc_scene_add_mesh", &scene_add_mesh);
  find(library, "rayc_scene_query", &scene_query);
  find(library, "rayc_scene_destroy", &scene_destroy);
  find(library, "rayc_mesh_create", &mesh_create);
  find(library, "rayc_mesh_destroy", &mesh_destroy);
  find(library, "rayc_contacts_create", &contacts_create);
  find(library, "rayc_contacts_count", &contacts_count);
  find(library, "rayc_contacts_destroy", &contacts_destroy);

  rayc_scene_options options;
  rayc_scene* scene = NULL;
  rayc_contacts* contacts = NULL;
  size_t count = 0;
  int failed = default_options(sizeof options, &options) != RAYC_STATUS_OK;
  options.threads = threads;
  failed = failed || scene_create(&options, &scene) != RAYC_STATUS_OK || contacts_create(&contacts) != RAYC_STATUS_OK;
  for (int body = 0; body < 2 && !failed; ++body) {
    const rayc_vectors view = {body == 0 ? positions : moved, 4, 0, RAYC_SCALAR_F64};
    rayc_mesh* mesh = NULL;
    uint32_t number = 0;
    failed = mesh_create(NULL, &view, triangles, 4, &mesh) != RAYC_STATUS_OK ||
             scene_add_mesh(scene, mesh, &number) != RAYC_STATUS_OK || mesh_destroy(mesh) != RAYC_STATUS_OK;
  }
  failed = failed || scene_query(scene, contacts) != RAYC_STATUS_OK;
  failed = failed || contacts_count(contacts, &count) != RAYC_STATUS_OK || count == 0;
  /* A failure leaves a message in memory of this thread. */
  failed = failed || scene_create(&options, NULL) != RAYC_STATUS_NULL_POINTER;
  failed = failed || contacts_destroy(contacts) != RAYC_STATUS_OK || scene_destroy(scene) != RAYC_STATUS_OK;
  if (failed) fail("detection", "a call failed");
}

/* On a thread of its own: what the library keeps for a thread goes when the thread ends, and only then can it be
   unloaded. */
static void* round_of_thread(void* threads) {
  void* library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
  if (library == NULL) fail("dlopen", dlerror());
  detect(library, *(const uint32_t*)threads);
  return library;
}

static void load_and_unload(uint32_t threads) {
  pthread_t thread;
  void* library = NULL;
  if (pthread_create(&thread, NULL, round_of_thread, &threads) != 0 || pthread_join(thread, &library) != 0) {
    fail("pthread", "no thread");
  }
  if (dlclose(library) != 0) fail("dlclose", dlerror());
  if (dlopen(path, RTLD_NOW | RTLD_NOLOAD) != NULL) fail("dlclose", "the library is still there");
}

static size_t entries(const char* folder) {
  size_t count = 0;
  DIR* entries = opendir(folder);
  if (entries == NULL) fail(folder, "cannot be read");
  while (readdir(entries) != NULL) ++count;
  closedir(entries);
  return count;
}

static size_t mappings(void) {
  size_t count = 0;
  FILE* maps = fopen("/proc/self/maps", "r");
  if (maps == NULL) fail("/proc/self/maps", "cannot be read");
  for (int c = fgetc(maps); c != EOF; c = fgetc(maps)) count += c == '\n';
  fclose(maps);
  return count;
}

int main(int argc, char** argv) {
  if (argc != 3) fail("usage", "unload <shared library> <rounds>");
  path = argv[1];
  const int rounds = atoi(argv[2]);
  for (int i = 0; i < 20; ++i) load_and_unload(2); /* the system's own caches fill */
  const size_t threads = entries("/proc/self/task"), files = entries("/proc/self/fd"), maps = mappings();
  for (int i = 0; i < rounds; ++i) load_and_unload(i < ROUNDS_WITH_THREADS ? 2 : 1);
  /* On the thread that unloads it: the library stays until that thread ends, which is as safe. */
  for (int i = 0; i < ROUNDS_WITH_THREADS; ++i) {
    const uint32_t own = 1;
    if (dlclose(round_of_thread((void*)&own)) != 0) fail("dlclose", dlerror());
  }
  printf("%d rounds: threads %zu -> %zu, open files %zu -> %zu, mappings %zu -> %zu\n", rounds, threads,
         entries("/proc/self/task"), files, entries("/proc/self/fd"), maps, mappings());
  if (entries("/proc/self/task") != threads || entries("/proc/self/fd") != files ||
      mappings() > maps + MAPPINGS_OF_MALLOC) {
    fail("unload", "something is left behind");
  }
  return 0;
}
