// SPDX-License-Identifier: MIT OR Apache-2.0
// One step of the method around any ray tracer: everything but the tracing is the same code for all peers.
#pragma once

#include "pairs.hpp"
#include "workers.hpp"

namespace bench {

constexpr uint32_t no_triangle = 0xffffffffu;

/// A ray and its hit, laid out as the RTCRayHit of Embree 4, which ends with one number more than Embree 3's, so that
/// no peer has to convert more than it must.
struct alignas(16) RayHit {
  float origin[3], t_min;
  float direction[3], time;
  float t_max;  // where it ends; after tracing where it hits
  uint32_t mask;
  uint32_t vertex;  // of the colliding body
  uint32_t flags;
  float normal[3];  // of the triangle hit, any length
  float u, v;
  uint32_t triangle;  // hit, or no_triangle
  uint32_t geometry, instance, part_of_instance;
};

/// A peer's search structure over one body.
class Structure {
 public:
  virtual ~Structure() = default;
  /// Follows the body to its new positions.
  virtual void update() = 0;
  /// Finds the nearest hit of each ray.
  virtual void nearest(RayHit* rays, size_t count) = 0;
  /// Sets t_max below zero where a ray meets a triangle before its t_max that does not touch `vertex`.
  virtual void occluded(RayHit* rays, size_t count) = 0;
};

class RayStep : public Peer {
 public:
  RayStep(const Bodies& bodies, std::vector<std::unique_ptr<Structure>> structures, unsigned threads);
  bool step(Stages& stages) override;

 private:
  // Some vertices of one direction of a pair.
  struct Task {
    uint32_t colliding, collided, first, last;
    const Box<float>* overlap;
  };
  struct alignas(64) Worker {
    std::vector<RayHit> rays;
    std::vector<Contact> contacts, candidates;
    Stages stages;
  };

  void find_tasks();
  void run(const Task& task, Worker& worker) const;
  size_t cast(const Task& task, Worker& worker) const;
  size_t keep_exits(const Task& task, Worker& worker, size_t count) const;

  Bodies bodies_;
  std::vector<std::unique_ptr<Structure>> structures_;
  std::vector<Rings> rings_;
  Pairs pairs_;
  std::vector<Task> tasks_;
  std::vector<Worker> workers_;
  Workers threads_;
};

}  // namespace bench
