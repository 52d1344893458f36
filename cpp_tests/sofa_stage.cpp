// The SOFA-style stage with stand-ins for SOFA's types: what it hands over is what the library found, seen from the
// pair's first model; the response is linear in between, and its product is its derivative.
#include <array>
#include <cmath>
#include <cstdlib>
#include <new>
#include <vector>

#include "check.h"
#include "raycontact/sofa.hpp"

using raycontact::sofa::ModelId;

namespace {

std::size_t allocations = 0;

}  // namespace

void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace {

/** As sofa::type::Vec: numbers behind an operator, no conversion to a pointer. */
template <class Scalar>
class Vec3 {
 public:
  Vec3() = default;
  Vec3(Scalar x, Scalar y, Scalar z) : numbers_{x, y, z} {}
  Scalar& operator[](int axis) { return numbers_[axis]; }
  const Scalar& operator[](int axis) const { return numbers_[axis]; }

 private:
  Scalar numbers_[3];  // not set, as SOFA's
};

template <class Scalar>
struct Vec3Types {
  using Coord = Vec3<Scalar>;
  using Deriv = Vec3<Scalar>;
  using VecCoord = std::vector<Coord>;
  using VecDeriv = std::vector<Deriv>;
};

using Triangle = std::array<std::size_t, 3>;

template <class Scalar>
struct Surface {
  std::vector<Vec3<Scalar>> x;
  std::vector<Triangle> triangles;
};

/** Radius 1 around a centre. */
template <class Scalar>
Surface<Scalar> sphere(double cx, double cy, double cz) {
  Surface<Scalar> surface;
  const int around = 16, rings = 8;
  const double pi = std::acos(-1.0);
  const auto add = [&](double x, double y, double z) {
    surface.x.emplace_back(Scalar(cx + x), Scalar(cy + y), Scalar(cz + z));
  };
  add(0, 0, -1);
  for (int ring = 1; ring < rings; ++ring)
    for (int i = 0; i < around; ++i) {
      const double latitude = pi * ring / rings - pi / 2, longitude = 2 * pi * i / around;
      add(std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude), std::sin(latitude));
    }
  add(0, 0, 1);
  const auto at = [&](int ring, int i) { return static_cast<std::size_t>(1 + (ring - 1) * around + i % around); };
  const std::size_t top = surface.x.size() - 1;
  for (int i = 0; i < around; ++i) {
    surface.triangles.push_back({0, at(1, i + 1), at(1, i)});
    surface.triangles.push_back({top, at(rings - 1, i), at(rings - 1, i + 1)});
    for (int ring = 1; ring + 1 < rings; ++ring) {
      surface.triangles.push_back({at(ring, i), at(ring, i + 1), at(ring + 1, i + 1)});
      surface.triangles.push_back({at(ring, i), at(ring + 1, i + 1), at(ring + 1, i)});
    }
  }
  return surface;
}

template <class Scalar>
double dot(const Vec3<Scalar>& a, const Vec3<Scalar>& b) {
  return double(a[0]) * double(b[0]) + double(a[1]) * double(b[1]) + double(a[2]) * double(b[2]);
}

template <class Scalar>
using Stage = raycontact::sofa::CollisionStage<Vec3Types<Scalar>>;

/** Three spheres in a row; each overlaps the next. */
template <class Scalar>
struct Row {
  std::array<Surface<Scalar>, 3> surfaces = {sphere<Scalar>(0, 0, 0), sphere<Scalar>(1.5, 0.25, 0),
                                             sphere<Scalar>(3, 0, 0.25)};
  Stage<Scalar> stage;
  std::array<ModelId, 3> models{};

  Row() {
    for (std::size_t i = 0; i < 3; ++i) models[i] = stage.addCollisionModel(surfaces[i].x, surfaces[i].triangles);
  }

  void detect(const std::vector<std::pair<ModelId, ModelId>>& pairs) {
    stage.beginNarrowPhase();
    stage.addCollisionPairs(pairs);
    stage.endNarrowPhase();
  }

  std::vector<const std::vector<Vec3<Scalar>>*> positions() const {
    return {&surfaces[0].x, &surfaces[1].x, &surfaces[2].x};
  }
};

