// SPDX-License-Identifier: MIT OR Apache-2.0
// The narrow phase of a collision pipeline.
#pragma once

#include <SofaRaycontact/config.h>
#include <sofa/component/collision/geometry/TriangleCollisionModel.h>
#include <sofa/core/behavior/MechanicalState.h>
#include <sofa/core/collision/NarrowPhaseDetection.h>
#include <sofa/defaulttype/VecTypes.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <raycontact/sofa.hpp>
#include <set>
#include <utility>
#include <vector>

namespace sofaraycontact {

using DataTypes = sofa::defaulttype::Vec3Types;
using Triangles = sofa::component::collision::geometry::TriangleCollisionModel<DataTypes>;
using TriangleList = sofa::core::topology::BaseMeshTopology::SeqTriangles;
using State = sofa::core::behavior::MechanicalState<DataTypes>;

/** A collision model that the stage knows; its place in the list is its number there. */
struct Surface {
  Triangles::SPtr model;
  State::SPtr state;
  int revision;  ///< of its topology
  bool is_open;
  TriangleList triangles;  ///< not every change of them raises the revision
};

/** Shares out work on the threads of SOFA's task scheduler. */
struct SchedulerThreads {
  void operator()(std::size_t count, const std::function<void(std::size_t)>& task) const;
};

class SOFARAYCONTACT_API RaycontactNarrowPhase : public sofa::core::collision::NarrowPhaseDetection {
 public:
  SOFA_CLASS(RaycontactNarrowPhase, sofa::core::collision::NarrowPhaseDetection);

  using Stage = raycontact::CollisionStage<DataTypes>;
  using CollisionModel = sofa::core::CollisionModel;

  sofa::Data<bool> d_publishContacts;
  sofa::Data<SReal> d_sampleSpacing;
  sofa::Data<std::string> d_law;
  sofa::Data<bool> d_edges;
  sofa::Data<bool> d_escape;
  sofa::Data<bool> d_pastFolds;
  sofa::Data<SReal> d_accuracy;
  sofa::Data<bool> d_singlePrecision;
  sofa::Data<bool> d_parallel;
  sofa::Data<unsigned> d_contactCount;
  sofa::Data<unsigned> d_pairCount;

  void init() override;
  void bwdInit() override;
  void reset() override;

  /** Boxes of whole models are all that rays need. */
  bool needsDeepBoundingTree() const override { return false; }
  void beginNarrowPhase() override;
  void addCollisionPair(const std::pair<CollisionModel*, CollisionModel*>& pair) override;
  void endNarrowPhase() override;

  /** What the force field works with. */
  Stage& stage() { return *stage_; }
  const std::vector<Surface>& surfaces() const { return surfaces_; }

  /** Another number after each time that all surfaces were made anew. */
  unsigned generation() const { return generation_; }

  /** Whether the pipeline has run since the surfaces were made anew. */
  bool hasRun() const { return has_run_; }
  uint32_t precision() const { return d_singlePrecision.getValue() ? RAYC_SCALAR_F32 : RAYC_SCALAR_F64; }

 protected:
  RaycontactNarrowPhase();

 private:
  void start();
  void setDetectionOptions();
  bool hasChanged() const;
  raycontact::ModelId add(Triangles* model);
  raycontact::ModelId number(Triangles* model);
  bool isRefused(Triangles* model) const;
  void refuse(Triangles* model, const std::string& why);
  void place(raycontact::ModelId number);
  void publish();

  SchedulerThreads threads_;
  std::unique_ptr<Stage> stage_;
  std::vector<Surface> surfaces_;
  /** With the revision of its topology that was refused. */
  std::set<std::pair<const Triangles*, int>> refused_;
  /** Those that have been complained of, until they are well again. */
  std::set<raycontact::ModelId> ill_;
  std::vector<std::pair<Triangles*, Triangles*>> pairs_;
  unsigned generation_ = 0;
  bool has_run_ = false;
};

}  // namespace sofaraycontact
