// raycontact.hpp: owners move and do not copy, views show the caller's arrays, errors are exceptions; its answers are
// those of the C functions.
#include <array>
#include <cmath>
#include <cstring>
#include <deque>
#include <type_traits>
#include <utility>
#include <vector>

#include "check.h"
#include "raycontact.hpp"

using namespace raycontact;

int check_results_without_exceptions();

namespace {

static_assert(!std::is_copy_constructible<Mesh>::value && std::is_nothrow_move_constructible<Mesh>::value, "");
static_assert(!std::is_copy_constructible<Octree>::value && std::is_nothrow_move_constructible<Octree>::value, "");
static_assert(!std::is_copy_constructible<Contacts>::value && std::is_nothrow_move_constructible<Contacts>::value, "");
static_assert(!std::is_copy_constructible<Scene>::value && std::is_nothrow_move_assignable<Scene>::value, "");

using Point = std::array<double, 3>;
const std::vector<Point> corners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
const std::vector<uint32_t> faces = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};

std::vector<Point> shifted(double by) {
  std::vector<Point> moved = corners;
  for (Point& point : moved)
    for (double& x : point) x += by;
  return moved;
}

template <class Call>
void check_throws(rayc_status status, const char* part, Call call) {
  try {
    call();
  } catch (const Error& error) {
    CHECK(error.status() == status && std::strstr(error.what(), part) != nullptr);
    return;
  }
  CHECK(!"an exception was thrown");
}

/** A vector type with something behind its three numbers. */
struct Padded {
  float numbers[3];
  int tag;
  float& operator[](int axis) { return numbers[axis]; }
  const float& operator[](int axis) const { return numbers[axis]; }
};

void views_show_arrays_as_they_are() {
  const std::vector<double> packed = {1, 2, 3, 4, 5, 6};
  const rayc_vectors two = vectors(packed);
  CHECK(two.data == packed.data() && two.count == 2 && two.stride == 0 && two.scalar == RAYC_SCALAR_F64);
  std::array<Padded, 5> padded{};
  const rayc_vectors_mut five = vectors_mut(padded);
  CHECK(five.data == &padded[0][0] && five.count == 5 && five.stride == sizeof(Padded));
  CHECK(five.scalar == RAYC_SCALAR_F32);
  CHECK(vectors(std::vector<Point>{}).count == 0);
  // One or two numbers too many are not left out.
  for (std::size_t size : {1u, 2u, 10u, 11u, 13u}) {
    const std::vector<double> odd(size);
    std::vector<float> odd_floats(size);
    const std::string said = "array of " + std::to_string(size) + " numbers, which is no multiple of three";
    check_throws(RAYC_STATUS_INVALID_STRIDE, said.c_str(), [&] { Mesh(vectors(odd), faces); });
    Mesh mesh(vectors(corners), faces);
    check_throws(RAYC_STATUS_INVALID_STRIDE, said.c_str(), [&] { mesh.set_positions(vectors(odd)); });
    const rayc_vectors_mut view = vectors_mut(odd_floats);
    check_throws(RAYC_STATUS_INVALID_STRIDE, said.c_str(),
                 [&] { raycontact::check(rayc_mesh_copy_positions(mesh.get(), &view)); });
  }
}

void errors_are_exceptions() {
  const std::vector<uint32_t> holed(faces.begin(), faces.begin() + 9), odd(faces.begin(), faces.begin() + 11);
  check_throws(RAYC_STATUS_MESH_OPEN, "RAYC_STATUS_MESH_OPEN: ", [&] { Mesh(vectors(corners), holed); });
  check_throws(RAYC_STATUS_WRONG_COUNT, "11", [&] { Mesh(vectors(corners), odd); });
  check_throws(RAYC_STATUS_FILE_NOT_READABLE, "none.obj", [&] { Mesh::from_obj("none.obj"); });
  check_throws(RAYC_STATUS_INVALID_OPTION, "2000", [] { Scene(2000); });
  Scene scene;
  Contacts contacts;
  check_throws(RAYC_STATUS_UNKNOWN_BODY, "3", [&] { scene.remove(3); });
  const rayc_vectors one[] = {vectors(corners)};
  check_throws(RAYC_STATUS_WRONG_COUNT, "1 arrays", [&] {
    contacts.add_differential(default_response_options(), 1, 0, one, Span<const rayc_vectors_mut>());
  });
  check_throws(RAYC_STATUS_WRONG_COUNT, "1 arrays", [&] { contacts.energy(default_response_options(), 2, one); });
  Scene other = std::move(scene);
  check_throws(RAYC_STATUS_NULL_POINTER, "scene", [&] { scene.query(contacts); });
  other.query(contacts);
  CHECK(contacts.size() == 0);
}

