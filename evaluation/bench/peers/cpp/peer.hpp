// SPDX-License-Identifier: MIT OR Apache-2.0
// What the measuring program sees of a peer: made once for some bodies, then asked for the contacts of each step.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace bench {

/// One body in the host's arrays. The addresses stay, the positions are rewritten before each step.
/// Sixteen bytes behind each array of positions may be read.
struct BodyView {
  const float* positions;          // xyz, xyz, ...
  const double* double_positions;  // the same positions
  const uint32_t* triangles;
  uint32_t vertex_count;
  uint32_t triangle_count;
  uint32_t rows;  // vertex (i, j) of the torus is i * columns + j
  uint32_t columns;
};

/// Microseconds of a step, by stage.
struct Stages {
  double normals = 0;
  double structure = 0;
  double trace = 0;
  double filter = 0;
};

struct Contact {
  uint32_t colliding, collided, vertex, triangle;
  float depth, cos_alpha, u, v;
  float p2[3], direction[3];
};

class Peer {
 public:
  virtual ~Peer() = default;
  /// Does the whole step. Returns false where the method does not separate its stages.
  virtual bool step(Stages& stages) = 0;

  std::vector<Contact> contacts;
};

using Bodies = std::vector<BodyView>;

/// Null where there is no such method.
std::unique_ptr<Peer> make_lower_bound(const std::string& method, const Bodies& bodies);
std::unique_ptr<Peer> make_embree(const std::string& method, unsigned threads, const Bodies& bodies);
std::unique_ptr<Peer> make_fcl(const std::string& method, const Bodies& bodies);
std::unique_ptr<Peer> make_bullet(const std::string& method, const Bodies& bodies);
std::unique_ptr<Peer> make_rust(const std::string& method, unsigned threads, const Bodies& bodies);

}  // namespace bench
