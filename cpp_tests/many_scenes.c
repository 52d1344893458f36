/* Many scenes in one call: the same bits as one by one, whoever's threads work, and an error of one spares the others.
 */
#include "check.h"
#include "shapes.h"

#define SCENES 12
#define NODES OCTAHEDRON_VERTICES
#define EACH (3 * 2 * NODES)
#define STEPS 3

static const rayc_material material = {sizeof material, 1e4, 0.01, 0.3, 1e-5, 0};
static double x[SCENES][EACH], v[SCENES][EACH], stopped[SCENES][EACH];
static size_t host_calls = 0, host_tasks = 0;

typedef struct {
  rayc_scene* scenes[SCENES];
  rayc_contact_system* systems[SCENES];
  rayc_contacts* contacts[SCENES];
} batch;

static void one_by_one(void* context, size_t count, rayc_task task, void* data) {
  CHECK(context == &host_calls);
  ++host_calls;
  for (size_t index = 0; index < count; ++index, ++host_tasks) task(data, index);
}

/* Two octahedra in each scene. */
static batch make(uint32_t threads, rayc_parallel_for host) {
  batch all;
  double masses[2 * NODES];
  for (int k = 0; k < 2 * NODES; ++k) masses[k] = 1;
  rayc_scene_options options;
  CHECK_OK(rayc_default_scene_options(sizeof options, &options));
  options.threads = threads;
  options.parallel_for = host;
  options.parallel_context = &host_calls;
  for (int k = 0; k < SCENES; ++k) {
    CHECK_OK(rayc_scene_create(&options, &all.scenes[k]));
    CHECK_OK(rayc_contact_system_create(NULL, &all.systems[k]));
    CHECK_OK(rayc_contacts_create(&all.contacts[k]));
    CHECK_OK(rayc_contact_system_set_node_masses(all.systems[k], 2 * NODES, masses));
    for (uint32_t body = 0; body < 2; ++body) {
      uint32_t number = 42;
      rayc_mesh* mesh = octahedron_mesh(octahedron_shift);
      CHECK_OK(rayc_scene_add_mesh(all.scenes[k], mesh, &number));
      CHECK_OK(rayc_mesh_destroy(mesh));
      CHECK_OK(rayc_contact_system_add_deformable(all.systems[k], all.scenes[k], body, body * NODES, NODES, NULL, 0,
                                                  NULL, NULL, &material));
    }
  }
  return all;
}

static void destroy(batch* all) {
  for (int k = 0; k < SCENES; ++k) {
    CHECK_OK(rayc_contact_system_destroy(all->systems[k]));
    CHECK_OK(rayc_scene_destroy(all->scenes[k]));
    CHECK_OK(rayc_contacts_destroy(all->contacts[k]));
  }
}

static void move(int step) {
  for (int k = 0; k < SCENES; ++k) {
    double shift[3];
    for (int axis = 0; axis < 3; ++axis) shift[axis] = octahedron_shift[axis] * (1 - 0.02 * k) + 0.001 * step;
    octahedron_shifted((const double[3]){0, 0, 0}, x[k]);
    octahedron_shifted(shift, x[k] + 3 * NODES);
    for (int i = 0; i < EACH; ++i) v[k][i] = 0.1 * sin(k + i + step), stopped[k][i] = 0;
  }
}

static void check_alike(const batch* one, const batch* other) {
  size_t sum = 0;
  for (int k = 0; k < SCENES; ++k) {
    size_t count = 0, other_count = 0;
    double forces[EACH] = {0}, other_forces[EACH] = {0};
    CHECK_OK(rayc_contact_system_add_forces(one->systems[k], EACH, stopped[k], forces));
    CHECK_OK(rayc_contact_system_add_forces(other->systems[k], EACH, stopped[k], other_forces));
    CHECK(memcmp(forces, other_forces, sizeof forces) == 0);
    CHECK_OK(rayc_contacts_count(one->contacts[k], &count));
    CHECK_OK(rayc_contacts_count(other->contacts[k], &other_count));
    static rayc_contact found[2][1000];
    CHECK(count == other_count && count < 1000);
    CHECK_OK(rayc_contacts_copy(one->contacts[k], 0, count, found[0]));
    CHECK_OK(rayc_contacts_copy(other->contacts[k], 0, count, found[1]));
    CHECK(memcmp(found[0], found[1], count * sizeof found[0][0]) == 0);
    sum += count;
  }
  CHECK(sum > SCENES);
}