void a_ray_hits_where_it_should() {
  const Mesh mesh(vectors(corners), faces);
  Octree octree(mesh);
  const rayc_ray ray = {{0.25, 0.25, -1}, {0, 0, 2}, 10};
  const rayc_hit hit = octree.trace(mesh, ray);
  CHECK(hit.triangle == 0 && hit.is_exit == 0);
  CHECK_NEAR(hit.t, 0.5, 1e-15);
  rayc_hit hits[1];
  octree.trace(mesh, Span<const rayc_ray>(&ray, 1), hits);
  CHECK(hits[0].triangle == 0);
  check_throws(RAYC_STATUS_WRONG_COUNT, "room for 1", [&] { octree.trace(mesh, {}, hits); });
}

void closest_points_and_winding_numbers() {
  const Mesh mesh(vectors(corners), faces);
  const Octree octree(mesh);
  const std::vector<Point> points = {{0.1, 0.2, 0.3}, {-3, 0.25, 0.25}};
  std::vector<rayc_closest_point> closest(2);
  std::vector<int32_t> numbers(2);
  octree.closest_points(mesh, vectors(points), closest);
  CHECK_NEAR(closest[0].distance, 0.1, 1e-15);
  CHECK(closest[1].distance == 3 && closest[1].position[1] == 0.25);
  const std::vector<double> bounds = {0.05, 4};
  octree.closest_points(mesh, vectors(points), closest, bounds);
  CHECK(closest[0].triangle == RAYC_NO_TRIANGLE && closest[1].distance == 3);
  octree.winding_numbers(mesh, vectors(points), numbers);
  CHECK(numbers[0] == 1 && numbers[1] == 0);
  const std::vector<double> one_bound = {1};
  check_throws(RAYC_STATUS_WRONG_COUNT, "1 bounds",
               [&] { octree.closest_points(mesh, vectors(points), closest, one_bound); });
  numbers.resize(1);
  check_throws(RAYC_STATUS_WRONG_COUNT, "room for 1", [&] { octree.winding_numbers(mesh, vectors(points), numbers); });
}

/** One mesh of the tetrahedron twice, the second shifted along the diagonal: its corner lies inside the first. */
void own_exits_are_those_of_the_c_function() {
  std::vector<Point> twice = corners;
  for (const Point& corner : shifted(0.2)) twice.push_back(corner);
  std::vector<uint32_t> both(faces.begin(), faces.end());
  for (const uint32_t vertex : faces) both.push_back(vertex + 4);
  const Mesh mesh(vectors(twice), both);
  Octree octree(mesh);
  std::vector<rayc_own_exit> exits(twice.size());
  const std::size_t count = octree.own_exits(mesh, exits);
  CHECK(count == 1 && exits[0].vertex == 4);
  CHECK_NEAR(exits[0].distance, 0.2, 1e-15);
  check_throws(RAYC_STATUS_WRONG_COUNT, "room for 0", [&] { octree.own_exits(mesh, {}); });
}

