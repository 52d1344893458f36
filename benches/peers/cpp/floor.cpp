// SPDX-License-Identifier: MIT OR Apache-2.0
// The floor under every method: one pass over the positions that computes all vertex normals and the boxes.
#include "surface.hpp"

namespace bench {
namespace {

const float* positions_of(const BodyView& body, float) { return body.positions; }
const double* positions_of(const BodyView& body, double) { return body.double_positions; }

template <typename T>
class Floor : public Peer {
 public:
  explicit Floor(const Bodies& bodies) : bodies_(bodies), boxes_(bodies.size()) {
    for (const auto& body : bodies) {
      rings_.emplace_back(body);
      normals_.emplace_back(body.vertex_count);
    }
  }

  bool step(Stages&) override {
    for (size_t index = 0; index < bodies_.size(); ++index) {
      const BodyView& body = bodies_[index];
      const T* positions = positions_of(body, T());
      Box<T> box{load(positions), load(positions)};
      Vector4<T>* normals = normals_[index].data();
      for (uint32_t v = 0; v < body.vertex_count; ++v) {
        const Vector4<T> p = load(positions + 3 * size_t(v));
        box = {lower(box.lower_corner, p), upper(box.upper_corner, p)};
        const Vector4<T> n = rings_[index].scaled_normal(positions, v);
        normals[v] = n / std::sqrt(dot<T>(n, n));
      }
      boxes_[index] = box;
    }
    return false;
  }

 private:
  Bodies bodies_;
  std::vector<Rings> rings_;
  std::vector<Box<T>> boxes_;
  std::vector<std::vector<Vector4<T>>> normals_;
};

}  // namespace

std::unique_ptr<Peer> make_floor(const std::string& method, const Bodies& bodies) {
  if (method == "floor") return std::make_unique<Floor<float>>(bodies);
  if (method == "floor-f64") return std::make_unique<Floor<double>>(bodies);
  return nullptr;
}

}  // namespace bench