template <class Scalar>
void outputs_are_seen_from_the_first_model(double tolerance) {
  Row<Scalar> row;
  row.detect({{1, 0}, {1, 2}});
  const auto& outputs = row.stage.getDetectionOutputs({1, 0});
  CHECK(outputs.size() > 10 && row.stage.getDetectionOutputs({1, 2}).size() > 10);
  CHECK(row.stage.getDetectionOutputs({0, 1}).empty()); /* it was not added in this order */
  CHECK(outputs.size() + row.stage.getDetectionOutputs({1, 2}).size() == row.stage.contacts().size());
  const Vec3<Scalar> first_centre(Scalar(1.5), Scalar(0.25), 0);
  std::size_t from_either[2] = {0, 0};
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const auto& output = outputs[i];
    const rayc_contact& contact = row.stage.contacts()[output.contact];
    CHECK(output.elem.first.model == 1 && output.elem.second.model == 0 && output.id == int64_t(i));
    ++from_either[contact.colliding == 1 ? 0 : 1];
    CHECK(output.elem.first.index == (contact.colliding == 1 ? contact.p1 : contact.p2).triangle);
    Vec3<Scalar> between, outward;
    for (int axis = 0; axis < 3; ++axis) {
      between[axis] = output.point[1][axis] - output.point[0][axis];
      outward[axis] = output.point[0][axis] - first_centre[axis];
    }
    CHECK(output.value < 0);
    CHECK_NEAR(dot(between, output.normal), output.value, tolerance);
    CHECK_NEAR(dot(output.normal, output.normal), 1, tolerance);
    CHECK(dot(output.normal, outward) > 0); /* on a sphere, outward is away from the centre */
  }
  CHECK(from_either[0] > 0 && from_either[1] > 0);
}

template <class Scalar>
void pairs_that_are_not_added_have_no_contacts() {
  Row<Scalar> row;
  row.detect({{0, 1}});
  const std::size_t one_pair = row.stage.contacts().size();
  CHECK(one_pair > 0 && row.stage.getDetectionOutputs({1, 2}).empty());
  row.detect({{1, 2}, {0, 1}, {1, 0}, {0, 0}});
  CHECK(row.stage.getDetectionOutputs({0, 1}).size() == one_pair);
  CHECK(row.stage.getDetectionOutputs({1, 0}).size() == one_pair);
  CHECK(row.stage.getDetectionOutputs({0, 0}).empty()); /* a sphere does not touch itself */
  CHECK(row.stage.contacts().size() > one_pair);
  row.detect({});
  CHECK(row.stage.zeroCollision() && row.stage.statistics().pairs == 0);
}

/** A model with itself: two spheres, one surface. */
void a_model_collides_with_itself() {
  Surface<double> both = sphere<double>(0, 0, 0);
  const Surface<double> other = sphere<double>(1.5, 0.25, 0);
  for (const Triangle& triangle : other.triangles) {
    Triangle moved = triangle;
    for (std::size_t& corner : moved) corner += both.x.size();
    both.triangles.push_back(moved);
  }
  both.x.insert(both.x.end(), other.x.begin(), other.x.end());
  Stage<double> stage;
  const ModelId model = stage.addCollisionModel(both.x, both.triangles);
  for (const bool added : {true, false}) {
    stage.beginNarrowPhase();
    if (added) stage.addCollisionPair({model, model});
    stage.endNarrowPhase();
    CHECK(stage.getDetectionOutputs({model, model}).empty() == !added);
  }
}