/** All that a scene and its contacts offer, on the example of README.md, whose forces have a closed form. */
void a_scene_answers_as_the_c_functions_do() {
  std::vector<Point> a = corners, b = shifted(0.2);
  Scene scene(default_scene_options());
  scene.set_sampling(RAYC_SAMPLING_SPACING,
                     0.005);  // an eightieth of the overlap: the pressure in the middle stands for a whole piece
  scene.add(Mesh(vectors(a), faces));
  scene.add(Mesh(vectors(corners), faces));
  scene.set_positions(1, vectors(b));
  const rayc_pose nowhere_else = {{0, 0, 0}, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  scene.set_pose(0, nowhere_else);
  check_throws(RAYC_STATUS_UNKNOWN_BODY, "body 2", [&] { scene.set_pose(2, nowhere_else); });
  Contacts contacts;
  scene.query(contacts);

  const std::size_t count = contacts.size();
  CHECK(count > 0 && contacts.statistics().contacts == count);
  std::vector<rayc_contact> list;
  std::vector<double> coefficients;
  const rayc_response_options response = default_response_options();
  contacts.copy_to(list);
  contacts.copy_coefficients_to(response, coefficients);
  double expected_energy = 0;
  for (std::size_t i = 0; i < count; ++i) expected_energy += 0.5 * coefficients[i] * list[i].depth * list[i].depth;

  std::vector<Point> force_a(4), force_b(4), force_there_a(4), force_there_b(4);
  const rayc_vectors positions[] = {vectors(a), vectors(b)};
  const rayc_vectors_mut forces[] = {vectors_mut(force_a), vectors_mut(force_b)};
  const rayc_vectors_mut forces_there[] = {vectors_mut(force_there_a), vectors_mut(force_there_b)};
  contacts.add_forces(response, forces);
  contacts.add_forces(response, positions, {}, forces_there);
  double along_x = 0;
  for (std::size_t vertex = 0; vertex < 4; ++vertex) {
    along_x += force_b[vertex][0];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      CHECK_NEAR(force_there_a[vertex][axis], force_a[vertex][axis], 1e-15);
      CHECK_NEAR(force_there_b[vertex][axis], force_b[vertex][axis], 1e-15);
    }
  }
  // Half of b's three faces inside a, by the distance to a's slanted face, or in the corner to its other faces; half of
  // a's slanted face inside b, by the distance to the nearest of b's three.
  const double corner = 0.4 - 0.2 * std::sqrt(3.0);
  const double of_b = (std::pow(0.4, 3) - std::pow(corner, 3)) / 6 / std::sqrt(3.0), of_a = std::pow(0.4, 3) / 18;
  CHECK_NEAR(along_x, (of_a + of_b) / 2, 2e-6);
  CHECK_NEAR(contacts.energy(response, 2), expected_energy, 1e-15);
  CHECK_NEAR(contacts.energy(response, 2, positions), expected_energy, 1e-15);

  // At rest rigid bodies get what their vertices do; the second slides, and friction brakes it.
  const double points[6] = {};
  double speeds[12] = {}, smooth[12] = {}, rough[12] = {};
  contacts.add_wrenches(response, points, speeds, smooth);
  CHECK_NEAR(smooth[6], along_x, 1e-15);
  rayc_response_options rubbing = response;
  rubbing.friction = 0.5;
  rubbing.slip_speed = 0.1;
  speeds[7] = 0.1;
  contacts.add_wrenches(rubbing, points, speeds, rough);
  CHECK(rough[7] < smooth[7] && rough[1] > smooth[1]);
  check_throws(RAYC_STATUS_WRONG_COUNT, "for 2 bodies", [&] { contacts.add_wrenches(response, points, points, rough); });

  // Moved together, bodies change nothing between them.
  const std::vector<Point> along(4, Point{1, 2, 3});
  std::vector<Point> change_a(4), change_b(4);
  const rayc_vectors displacements[] = {vectors(along), vectors(along)};
  const rayc_vectors_mut changes[] = {vectors_mut(change_a), vectors_mut(change_b)};
  contacts.add_differential(response, 1, 0, displacements, changes);
  for (const Point& change : change_a) CHECK_NEAR(change[0], 0, 1e-14);
  scene.add_differential(contacts, response, 1, 0, displacements, changes);
  for (const Point& change : change_a) CHECK_NEAR(change[0], 0, 1e-13);
  check_throws(RAYC_STATUS_WRONG_COUNT, "give one for each", [&] {
    scene.add_differential(contacts, response, 1, 0, Span<const rayc_vectors>(), changes);
  });

  CHECK(scene.may_escape(0, 1));
  scene.allow_escape(0, 1, false);
  CHECK(!scene.may_escape(1, 0));
  std::vector<rayc_pair_memory> memories;
  std::vector<uint8_t> saved;
  std::vector<rayc_escape_push> pushes;
  scene.query(contacts);
  scene.copy_pair_memories_to(memories);
  CHECK(memories.size() == 1 && memories[0].first == 0 && memories[0].second == 1);
  scene.save_pair_memories_to(saved);
  scene.restore_pair_memories(saved);
  saved[9] ^= 1;
  check_throws(RAYC_STATUS_SAVED_STATE_OTHER_VERSION, "form", [&] { scene.restore_pair_memories(saved); });
  contacts.copy_escape_pushes_to(pushes);
  CHECK(pushes.empty());
}

