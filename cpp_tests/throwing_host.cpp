// A host's parallel_for that throws: through lend_threads() the exception reaches the caller of Scene::query(), with
// the contacts as if nothing had happened; past the C interface it ends the process, and nothing else happens before.
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstring>
#include <vector>

#include "check.h"
#include "raycontact.hpp"
#include "torus.hpp"

using namespace raycontact;

namespace {

struct Fault {
  std::size_t task;
};

/** Throws before its n-th task of all, or at the end of each call. */
struct ThrowingHost {
  std::size_t tasks = 0, fault_before = 0, calls = 0;
  bool throws_at_end = false;

  template <class Task>
  void operator()(std::size_t count, Task task) {
    ++calls;
    for (std::size_t index = 0; index < count; ++index) {
      if (++tasks == fault_before) throw Fault{tasks};
      task(index);
    }
    if (throws_at_end) throw Fault{tasks};
  }
};

Scene scene_of_tori(const rayc_scene_options& options, uint32_t count) {
  Scene scene(options);
  const Torus shape = count < 8 ? torus(80, 40) : torus(24, 16);
  for (uint32_t k = 0; k < count; ++k) {
    const Torus moved = in_row(shape, k);
    scene.add(Mesh(vectors(moved.positions), moved.triangles));
  }
  return scene;
}

Scene scene_on(ThrowingHost& host, uint32_t count) {
  rayc_scene_options options = default_scene_options();
  lend_threads(options, host);
  return scene_of_tori(options, count);
}

/** The number of the task before which a query threw; 0: none did. */
std::size_t fault_of(Scene& scene, Contacts& contacts) {
  try {
    scene.query(contacts);
    return 0;
  } catch (const Fault& fault) {
    return fault.task;
  }
}

bool holds(const Contacts& contacts, const std::vector<rayc_contact>& expected) {
  std::vector<rayc_contact> found;
  contacts.copy_to(found);
  return found.size() == expected.size() &&
         std::memcmp(found.data(), expected.data(), found.size() * sizeof(rayc_contact)) == 0;
}

/** Whichever task it is, few bodies (shared out within a pair) or many (shared out by pairs). */
void exceptions_reach_the_caller_and_nothing_is_lost(uint32_t bodies) {
  Contacts contacts;
  std::vector<rayc_contact> expected[2];
  Scene alone = scene_of_tori(default_scene_options(), bodies);
  for (std::vector<rayc_contact>& of_step : expected) {
    alone.query(contacts);
    contacts.copy_to(of_step);
  }
  CHECK(expected[0].size() > 10 * bodies);
  bool has_ended = false;
  for (std::size_t task = 1; !has_ended; ++task) {
    ThrowingHost host;
    host.fault_before = task;
    Scene scene = scene_on(host, bodies);
    const std::size_t thrown = fault_of(scene, contacts);
    has_ended = thrown == 0;
    CHECK(has_ended ? host.tasks < task && task > 4 : thrown == task);
    CHECK(holds(contacts, expected[0]));
    host.fault_before = 0;
    CHECK(fault_of(scene, contacts) == 0);
    CHECK(holds(contacts, expected[1]));
  }
}

/** Each call throws, when it has done all its tasks: the first is told. */
void the_first_of_many_is_told() {
  ThrowingHost host;
  host.throws_at_end = true;
  Scene scene = scene_on(host, 3);
  Contacts contacts;
  const std::size_t thrown = fault_of(scene, contacts);
  CHECK(host.calls > 1 && thrown > 0 && thrown < host.tasks);
}

/** Queries another scene in each of its calls, as a thread that waits may take one up, and throws in the first. */
struct NestingHost {
  std::size_t calls = 0, inner_faults = 0;

  template <class Task>
  void operator()(std::size_t count, Task task) {
    ++calls;
    ThrowingHost inner;
    inner.fault_before = calls == 1 ? 1 : 0;
    Scene scene = scene_on(inner, 3);
    Contacts contacts;
    inner_faults += fault_of(scene, contacts);
    if (calls == 1) throw Fault{1000};
    for (std::size_t index = 0; index < count; ++index) task(index);
  }
};

void queries_within_the_host_keep_their_exceptions_apart() {
  NestingHost host;
  rayc_scene_options options = default_scene_options();
  lend_threads(options, host);
  Scene scene = scene_of_tori(options, 3);
  Contacts contacts;
  CHECK(fault_of(scene, contacts) == 1000);
  CHECK(host.calls > 1 && host.inner_faults == 1);
  CHECK(fault_of(scene, contacts) == 0);
}

/** The process of a host in C++ that throws past the C interface. */
void exceptions_past_the_c_interface_end_the_process() {
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    std::freopen("/dev/null", "w", stderr);
    rayc_scene_options options = default_scene_options();
    options.parallel_for = [](void*, std::size_t, rayc_task, void*) { throw Fault{0}; };
    Scene scene = scene_of_tori(options, 3);
    Contacts contacts;
    try {
      scene.query(contacts);
    } catch (...) {
    }
    _exit(0);
  }
  int status = 0;
  CHECK(waitpid(child, &status, 0) == child);
  CHECK(WIFSIGNALED(status) && WTERMSIG(status) == SIGABRT);
}

}  // namespace

int main() {
  for (const uint32_t bodies : {3u, 12u}) exceptions_reach_the_caller_and_nothing_is_lost(bodies);
  the_first_of_many_is_told();
  queries_within_the_host_keep_their_exceptions_apart();
  exceptions_past_the_c_interface_end_the_process();
  return check_result();
}