static void a_call_for_all_does_what_one_for_each_does(uint32_t threads, rayc_parallel_for host) {
  batch one = make(1, NULL), other = make(threads, host);
  const size_t calls = host_calls, tasks = host_tasks;
  for (int step = 0; step < STEPS; ++step) {
    move(step);
    uint32_t statuses[SCENES], is_more[SCENES], expected[SCENES];
    for (int k = 0; k < SCENES; ++k) {
      CHECK_OK(rayc_contact_system_begin(one.systems[k], one.scenes[k], 0.01, EACH, x[k], v[k], v[k]));
      CHECK_OK(rayc_contact_system_detect_again(one.systems[k], one.scenes[k], EACH, stopped[k], &expected[k]));
      CHECK_OK(rayc_scene_query(one.scenes[k], one.contacts[k]));
    }
    CHECK_OK(rayc_contact_systems_begin(SCENES, other.systems, other.scenes, 0.01, EACH, x[0], v[0], v[0], statuses));
    for (int k = 0; k < SCENES; ++k) CHECK(statuses[k] == RAYC_STATUS_OK);
    CHECK_OK(
        rayc_contact_systems_detect_again(SCENES, other.systems, other.scenes, EACH, stopped[0], is_more, statuses));
    for (int k = 0; k < SCENES; ++k) CHECK(is_more[k] == expected[k] && statuses[k] == RAYC_STATUS_OK);
    CHECK_OK(rayc_scenes_query(SCENES, other.scenes, other.contacts, statuses));
    for (int k = 0; k < SCENES; ++k) CHECK(statuses[k] == RAYC_STATUS_OK);
    check_alike(&one, &other);
    for (int k = 0; k < SCENES; ++k) {
      CHECK_OK(rayc_contact_system_finish(one.systems[k], EACH, stopped[k]));
      CHECK_OK(rayc_contact_system_finish(other.systems[k], EACH, stopped[k]));
    }
  }
  /* Three calls in each step, and none from within. */
  CHECK(host_calls - calls == (host == NULL ? 0 : 3 * STEPS) && host_tasks - tasks == SCENES * (host_calls - calls));
  destroy(&one);
  destroy(&other);
}

static void an_error_spares_the_others(uint32_t threads) {
  batch one = make(1, NULL), other = make(threads, NULL);
  const uint32_t untouched = 424242;
  uint32_t statuses[SCENES], is_more[SCENES];
  move(0);
  for (int k = 0; k < SCENES; ++k) {
    CHECK_OK(rayc_contact_system_begin(one.systems[k], one.scenes[k], 0.01, EACH, x[k], v[k], v[k]));
    CHECK_OK(rayc_scene_query(one.scenes[k], one.contacts[k]));
    statuses[k] = is_more[k] = untouched;
  }
#define BEGIN(systems, scenes, count) \
  rayc_contact_systems_begin(SCENES, systems, scenes, 0.01, count, x[0], v[0], v[0], statuses)
  rayc_contact_system* systems[SCENES];
  memcpy(systems, other.systems, sizeof systems);
  systems[7] = NULL;
  const double sound = x[3][5];
  x[3][5] = NAN;
  CHECK_STATUS(BEGIN(systems, other.scenes, EACH), RAYC_STATUS_NOT_FINITE, "scene 3: positions[5]");
  for (int k = 0; k < SCENES; ++k)
    CHECK(statuses[k] == (k == 3 ? RAYC_STATUS_NOT_FINITE : k == 7 ? RAYC_STATUS_NULL_POINTER : RAYC_STATUS_OK));
  x[3][5] = sound;
  for (int k = 3; k < SCENES; k += 4)
    if (k != 11) CHECK_OK(rayc_contact_system_begin(other.systems[k], other.scenes[k], 0.01, EACH, x[k], v[k], v[k]));
  CHECK_STATUS(BEGIN(other.systems, other.scenes, EACH), RAYC_STATUS_OUT_OF_ORDER, "scene 0: a step is under way");
  for (int k = 0; k < SCENES; ++k) CHECK(statuses[k] == RAYC_STATUS_OUT_OF_ORDER);
  v[5][1] = INFINITY;
  CHECK_STATUS(rayc_contact_systems_detect_again(SCENES, other.systems, other.scenes, EACH, v[0], is_more, statuses),
               RAYC_STATUS_NOT_FINITE, "scene 5: velocities[1]");
  for (int k = 0; k < SCENES; ++k) CHECK(is_more[k] == (k == 5 ? untouched : 0) && (statuses[k] == 0) == (k != 5));
  rayc_contacts* lists[SCENES];
  memcpy(lists, other.contacts, sizeof lists);
  lists[2] = NULL;
  CHECK_STATUS(rayc_scenes_query(SCENES, other.scenes, lists, statuses), RAYC_STATUS_NULL_POINTER, "scene 2: contacts");
  CHECK_OK(rayc_scene_query(other.scenes[2], other.contacts[2]));
  check_alike(&one, &other);

  /* What has no place for an answer, or nobody to work, changes nothing. */
  for (int k = 0; k < SCENES; ++k) {
    CHECK_OK(rayc_contact_system_cancel(other.systems[k]));
    statuses[k] = untouched;
  }
  rayc_scene* scenes[SCENES];
  memcpy(scenes, other.scenes, sizeof scenes);
  scenes[0] = (rayc_scene*)other.contacts[0];
  CHECK_STATUS(BEGIN(other.systems, scenes, EACH), RAYC_STATUS_INVALID_HANDLE, "rayc_contacts");
  CHECK_STATUS(BEGIN(other.systems, NULL, EACH), RAYC_STATUS_NULL_POINTER, "scenes");
  CHECK_STATUS(rayc_scenes_query(SCENES, other.scenes, other.contacts, NULL), RAYC_STATUS_NULL_POINTER, "statuses");
  CHECK(statuses[0] == untouched && statuses[1] == untouched);
  CHECK_STATUS(BEGIN(other.systems, other.scenes, EACH - 3), RAYC_STATUS_WRONG_COUNT, "scene 0: positions has 33");
  CHECK_OK(rayc_contact_systems_begin(0, NULL, NULL, 0.01, EACH, NULL, NULL, NULL, NULL));
  destroy(&one);
  destroy(&other);
}

int main(void) {
  a_call_for_all_does_what_one_for_each_does(1, NULL);
  a_call_for_all_does_what_one_for_each_does(2, NULL);
  a_call_for_all_does_what_one_for_each_does(1, one_by_one);
  an_error_spares_the_others(1);
  an_error_spares_the_others(3);
  return check_result();
}