void pairs_and_selves_without_a_scene() {
  const std::vector<Point> b = shifted(0.2);
  Mesh first(vectors(corners), faces), second(vectors(corners), faces);
  Octree octree_first(first), octree_second(second);
  second.set_positions(vectors(b));
  Contacts contacts;
  check_throws(RAYC_STATUS_OCTREE_STALE, "", [&] { query_pair(first, octree_first, second, octree_second, contacts); });
  octree_second.update(second);
  query_pair(first, octree_first, second, octree_second, contacts);
  CHECK(contacts.size() > 0);
  query_self(first, octree_first, contacts);
  CHECK(contacts.size() == 0);
  CHECK(second.vertex_count() == 4 && second.triangle_count() == 4 && second.triangles() == faces);
  CHECK(second.positions()[0] == 0.2 && second.positions().size() == 12);
}

/** Two tetrahedra whose corners are nodes. */
struct Tetrahedra {
  Tetrahedra() {
    system.set_node_masses(std::vector<double>(8, 1.0));
    for (uint32_t body = 0; body < 2; ++body) {
      scene.add(Mesh(vectors(body == 0 ? corners : shifted(0.2)), faces));
      system.add_deformable(scene, body, 4 * body, 4, bearing_material(1000, 0.1));
    }
  }
  Scene scene;
  ContactSystem system;
};

std::vector<double> positions_of_tetrahedra() {
  std::vector<double> x;
  for (double shift : {0.0, 0.25})
    for (const Point& point : shifted(shift)) x.insert(x.end(), point.begin(), point.end());
  return x;
}