template <class Scalar>
void the_product_is_the_derivative_of_the_force(double tolerance) {
  using Vectors = std::vector<Vec3<Scalar>>;
  Row<Scalar> row;
  row.stage.response.stiffness = 100;
  row.stage.response.damping_time = 0.5;
  row.detect({{0, 1}, {1, 2}});
  const std::size_t count = row.surfaces[0].x.size();
  const Vectors zero(count, Vec3<Scalar>(0, 0, 0));
  std::array<Vectors, 3> moved, d, f0, f1, df;
  for (std::size_t i = 0; i < 3; ++i) {
    d[i] = f0[i] = f1[i] = df[i] = zero;
    moved[i] = row.surfaces[i].x;
    for (std::size_t vertex = 0; vertex < count; ++vertex)
      for (int axis = 0; axis < 3; ++axis) {
        d[i][vertex][axis] = Scalar(std::sin(double(i + 3 * vertex) + axis));
        moved[i][vertex][axis] += d[i][vertex][axis];
      }
  }
  row.stage.addForce({&f0[0], &f0[1], &f0[2]}, row.positions(), {nullptr, nullptr, nullptr});
  row.stage.addForce({&f1[0], &f1[1], &f1[2]}, {&moved[0], &moved[1], &moved[2]}, {&d[0], &d[1], &d[2]});
  row.stage.addDForce({&df[0], &df[1], &df[2]}, {&d[0], &d[1], &d[2]}, 1, 1);
  double work = 0, sum[3] = {0, 0, 0};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t vertex = 0; vertex < count; ++vertex) {
      work += dot(df[i][vertex], d[i][vertex]);
      for (int axis = 0; axis < 3; ++axis) {
        CHECK_NEAR(double(f1[i][vertex][axis]) - double(f0[i][vertex][axis]), df[i][vertex][axis], tolerance);
        sum[axis] += double(f0[i][vertex][axis]);
      }
    }
  CHECK(work < 0);
  for (const double component : sum) CHECK_NEAR(component, 0, tolerance);
  CHECK(row.stage.getPotentialEnergy(row.positions()) > 0);

  // The middle one as an obstacle: the same forces on the others, and none is lost on it.
  Vectors g0 = zero, g2 = zero;
  row.stage.addForce({&g0, nullptr, &g2}, row.positions(), {nullptr, nullptr, nullptr});
  for (std::size_t vertex = 0; vertex < count; ++vertex) CHECK(g0[vertex][0] == f0[0][vertex][0]);
  CHECK(dot(g0[0], g0[0]) == dot(f0[0][0], f0[0][0]));
}

void a_steady_step_allocates_nothing() {
  Row<double> row;
  const std::vector<std::pair<ModelId, ModelId>> pairs = {{0, 1}, {2, 1}};
  std::vector<Vec3<double>> f(row.surfaces[0].x.size(), Vec3<double>(0, 0, 0)), df = f;
  const std::vector<std::vector<Vec3<double>>*> forces = {&f, nullptr, nullptr};
  const std::vector<const std::vector<Vec3<double>>*> x = row.positions(), still = {nullptr, nullptr, nullptr};
  for (int step = 0; step < 6; ++step) {
    const std::size_t before = allocations;
    row.stage.setPositions(0, row.surfaces[0].x);
    row.detect(pairs);
    row.stage.addForce(forces, x, still);
    row.stage.addDForce(forces, still, 0.01);
    if (step >= 3) CHECK(allocations == before);
  }
}

void models_come_and_go_and_mistakes_are_named() {
  Row<double> row;
  row.detect({{0, 1}, {1, 2}});
  row.stage.removeCollisionModel(1);
  CHECK(row.stage.getDetectionOutputs({0, 1}).empty());
  const auto status_of = [](auto call) {
    try {
      call();
    } catch (const raycontact::Error& error) {
      return error.status();
    }
    return RAYC_STATUS_OK;
  };
  CHECK(status_of([&] { row.stage.addCollisionPair({0, 1}); }) == RAYC_STATUS_UNKNOWN_BODY);
  CHECK(status_of([&] { row.stage.addForce({}, {}, {}); }) == RAYC_STATUS_WRONG_COUNT);
  row.detect({{0, 2}});
  CHECK(row.stage.zeroCollision());
  CHECK(row.stage.addCollisionModel(row.surfaces[1].x, row.surfaces[1].triangles) == 3);
  CHECK(status_of([&] { row.stage.addCollisionPair({0, 1}); }) == RAYC_STATUS_UNKNOWN_BODY);
  row.detect({{0, 3}, {3, 2}});
  CHECK(!row.stage.getDetectionOutputs({0, 3}).empty() && !row.stage.getDetectionOutputs({3, 2}).empty());
}

}  // namespace

int main() {
  outputs_are_seen_from_the_first_model<double>(1e-12);
  outputs_are_seen_from_the_first_model<float>(1e-5);
  pairs_that_are_not_added_have_no_contacts<double>();
  pairs_that_are_not_added_have_no_contacts<float>();
  a_model_collides_with_itself();
  the_product_is_the_derivative_of_the_force<double>(1e-10);
  the_product_is_the_derivative_of_the_force<float>(1e-3);
  a_steady_step_allocates_nothing();
  models_come_and_go_and_mistakes_are_named();
  return check_result();
}
