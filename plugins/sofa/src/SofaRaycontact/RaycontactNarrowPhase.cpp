// SPDX-License-Identifier: MIT OR Apache-2.0
#include <SofaRaycontact/RaycontactNarrowPhase.h>
#include <sofa/simulation/task/CpuTask.h>
#include <sofa/simulation/task/MainTaskSchedulerFactory.h>
#include <sofa/simulation/task/TaskScheduler.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace sofaraycontact {

using sofa::core::collision::DetectionOutput;
using sofa::core::objectmodel::BaseContext;
using Outputs = sofa::core::collision::TDetectionOutputVector<Triangles, Triangles>;

namespace {

bool areEqual(const TriangleList& a, const TriangleList& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const auto& p, const auto& q) { return p[0] == q[0] && p[1] == q[1] && p[2] == q[2]; });
}

}  // namespace

void SchedulerThreads::operator()(std::size_t count, const std::function<void(std::size_t)>& task) const {
  auto* scheduler = sofa::simulation::MainTaskSchedulerFactory::createInRegistry();
  if (scheduler->getThreadCount() < 1) scheduler->init();
  sofa::simulation::CpuTask::Status status;
  for (std::size_t index = 0; index < count; ++index) scheduler->addTask(status, [&task, index] { task(index); });
  scheduler->workUntilDone(&status);
}

RaycontactNarrowPhase::RaycontactNarrowPhase()
    : d_publishContacts(initData(&d_publishContacts, true, "publishContacts",
                                 "Give the contacts to SOFA's own contact manager, which makes the response. A "
                                 "RaycontactForceField with this narrow phase switches it off unless it is set.")),
      d_sampleSpacing(
          initData(&d_sampleSpacing, SReal(0), "sampleSpacing",
                   "Where rays start. 0: at the vertices. A length: about so far apart, in the middles of "
                   "faces. -1: as many as the accuracy needs, and where the load is; a RaycontactForceField "
                   "with friction takes that unless this is set.")),
      d_law(initData(&d_law, std::string("automatic"), "law",
                     "What forces grow with. rayLength: the way to where the ray leaves the other body. pressure: the "
                     "distance to the other body's surface. automatic: rayLength where contacts are published.")),
      d_edges(initData(&d_edges, true, "edges", "Trace edges where no ray settles whether bodies overlap.")),
      d_escape(initData(&d_escape, true, "escape",
                        "Lead bodies apart along one direction where their contacts cannot part them.")),
      d_pastFolds(initData(&d_pastFolds, false, "pastFolds",
                           "Rays go past other folds of either body. On by itself for models with selfCollision.")),
      d_accuracy(
          initData(&d_accuracy, SReal(0.01), "accuracy",
                   "With sampleSpacing -1: by which part a pair's net force may differ from the exact one, above 0 and "
                   "at most 1. Where forces grow with the length of rays, for open models and for a model with itself, "
                   "rays start in the middle of each triangle instead, larger ones being cut.")),
      d_singlePrecision(initData(&d_singlePrecision, false, "singlePrecision",
                                 "Look for contacts in single precision. Read when the models are first seen.")),
      d_parallel(initData(&d_parallel, false, "parallel",
                          "Share out the detection on the threads of SOFA's task scheduler. The results are the same, "
                          "bit by bit. Read when the models are first seen.")),
      d_contactCount(initData(&d_contactCount, 0u, "contactCount", "Contacts published in the last step.", true, true)),
      d_pairCount(
          initData(&d_pairCount, 0u, "pairCount", "Pairs of models that the broad phase let through.", true, true)) {}

void RaycontactNarrowPhase::init() {
  NarrowPhaseDetection::init();
  start();
}

/** The broad phase leaves empty models out without a word. */
void RaycontactNarrowPhase::bwdInit() {
  for (Triangles* model : getContext()->getRootContext()->getObjects<Triangles>(BaseContext::SearchDown))
    if (model->getCollisionTopology() == nullptr || model->getSize() == 0)
      msg_error() << model->getPathName()
                  << " has no triangles and does not collide: give its node a topology that has.";
}

void RaycontactNarrowPhase::reset() {
  NarrowPhaseDetection::reset();
  start();
}

/** Everything anew, so that a run after a reset is the first run again. */
void RaycontactNarrowPhase::start() {
  rayc_scene_options options = raycontact::default_scene_options();
  options.precision = precision();
  if (d_parallel.getValue()) raycontact::lend_threads(options, threads_);
  stage_ = std::make_unique<Stage>(options);
  surfaces_.clear();
  refused_.clear();
  ill_.clear();
  pairs_.clear();
  ++generation_;
  has_run_ = false;
  setDetectionOptions();
}

void RaycontactNarrowPhase::setDetectionOptions() {
  rayc_detection_options options = raycontact::default_detection_options();
  const double spacing = d_sampleSpacing.getValue();
  options.sampling = spacing > 0    ? RAYC_SAMPLING_SPACING
                     : spacing == 0 ? RAYC_SAMPLING_VERTICES
                                    : RAYC_SAMPLING_ACCURACY;
  options.sampling_value = spacing < 0 ? d_accuracy.getValue() : spacing;
  options.edges = d_edges.getValue();
  options.escape = d_escape.getValue();
  options.past_folds = d_pastFolds.getValue();
  const std::string& law = d_law.getValue();
  const bool grows_with_rays = law == "rayLength" || (law != "pressure" && d_publishContacts.getValue());
  options.law = grows_with_rays ? RAYC_LAW_RAY_LENGTH : RAYC_LAW_PRESSURE;
  if (law != "automatic" && law != "rayLength" && law != "pressure")
    msg_error() << "law: \"" << law << "\" is none; it is automatic, pressure or rayLength.";
  try {
    stage_->setDetectionOptions(options);
  } catch (const raycontact::Error& error) {
    msg_error() << error.what() << " The options stay as they were.";
  }
}