void a_system_takes_floats_and_gives_compressed_rows() {
  Tetrahedra one, other;
  const std::vector<double> x = positions_of_tetrahedra(), v(24, 0.125);
  const std::vector<float> float_x(x.begin(), x.end());
  const std::array<float, 24> float_v = [] {
    std::array<float, 24> all{};
    all.fill(0.125F);
    return all;
  }();
  one.system.begin(one.scene, 0.01, x, v, v);
  other.system.begin(other.scene, 0.01, float_x, float_v, float_v);
  std::vector<double> sums(24), product(24);
  std::vector<float> float_sums(24), float_product(24);
  one.system.add_forces(v, sums);
  one.system.add_product(2, v, product);
  other.system.add_forces(float_v, float_sums);
  other.system.add_product(2, float_v, float_product);
  const CompressedRows matrix = one.system.csr(2);
  CHECK(matrix.offsets.size() == 25 && matrix.columns.size() == matrix.values.size() && matrix.values.size() > 9);
  for (std::size_t row = 0; row < 24; ++row) {
    CHECK(float_sums[row] == static_cast<float>(sums[row]) && float_product[row] == static_cast<float>(product[row]));
    double sum = 0;
    for (int32_t at = matrix.offsets[row]; at < matrix.offsets[row + 1]; ++at)
      sum += matrix.values[std::size_t(at)] * 0.125;
    CHECK_NEAR(sum, product[row], 1e-9);
  }
  CHECK(one.system.energy(v) == other.system.energy(float_v) && one.system.energy(v) > 0);
  CHECK(one.system.misjudged(v) == other.system.misjudged(float_v));
  CHECK(one.system.linearise(v) == other.system.linearise(float_v));
  CHECK(!other.system.detect_again(other.scene, float_v));
  const double stored = one.system.potential(one.scene, v, 0.5);
  CHECK(stored > 0 && stored == one.system.potential(one.scene, v, 0.5));
  check_throws(RAYC_STATUS_INVALID_OPTION, "part", [&] { one.system.potential(one.scene, v, 1.5); });
  check_throws(RAYC_STATUS_WRONG_COUNT, "velocities", [&] { one.system.potential(one.scene, Span<double>()); });
  check_throws(RAYC_STATUS_WRONG_COUNT, "equally", [&] { other.system.add_forces(float_v, Span<float>()); });
  other.system.finish(float_v);
  check_throws(RAYC_STATUS_OUT_OF_ORDER, "begin", [&] { other.system.csr(1); });
  check_throws(RAYC_STATUS_OUT_OF_ORDER, "begin", [&] { other.system.potential(other.scene, v); });
  rayc_contact_system_options options = default_contact_system_options();
  options.keeps_rigid_unknowns = 1;
  ContactSystem empty(options);
  Scene nobody;
  empty.begin(nobody, 0.01, {}, {}, {});  // doubles
  CHECK(empty.csr(1).offsets.size() == 1 && empty.csr(1).values.size() == 0);
  CHECK(other.system.explicit_step(other.scene, 0.01, float_x, float_v, float_sums) > 0);
}

void many_systems_begin_at_once() {
  std::vector<Scene> scenes;
  std::vector<ContactSystem> systems;
  std::vector<Contacts> contacts(3);
  std::vector<double> x;
  for (int k = 0; k < 3; ++k) {
    Tetrahedra pair;
    scenes.push_back(std::move(pair.scene));
    systems.push_back(std::move(pair.system));
    for (const double number : positions_of_tetrahedra()) x.push_back(number);
  }
  const std::vector<double> v(x.size());
  std::array<uint32_t, 3> is_more{};
  Batch batch(scenes, systems);
  x[30] = std::nan("");
  check_throws(RAYC_STATUS_NOT_FINITE, "scene 1: positions[6]", [&] { batch.begin(0.01, x, v, v); });
  CHECK(batch.statuses()[0] == RAYC_STATUS_OK && batch.statuses()[1] == RAYC_STATUS_NOT_FINITE);
  CHECK(batch.statuses()[2] == RAYC_STATUS_OK);
  systems[0].cancel();
  systems[2].cancel();
  x[30] = x[6];
  batch.begin(0.01, x, v, v);
  batch.detect_again(v, is_more);
  batch.query(contacts);
  for (int k = 0; k < 3; ++k)
    CHECK(contacts[k].size() > 0 && contacts[k].size() == contacts[0].size() && is_more[k] == 0);
  const std::vector<double> few(4);
  check_throws(RAYC_STATUS_WRONG_COUNT, "as many numbers", [&] { batch.begin(0.01, few, few, few); });
  check_throws(RAYC_STATUS_WRONG_COUNT, "as many lists", [&] { batch.query(Span<Contacts>(contacts.data(), 2)); });
  check_throws(RAYC_STATUS_WRONG_COUNT, "as many systems", [&] { Batch(scenes).begin(0.01, x, v, v); });
}

}  // namespace

int main() {
  views_show_arrays_as_they_are();
  errors_are_exceptions();
  a_ray_hits_where_it_should();
  closest_points_and_winding_numbers();
  own_exits_are_those_of_the_c_function();
  a_scene_answers_as_the_c_functions_do();
  pairs_and_selves_without_a_scene();
  a_system_takes_floats_and_gives_compressed_rows();
  many_systems_begin_at_once();
  const int without_exceptions = check_results_without_exceptions();
  return check_result() != 0 ? 1 : without_exceptions;
}
