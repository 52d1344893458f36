// SPDX-License-Identifier: MIT OR Apache-2.0
// The broad phase all peers share: boxes of the bodies, and the pairs that overlap.
#pragma once

#include <algorithm>

#include "surface.hpp"

namespace bench {

class Pairs {
 public:
  struct Pair {
    uint32_t bodies[2];
    Box<float> overlap;
  };

  explicit Pairs(const Bodies& bodies) : bodies_(bodies), boxes_(bodies.size()), order_(bodies.size()) {
    for (uint32_t body = 0; body < bodies.size(); ++body) order_[body] = body;
  }

  void find_box(size_t body) { boxes_[body] = box_of(bodies_[body].positions, bodies_[body].vertex_count); }

  /// Sweeps along z, the axis along which the workloads are longest.
  void find_pairs() {
    std::sort(order_.begin(), order_.end(),
              [&](uint32_t a, uint32_t b) { return boxes_[a].lower_corner[2] < boxes_[b].lower_corner[2]; });
    pairs_.clear();
    touched_.clear();
    for (size_t place = 0; place < order_.size(); ++place) {
      const uint32_t a = order_[place];
      for (size_t later = place + 1; later < order_.size(); ++later) {
        const uint32_t b = order_[later];
        if (boxes_[b].lower_corner[2] > boxes_[a].upper_corner[2]) break;
        const Box<float> overlap = boxes_[a].intersection(boxes_[b]);
        if (overlap.is_empty()) continue;
        pairs_.push_back({{a, b}, overlap});
        touched_.insert(touched_.end(), {a, b});
      }
    }
    std::sort(touched_.begin(), touched_.end());
    touched_.erase(std::unique(touched_.begin(), touched_.end()), touched_.end());
  }

  const std::vector<Pair>& pairs() const { return pairs_; }
  /// The bodies that belong to any pair.
  const std::vector<uint32_t>& touched() const { return touched_; }

 private:
  Bodies bodies_;
  std::vector<Box<float>> boxes_;
  std::vector<uint32_t> order_, touched_;
  std::vector<Pair> pairs_;
};

}  // namespace bench
