// Whatever floating-point mode the caller's thread and the host's are in, with traps too, every kind of call gives the
// same bytes as in the default mode and leaves the mode and the flags of exceptions as they were.
#include <cfenv>
#include <cstring>
#include <initializer_list>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

#include "check.h"
#include "raycontact.hpp"
#include "torus.hpp"

#ifdef __SSE2__
#include <xmmintrin.h>
#endif

namespace {

struct Mode {
  const char* name;
  unsigned bits;
};

#ifdef __SSE2__
// MXCSR. Bits 7 to 12 mask the exceptions; 15 and 6 flush results and inputs; 13 and 14 round; 0 to 5 are the flags.
constexpr Mode modes[] = {{"default", 0x1f80},     {"flush to zero", 0x9fc0}, {"up", 0x5f80},
                          {"down, flags", 0x3fbf}, {"to zero", 0x7f80},       {"inexact trapped", 0x0f80},
                          {"all trapped", 0x0000}, {"all of it", 0xe040}};
unsigned mode_now() { return _mm_getcsr(); }
void set_mode(unsigned bits) { _mm_setcsr(bits); }
#else
constexpr Mode modes[] = {
    {"default", FE_TONEAREST}, {"up", FE_UPWARD}, {"down", FE_DOWNWARD}, {"to zero", FE_TOWARDZERO}};
unsigned mode_now() { return static_cast<unsigned>(std::fegetround()); }
void set_mode(unsigned bits) { std::fesetround(static_cast<int>(bits)); }
#endif

/** Makes the call in this mode. The call itself computes nothing. */
template <class Call>
void in_mode(const Mode& mode, rayc_status expected, Call call) {
  set_mode(mode.bits);
  const rayc_status status = call();
  const unsigned left = mode_now();
  set_mode(modes[0].bits);
  CHECK_STATUS(status, expected, nullptr);
  if (left != mode.bits) {
    std::fprintf(stderr, "%s: %x was left as %x\n", mode.name, mode.bits, left);
    ++check_failures;
  }
}

using Bytes = std::string;

template <class T>
void append(Bytes& bytes, const std::vector<T>& values) {
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

/** Threads of a host, each in a mode of its own, whoever asks. */
void on_own_threads(void* failures, std::size_t count, rayc_task task, void* data) {
  std::vector<std::thread> threads;
  std::vector<int> failed(std::size(modes));
  for (std::size_t thread = 0; thread < std::size(modes); ++thread) {
    threads.emplace_back([=, &failed] {
      set_mode(modes[thread].bits);
      for (std::size_t index = thread; index < count; index += std::size(modes)) task(data, index);
      failed[thread] = mode_now() != modes[thread].bits;
      set_mode(modes[0].bits);
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const int one : failed) *static_cast<int*>(failures) += one;
}

Torus sized(Torus torus, double size) {
  for (double& x : torus.positions) x *= size;
  return torus;
}

constexpr uint32_t bodies = 3;
constexpr std::size_t nodes = std::size_t{80} * 40;
constexpr std::size_t unknowns = 3 * bodies * nodes;

/** Everything that is asked of meshes alone, of a size and in a precision. */
Bytes of_meshes(const Mode& mode, uint32_t precision, double size) {
  Bytes found;
  rayc_mesh_options options = raycontact::default_mesh_options();
  options.precision = precision;
  const Torus shapes[] = {sized(torus(80, 40), size), sized(in_row(torus(80, 40), 1), size)};
  rayc_mesh* mesh[2] = {};
  rayc_octree* octree[2] = {};
  for (int k = 0; k < 2; ++k) {
    const rayc_vectors positions = raycontact::vectors(shapes[k].positions);
    const uint32_t* triangles = shapes[k].triangles.data();
    const std::size_t count = shapes[k].triangles.size() / 3;
    in_mode(mode, RAYC_STATUS_OK, [&] { return rayc_mesh_create(&options, &positions, triangles, count, &mesh[k]); });
    in_mode(mode, RAYC_STATUS_OK, [&] { return rayc_mesh_set_positions(mesh[k], &positions); });
    in_mode(mode, RAYC_STATUS_OK, [&] { return rayc_octree_create(nullptr, mesh[k], &octree[k]); });
    in_mode(mode, RAYC_STATUS_OK, [&] { return rayc_octree_update(octree[k], mesh[k]); });
  }
  const rayc_vectors points = raycontact::vectors(shapes[1].positions);
  std::vector<rayc_closest_point> closest(nodes);
  std::vector<int32_t> windings(nodes);
  in_mode(mode, RAYC_STATUS_OK,
          [&] { return rayc_octree_closest_points(octree[0], mesh[0], &points, nullptr, closest.data()); });
  in_mode(mode, RAYC_STATUS_OK,
          [&] { return rayc_octree_winding_numbers(octree[0], mesh[0], &points, windings.data()); });
  std::vector<rayc_ray> rays(nodes);
  for (std::size_t i = 0; i < nodes; ++i) {
    const double* p = &shapes[1].positions[3 * i];
    rays[i] = {{p[0], p[1], p[2]}, {0.6 - 0.001 * static_cast<double>(i), 0.3, -0.7}, INFINITY};
  }
  std::vector<rayc_hit> hits(nodes + 1);
  in_mode(mode, RAYC_STATUS_OK,
          [&] { return rayc_octree_trace_rays(octree[0], mesh[0], rays.data(), nodes, hits.data()); });
  in_mode(mode, RAYC_STATUS_OK, [&] { return rayc_octree_trace_ray(octree[0], mesh[0], &rays[7], &hits[nodes]); });
  append(found, closest);
  append(found, windings);
  append(found, hits);

  const raycontact::Contacts contacts;
  std::vector<rayc_contact> list;
  struct Sampling {
    uint32_t kind;
    double value;
  };
  for (const Sampling& sampling : {Sampling{RAYC_SAMPLING_ACCURACY, 0}, Sampling{RAYC_SAMPLING_ACCURACY, 0.05},
                                   Sampling{RAYC_SAMPLING_SPACING, 0.1 * size}, Sampling{RAYC_SAMPLING_VERTICES, 0}}) {
    for (const uint32_t law : {RAYC_LAW_PRESSURE, RAYC_LAW_RAY_LENGTH}) {
      rayc_detection_options detection = raycontact::default_detection_options();
      detection.sampling = sampling.kind;
      detection.sampling_value = sampling.value;
      detection.law = law;
      in_mode(mode, RAYC_STATUS_OK,
              [&] { return rayc_query_pair(&detection, mesh[0], octree[0], mesh[1], octree[1], contacts.get()); });
      contacts.copy_to(list);
      append(found, list);
    }
  }
  in_mode(mode, RAYC_STATUS_OK, [&] { return rayc_query_self(nullptr, mesh[0], octree[0], contacts.get()); });
  contacts.copy_to(list);
  append(found, list);

  // Errors as well give the mode back: a ray that goes nowhere, positions of another mesh.
  const rayc_ray nowhere = {{0, 0, 0}, {0, 0, 0}, 1};
  in_mode(mode, RAYC_STATUS_INVALID_OPTION,
          [&] { return rayc_octree_trace_ray(octree[0], mesh[0], &nowhere, hits.data()); });
  const rayc_vectors few = {shapes[0].positions.data(), 5, 0, RAYC_SCALAR_F64};
  in_mode(mode, RAYC_STATUS_WRONG_COUNT, [&] { return rayc_mesh_set_positions(mesh[0], &few); });
  for (int k = 0; k < 2; ++k) {
    in_mode(mode, RAYC_STATUS_OK, [&] { return rayc_octree_destroy(octree[k]); });
    in_mode(mode, RAYC_STATUS_OK, [&] { return rayc_mesh_destroy(mesh[k]); });
  }
  return found;
}

/** Steps of a scene on such threads, with forces and self-collision. */
Bytes of_a_scene(const Mode& mode, uint32_t precision, double size, uint32_t threads, rayc_parallel_for parallel_for) {
  Bytes found;
  int failures_of_threads = 0;
  rayc_mesh_options mesh_options = raycontact::default_mesh_options();
  rayc_scene_options options = raycontact::default_scene_options();
  mesh_options.precision = options.precision = precision;
  options.threads = threads;
  options.parallel_for = parallel_for;
  options.parallel_context = &failures_of_threads;
  rayc_scene* scene = nullptr;
  in_mode(mode, RAYC_STATUS_OK, [&] { return rayc_scene_create(&options, &scene); });
  std::vector<Torus> shapes;
  for (uint32_t k = 0; k < bodies; ++k) {
    shapes.push_back(sized(in_row(torus(80, 40), k), size));
    const raycontact::Mesh mesh(raycontact::vectors(shapes[k].positions), shapes[k].triangles, mesh_options);
    uint32_t body = 0;
    in_mode(mode, RAYC_STATUS_OK, [&] { return rayc_scene_add_mesh(scene, mesh.get(), &body); });
    in_mode(mode, RAYC_STATUS_OK, [&] { return rayc_scene_set_self_collision(scene, body, 1); });
  }
  const raycontact::Contacts contacts;
  std::vector<rayc_contact> list;
  for (int step = 0; step < 3; ++step) {
    for (uint32_t k = 0; k < bodies; ++k) {
      for (double& x : shapes[k].positions) x += 0.01 * size * (k + 1);
      const rayc_vectors positions = raycontact::vectors(shapes[k].positions);
      in_mode(mode, RAYC_STATUS_OK, [&] { return rayc_scene_set_positions(scene, k, &positions); });
    }
    const rayc_pose pose = {{0.02 * size * step, 0, 0}, {{0.8, -0.6, 0}, {0.6, 0.8, 0}, {0, 0, 1}}};
    in_mode(mode, RAYC_STATUS_OK, [&] { return rayc_scene_set_pose(scene, 1, &pose); });
    in_mode(mode, RAYC_STATUS_OK, [&] { return rayc_scene_query(scene, contacts.get()); });
    contacts.copy_to(list);
    CHECK(list.size() > 100);
    append(found, list);
    double joules = 0;
    in_mode(mode, RAYC_STATUS_OK, [&] { return rayc_contacts_energy(contacts.get(), nullptr, 0, nullptr, &joules); });
    append(found, std::vector<double>{joules});
    in_mode(mode, RAYC_STATUS_OK, [&] { return rayc_scene_advance(scene, 0.01); });
  }
  in_mode(mode, RAYC_STATUS_OK, [&] { return rayc_scene_destroy(scene); });
  CHECK(failures_of_threads == 0);
  return found;
}

/** A step of the contact system, with friction: forces, products, another detection, its end. */
Bytes of_a_contact_system(const Mode& mode) {
  Bytes found;
  raycontact::Scene scene;
  rayc_contact_system* system = nullptr;
  in_mode(mode, RAYC_STATUS_OK, [&] { return rayc_contact_system_create(nullptr, &system); });
  const std::vector<double> masses(bodies * nodes, 0.001);
  in_mode(mode, RAYC_STATUS_OK,
          [&] { return rayc_contact_system_set_node_masses(system, masses.size(), masses.data()); });
  std::vector<double> x, v(unknowns), forces(unknowns), products(unknowns), numbers(2);
  rayc_material material{sizeof material, 1e4, 0.01, 0.3, 0.05, 0};
  for (uint32_t k = 0; k < bodies; ++k) {
    const Torus shape = in_row(torus(80, 40), k);
    x.insert(x.end(), shape.positions.begin(), shape.positions.end());
    const uint32_t body = scene.add(raycontact::Mesh(raycontact::vectors(shape.positions), shape.triangles));
    in_mode(mode, RAYC_STATUS_OK, [&] {
      return rayc_contact_system_add_deformable(system, scene.get(), body, static_cast<uint32_t>(k * nodes), nodes,
                                                nullptr, 0, nullptr, nullptr, &material);
    });
  }
  for (std::size_t i = 0; i < unknowns; ++i) v[i] = 1e-3 * static_cast<double>(i % 7);
  const double up[3] = {0, 0, 1};
  in_mode(mode, RAYC_STATUS_OK, [&] { return rayc_contact_system_add_half_space(system, up, -0.3, &material); });
  for (int step = 0; step < 2; ++step) {
    in_mode(mode, RAYC_STATUS_OK, [&] {
      return rayc_contact_system_begin(system, scene.get(), 0.01, unknowns, x.data(), v.data(), v.data());
    });
    in_mode(mode, RAYC_STATUS_OK,
            [&] { return rayc_contact_system_add_forces(system, unknowns, v.data(), forces.data()); });
    in_mode(mode, RAYC_STATUS_OK,
            [&] { return rayc_contact_system_add_product(system, 0.01, unknowns, v.data(), products.data()); });
    in_mode(mode, RAYC_STATUS_OK,
            [&] { return rayc_contact_system_linearise(system, unknowns, v.data(), &numbers[0]); });
    in_mode(mode, RAYC_STATUS_OK, [&] { return rayc_contact_system_energy(system, unknowns, v.data(), &numbers[1]); });
    in_mode(mode, RAYC_STATUS_OK, [&] { return rayc_contact_system_finish(system, unknowns, v.data()); });
    for (std::size_t i = 0; i < unknowns; ++i) x[i] += 0.01 * v[i];
    append(found, forces);
    append(found, products);
    append(found, numbers);
  }
  CHECK(numbers[1] > 0);
  in_mode(mode, RAYC_STATUS_OK, [&] { return rayc_contact_system_destroy(system); });
  return found;
}

/** What this gives in the default mode it gives in all. */
template <class Ask>
void all_modes_give_the_same(const char* what, Ask ask) {
  const Bytes expected = ask(modes[0]);
  for (const Mode& mode : modes) {
    if (ask(mode) == expected) continue;
    std::fprintf(stderr, "%s: other bytes in the mode \"%s\"\n", what, mode.name);
    ++check_failures;
  }
}

}  // namespace

int main() {
  // The small sizes have products that only subnormal numbers can hold.
  const struct {
    uint32_t precision;
    double size;
  } kinds[] = {{RAYC_SCALAR_F64, 1}, {RAYC_SCALAR_F64, 1e-155}, {RAYC_SCALAR_F32, 1}, {RAYC_SCALAR_F32, 1e-20}};
  for (const auto& [precision, size] : kinds) {
    all_modes_give_the_same("meshes", [&](const Mode& mode) { return of_meshes(mode, precision, size); });
    const Bytes alone = of_a_scene(modes[0], precision, size, 1, nullptr);
    for (const Mode& mode : modes) {
      CHECK(of_a_scene(mode, precision, size, 1, nullptr) == alone);
      CHECK(of_a_scene(mode, precision, size, 2, nullptr) == alone);
      CHECK(of_a_scene(mode, precision, size, 1, on_own_threads) == alone);
    }
  }
  all_modes_give_the_same("contact system", of_a_contact_system);
  return check_result();
}
