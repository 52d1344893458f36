// SPDX-License-Identifier: MIT OR Apache-2.0
// What no method can do without, the lower bound of their times: one pass over the positions that computes all vertex
// normals and the boxes. It knows that the bodies are grids bent into tori, which no method may, and so needs no index
// and no gather.
#include <algorithm>

#include "surface.hpp"

namespace bench {
namespace {

const float* positions_of(const BodyView& body, float) { return body.positions; }
const double* positions_of(const BodyView& body, double) { return body.double_positions; }

/// One register of the widest kind, loaded from anywhere.
template <typename T>
struct Wide {
  typedef T Vector __attribute__((vector_size(64)));
  static constexpr size_t lanes = sizeof(Vector) / sizeof(T);

  static Vector load(const T* from) {
    Vector v;
    std::memcpy(&v, from, sizeof v);
    return v;
  }
  static void store(T* to, Vector v) { std::memcpy(to, &v, sizeof v); }
  static Vector root(Vector v) {
    T parts[lanes];
    store(parts, v);
    for (auto& part : parts) part = std::sqrt(part);
    return load(parts);
  }
};

/// One coordinate of all vertices, row after row; each row, and the whole, framed by what lies on its other side.
template <typename T>
using Coordinate = std::vector<T>;

template <typename T>
struct Torus {
  using W = Wide<T>;
  using Vector = typename W::Vector;

  explicit Torus(const BodyView& view) : body(view), pitch(view.columns + 2) {
    for (auto& coordinate : coordinates) coordinate.resize((view.rows + 2) * pitch + W::lanes);
    for (auto& normal : normals) normal.resize((view.rows + 2) * pitch + W::lanes);
  }

  void read(T lower_corner[3], T upper_corner[3]) {
    const T* positions = positions_of(body, T());
    const size_t columns = body.columns;
    T* x = coordinates[0].data() + pitch + 1;
    T* y = coordinates[1].data() + pitch + 1;
    T* z = coordinates[2].data() + pitch + 1;
    for (size_t row = 0; row < body.rows; ++row) {
      for (size_t j = 0; j < columns; ++j) {
        x[j] = positions[3 * j];
        y[j] = positions[3 * j + 1];
        z[j] = positions[3 * j + 2];
      }
      for (T* c : {x, y, z}) {
        c[-1] = c[columns - 1];
        c[columns] = c[0];
      }
      positions += 3 * columns;
      x += pitch;
      y += pitch;
      z += pitch;
    }
    for (int axis = 0; axis < 3; ++axis) {
      T* all = coordinates[axis].data();
      std::copy_n(all + body.rows * pitch, pitch, all);
      std::copy_n(all + pitch, pitch, all + (body.rows + 1) * pitch);
      bounds(all + pitch, body.rows * pitch, lower_corner[axis], upper_corner[axis]);
    }
  }

  void find_normals() {
    const size_t end = (body.rows + 1) * pitch;
    // The last register may write behind the frame.
    for (size_t i = pitch; i < end; i += W::lanes) {
      Vector sum[3], d[3][4];
      // The ring around a vertex; the area vector of its hexagon is that of two quads, each half the product of its
      // diagonals.
      for (int axis = 0; axis < 3; ++axis) {
        const T* c = coordinates[axis].data() + i;
        const Vector first = W::load(c + pitch), fourth = W::load(c - pitch);
        d[axis][0] = W::load(c + 1) - first;
        d[axis][1] = fourth - W::load(c + pitch + 1);
        d[axis][2] = W::load(c - pitch - 1) - first;
        d[axis][3] = W::load(c - 1) - fourth;
      }
      for (int axis = 0; axis < 3; ++axis) {
        const auto &p = d[(axis + 1) % 3], &q = d[(axis + 2) % 3];
        sum[axis] = p[0] * q[1] - q[0] * p[1] + p[2] * q[3] - q[2] * p[3];
      }
      const Vector length = W::root(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
      const Vector scale = 1 / length;
      for (int axis = 0; axis < 3; ++axis) W::store(normals[axis].data() + i, sum[axis] * scale);
    }
  }

  static void bounds(const T* values, size_t count, T& smallest, T& largest) {
    Vector low = W::load(values), high = low;
    // The last registers may repeat some values.
    for (size_t i = 0; i < count; i += W::lanes) {
      const Vector v = W::load(values + std::min(i, count - W::lanes));
      low = lower(low, v);
      high = upper(high, v);
    }
    smallest = low[0];
    largest = high[0];
    for (size_t k = 1; k < W::lanes; ++k) {
      smallest = lower(smallest, low[k]);
      largest = upper(largest, high[k]);
    }
  }

  BodyView body;
  size_t pitch;
  Coordinate<T> coordinates[3], normals[3];
};

template <typename T>
class LowerBound : public Peer {
 public:
  explicit LowerBound(const Bodies& bodies) : boxes_(bodies.size()), tori_(bodies.begin(), bodies.end()) {}

  bool step(Stages&) override {
    for (size_t index = 0; index < tori_.size(); ++index) {
      tori_[index].read(boxes_[index].lower_corner, boxes_[index].upper_corner);
      tori_[index].find_normals();
    }
    return false;
  }

 private:
  struct Corners {
    T lower_corner[3], upper_corner[3];
  };
  std::vector<Corners> boxes_;
  std::vector<Torus<T>> tori_;
};

}  // namespace

std::unique_ptr<Peer> make_lower_bound(const std::string& method, const Bodies& bodies) {
  if (method == "lower-bound") return std::make_unique<LowerBound<float>>(bodies);
  if (method == "lower-bound-f64") return std::make_unique<LowerBound<double>>(bodies);
  return nullptr;
}

}  // namespace bench