void RaycontactNarrowPhase::beginNarrowPhase() {
  NarrowPhaseDetection::beginNarrowPhase();
  if (hasChanged()) start();
  pairs_.clear();
  setDetectionOptions();
  stage_->beginNarrowPhase();
}

bool RaycontactNarrowPhase::hasChanged() const {
  for (raycontact::ModelId number = 0; number < surfaces_.size(); ++number) {
    const Surface& surface = surfaces_[number];
    auto* topology = surface.model->getCollisionTopology();
    if (topology == nullptr || topology->getRevision() != surface.revision ||
        surface.state->getSize() != stage_->vertexCount(number) ||
        !areEqual(surface.model->getTriangles(), surface.triangles))
      return true;
  }
  return false;
}

void RaycontactNarrowPhase::addCollisionPair(const std::pair<CollisionModel*, CollisionModel*>& pair) {
  auto* first = dynamic_cast<Triangles*>(pair.first->getLast());
  auto* second = dynamic_cast<Triangles*>(pair.second->getLast());
  // Spheres, lines and points are other narrow phases' work.
  if (first == nullptr || second == nullptr) return;
  if (isRefused(first) || isRefused(second)) return;
  try {
    const raycontact::ModelId a = number(first), b = number(second);
    stage_->addCollisionPair({a, b});
    pairs_.push_back({first, second});
  } catch (const raycontact::Error&) {
    // refuse() has told.
  }
}

raycontact::ModelId RaycontactNarrowPhase::number(Triangles* model) {
  const auto known = std::find_if(surfaces_.begin(), surfaces_.end(),
                                  [model](const Surface& surface) { return surface.model.get() == model; });
  return known != surfaces_.end() ? static_cast<raycontact::ModelId>(known - surfaces_.begin()) : add(model);
}

raycontact::ModelId RaycontactNarrowPhase::add(Triangles* model) {
  rayc_mesh_options options = raycontact::default_mesh_options();
  options.precision = precision();
  const auto add = [&] {
    const raycontact::ModelId number = stage_->addCollisionModel(model->getX(), model->getTriangles(), options);
    surfaces_.push_back({model, model->getMechanicalState(), model->getCollisionTopology()->getRevision(),
                         options.open != 0, model->getTriangles()});
    return number;
  };
  try {
    try {
      return add();
    } catch (const raycontact::Error& error) {
      if (error.status() != RAYC_STATUS_MESH_OPEN) throw;
      options.open = 1;
      const raycontact::ModelId number = add();
      msg_info() << model->getPathName()
                 << " is an open surface, taken for an obstacle that is solid behind its triangles.";
      if (model->isSimulated() && model->isMoving())
        msg_warning()
            << model->getPathName() << " is an open surface that moves. Two open surfaces do not collide, and "
            << "what is more than half behind one is not pushed out. Close it, or set simulated and moving to 0.";
      return number;
    }
  } catch (const raycontact::Error& error) {
    refuse(model, error.what());
    throw;
  }
}

bool RaycontactNarrowPhase::isRefused(Triangles* model) const {
  auto* topology = model->getCollisionTopology();
  return refused_.count({model, topology != nullptr ? topology->getRevision() : -1}) > 0;
}

void RaycontactNarrowPhase::refuse(Triangles* model, const std::string& why) {
  auto* topology = model->getCollisionTopology();
  refused_.insert({model, topology != nullptr ? topology->getRevision() : -1});
  msg_error() << model->getPathName() << " does not collide: " << why;
}

void RaycontactNarrowPhase::place(raycontact::ModelId number) {
  try {
    stage_->setPositions(number, surfaces_[number].model->getX());
    ill_.erase(number);
  } catch (const raycontact::Error& error) {
    if (ill_.insert(number).second)
      msg_error() << surfaces_[number].model->getPathName() << " stays where it was: " << error.what();
  }
}

void RaycontactNarrowPhase::endNarrowPhase() {
  has_run_ = true;
  d_pairCount.setValue(static_cast<unsigned>(pairs_.size()));
  if (d_publishContacts.getValue()) {
    for (raycontact::ModelId number = 0; number < surfaces_.size(); ++number)
      if (surfaces_[number].model->isMoving() || surfaces_[number].model->isSimulated()) place(number);
    try {
      stage_->endNarrowPhase();
      publish();
    } catch (const raycontact::Error& error) {
      msg_error() << error.what();
    }
  } else {
    stage_->chooseCollisionPairs();
  }
  NarrowPhaseDetection::endNarrowPhase();
}

void RaycontactNarrowPhase::publish() {
  for (const auto& [first, second] : pairs_) {
    const auto& found = stage_->getDetectionOutputs({number(first), number(second)});
    auto*& place = getDetectionOutputs(first, second);
    if (place == nullptr) place = new Outputs;
    auto& outputs = *static_cast<Outputs*>(place);
    outputs.resize(found.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      DetectionOutput& output = outputs[i];
      output.elem = {{first, static_cast<sofa::Index>(found[i].elem.first.index)},
                     {second, static_cast<sofa::Index>(found[i].elem.second.index)}};
      output.id = found[i].id;
      output.point[0] = found[i].point[0];
      output.point[1] = found[i].point[1];
      output.normal = found[i].normal;
      output.value = found[i].value;
    }
  }
  d_contactCount.setValue(static_cast<unsigned>(stage_->contacts().size()));
}

}  // namespace sofaraycontact
