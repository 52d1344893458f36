// SPDX-License-Identifier: MIT OR Apache-2.0
#include "ray_step.hpp"

#include <algorithm>

#include "clock.hpp"

namespace bench {
namespace {

constexpr uint32_t vertices_per_task = 2048;

// Where a ray leaves the overlap box, a little widened against rounding.
inline float end_of_ray(const Box<float>& overlap, Vector4<float> origin, Vector4<float> direction) {
  const Vector4<float> below = overlap.lower_corner - origin;
  const Vector4<float> above = overlap.upper_corner - origin;
  const Vector4<float> reach = upper(-below, above);
  const float margin = std::max({reach[0], reach[1], reach[2]}) * (64 * 5.96e-8f);
  const Vector4<float> bound = direction > 0 ? above + margin : below - margin;
  const Vector4<float> infinite = Vector4<float>{} + std::numeric_limits<float>::infinity();
  const Vector4<float> end = direction == 0 ? infinite : bound / direction;
  return std::min({end[0], end[1], end[2]});
}

}  // namespace

RayStep::RayStep(const Bodies& bodies, std::vector<std::unique_ptr<Structure>> structures, unsigned threads)
    : bodies_(bodies), structures_(std::move(structures)), pairs_(bodies), workers_(threads), threads_(threads) {
  for (const auto& body : bodies) rings_.emplace_back(body);
  for (auto& worker : workers_) worker.rays.resize(vertices_per_task);
}

bool RayStep::step(Stages& stages) {
  Clock clock;
  threads_.for_each(bodies_.size(), [&](size_t body, unsigned) { pairs_.find_box(body); });
  pairs_.find_pairs();
  find_tasks();
  stages.normals = clock.lap();

  const auto& touched = pairs_.touched();
  threads_.for_each(touched.size(), [&](size_t place, unsigned) { structures_[touched[place]]->update(); });
  stages.structure = clock.lap();

  threads_.for_each(tasks_.size(), [&](size_t task, unsigned worker) { run(tasks_[task], workers_[worker]); });
  contacts.clear();
  for (auto& worker : workers_) {
    contacts.insert(contacts.end(), worker.contacts.begin(), worker.contacts.end());
    stages.normals += worker.stages.normals;
    stages.trace += worker.stages.trace;
    stages.filter += worker.stages.filter;
    worker.contacts.clear();
    worker.stages = {};
  }
  return workers_.size() == 1;
}

void RayStep::find_tasks() {
  tasks_.clear();
  for (const auto& pair : pairs_.pairs()) {
    for (int direction = 0; direction < 2; ++direction) {
      const uint32_t colliding = pair.bodies[direction], collided = pair.bodies[1 - direction];
      const uint32_t count = bodies_[colliding].vertex_count;
      for (uint32_t first = 0; first < count; first += vertices_per_task) {
        tasks_.push_back({colliding, collided, first, std::min(first + vertices_per_task, count), &pair.overlap});
      }
    }
  }
}

void RayStep::run(const Task& task, Worker& worker) const {
  Clock clock;
  const size_t cast_count = cast(task, worker);
  worker.stages.normals += clock.lap();
  structures_[task.collided]->nearest(worker.rays.data(), cast_count);
  worker.stages.trace += clock.lap();

  const size_t exits = keep_exits(task, worker, cast_count);
  structures_[task.colliding]->occluded(worker.rays.data(), exits);
  for (size_t i = 0; i < exits; ++i) {
    if (worker.rays[i].t_max >= 0) worker.contacts.push_back(worker.candidates[i]);
  }
  worker.stages.filter += clock.lap();
}

size_t RayStep::cast(const Task& task, Worker& worker) const {
  const float* positions = bodies_[task.colliding].positions;
  const Rings& rings = rings_[task.colliding];
  const Box<float> overlap = *task.overlap;
  RayHit* rays = worker.rays.data();
  size_t count = 0;
  for (uint32_t v = task.first; v < task.last; ++v) {
    rays[count].vertex = v;
    count += overlap.contains(load(positions + 3 * size_t(v)));
    // The last place may be overwritten by every later vertex, so it must exist.
    if (count == vertices_per_task) break;
  }
  for (size_t i = 0; i < count; ++i) {
    RayHit& ray = rays[i];
    const Vector4<float> origin = load(positions + 3 * size_t(ray.vertex));
    const Vector4<float> normal = rings.scaled_normal(positions, ray.vertex);
    const Vector4<float> direction = normal / -std::sqrt(dot<float>(normal, normal));
    const float end = end_of_ray(overlap, origin, direction);
    std::memcpy(ray.origin, &origin, sizeof ray.origin);
    std::memcpy(ray.direction, &direction, sizeof ray.direction);
    ray.t_min = 0;
    ray.time = 0;
    ray.t_max = end;
    ray.mask = ~0u;
    ray.flags = 0;
    ray.triangle = ray.geometry = ray.instance = no_triangle;
  }
  return count;
}

size_t RayStep::keep_exits(const Task& task, Worker& worker, size_t count) const {
  worker.candidates.resize(count);
  size_t exits = 0;
  for (size_t i = 0; i < count; ++i) {
    const RayHit& ray = worker.rays[i];
    if (ray.triangle == no_triangle) continue;
    const float* d = ray.direction;
    const float* n = ray.normal;
    const float along = d[0] * n[0] + d[1] * n[1] + d[2] * n[2];
    if (!(along > 0)) continue;
    Contact& contact = worker.candidates[exits];
    contact.colliding = task.colliding;
    contact.collided = task.collided;
    contact.vertex = ray.vertex;
    contact.triangle = ray.triangle;
    contact.depth = ray.t_max;
    contact.cos_alpha = along / std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    contact.u = ray.u;
    contact.v = ray.v;
    for (int axis = 0; axis < 3; ++axis) {
      contact.direction[axis] = d[axis];
      contact.p2[axis] = ray.origin[axis] + ray.t_max * d[axis];
    }
    worker.rays[exits++] = ray;
  }
  return exits;
}

}  // namespace bench
