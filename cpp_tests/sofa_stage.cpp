// The stage in SOFA's words, on vector types that offer what SOFA's do: what it hands over is what the library found,
// seen from the pair's first model.
#include <array>
#include <cstdlib>
#include <new>
#include <vector>

#include "check.h"
#include "raycontact/sofa.hpp"
#include "sofa_types.hpp"

using raycontact::ModelId;

namespace {

std::size_t allocations = 0;

}  // namespace

// Inlined, only one of a pair would be seen to call malloc or free, which GCC warns of.
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace {

template <class Scalar>
using Stage = raycontact::CollisionStage<Vec3Types<Scalar>>;

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

void a_steady_step_allocates_nothing() {
  Row<double> row;
  const std::vector<std::pair<ModelId, ModelId>> pairs = {{0, 1}, {2, 1}};
  for (int step = 0; step < 6; ++step) {
    const std::size_t before = allocations;
    row.stage.setPositions(0, row.surfaces[0].x);
    row.detect(pairs);
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
  a_steady_step_allocates_nothing();
  models_come_and_go_and_mistakes_are_named();
  return check_result();
}
