// Whose threads work makes no difference: the caller's own, a pool's, oneTBB's, those of a host that cannot nest. The
// contacts are equal byte by byte, as are those of scenes that are queried at once from several threads.
#include <tbb/parallel_for.h>

#include <atomic>
#include <cstring>
#include <thread>
#include <vector>

#include "check.h"
#include "raycontact.hpp"
#include "torus.hpp"

namespace {

/** Two fine bodies, whose one pair is shared out by its rays, or many coarse ones, shared out by pairs. */
struct Bodies {
  uint32_t count, around, across;
};

std::vector<rayc_contact> contacts_of(const rayc_scene_options& options, const Bodies& bodies) {
  const Torus shape = torus(bodies.around, bodies.across);
  rayc_scene* scene = nullptr;
  CHECK_OK(rayc_scene_create(&options, &scene));
  raycontact::Contacts contacts;
  std::vector<rayc_contact> found;
  for (uint32_t body = 0; body < bodies.count; ++body) {
    const Torus moved = in_row(shape, body);
    const raycontact::Mesh mesh(raycontact::vectors(moved.positions), moved.triangles);
    uint32_t number = 0;
    CHECK_OK(rayc_scene_add_mesh(scene, mesh.get(), &number));
  }
  for (int step = 0; step < 2; ++step) CHECK_OK(rayc_scene_query(scene, contacts.get()));
  CHECK_OK(rayc_scene_destroy(scene));
  contacts.copy_to(found);
  return found;
}

rayc_scene_options options_with(uint32_t threads, rayc_parallel_for parallel_for = nullptr, void* context = nullptr) {
  rayc_scene_options options{};
  CHECK_OK(rayc_default_scene_options(sizeof options, &options));
  options.threads = threads;
  options.parallel_for = parallel_for;
  options.parallel_context = context;
  return options;
}

bool equal(const std::vector<rayc_contact>& a, const std::vector<rayc_contact>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(rayc_contact)) == 0;
}

/** oneTBB: the whole of what a host writes. */
void on_tbb(void* calls, std::size_t count, rayc_task task, void* data) {
  ++*static_cast<std::atomic<int>*>(calls);
  tbb::parallel_for(std::size_t{0}, count, [=](std::size_t index) { task(data, index); });
}

/** Threads of a host that breaks when it is called from one of its own calls. */
struct OwnThreads {
  std::atomic<bool> busy{false};
  std::atomic<int> calls{0};

  static void run(void* context, std::size_t count, rayc_task task, void* data) {
    auto& self = *static_cast<OwnThreads*>(context);
    CHECK(!self.busy.exchange(true));
    ++self.calls;
    std::vector<std::thread> threads;
    for (std::size_t thread = 0; thread < 3; ++thread) {
      threads.emplace_back([=] {
        for (std::size_t index = thread; index < count; index += 3) task(data, index);
      });
    }
    for (std::thread& thread : threads) thread.join();
    self.busy = false;
  }
};

void all_threads_find_the_same(const Bodies& bodies, const std::vector<rayc_contact>& expected) {
  for (const uint32_t threads : {2u, 5u, 0u}) CHECK(equal(contacts_of(options_with(threads), bodies), expected));
  std::atomic<int> tbb_calls{0};
  CHECK(equal(contacts_of(options_with(1, on_tbb, &tbb_calls), bodies), expected));
  CHECK(tbb_calls > 0);
  OwnThreads own;
  CHECK(equal(contacts_of(options_with(1, OwnThreads::run, &own), bodies), expected));
  CHECK(own.calls > 0);
}

void several_scenes_at_once(const Bodies& bodies, const std::vector<rayc_contact>& expected) {
  std::atomic<int> tbb_calls{0};
  std::vector<std::vector<rayc_contact>> found(4);
  std::vector<std::thread> hosts;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const rayc_scene_options options = i == 0   ? options_with(3)
                                       : i == 1 ? options_with(1, on_tbb, &tbb_calls)
                                                : options_with(1);
    hosts.emplace_back([&, options, i] { found[i] = contacts_of(options, bodies); });
  }
  for (std::thread& host : hosts) host.join();
  for (const std::vector<rayc_contact>& contacts : found) CHECK(equal(contacts, expected));
}

void contradictions_are_refused() {
  std::atomic<int> calls{0};
  const rayc_scene_options options = options_with(2, on_tbb, &calls);
  rayc_scene* scene = nullptr;
  CHECK_STATUS(rayc_scene_create(&options, &scene), RAYC_STATUS_INVALID_OPTION, "parallel_for");
  CHECK(scene == nullptr);
}

}  // namespace

int main() {
  for (const Bodies& bodies : {Bodies{2, 80, 40}, Bodies{12, 24, 16}}) {
    const std::vector<rayc_contact> expected = contacts_of(options_with(1), bodies);
    CHECK(expected.size() > 10 * bodies.count);
    all_threads_find_the_same(bodies, expected);
    several_scenes_at_once(bodies, expected);
  }
  contradictions_are_refused();
  return check_result();
}
