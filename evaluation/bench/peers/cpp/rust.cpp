// SPDX-License-Identifier: MIT OR Apache-2.0
// Structures of Rust crates: see src/structure.rs.
#include "ray_step.hpp"

extern "C" {
// Null where there is no such method.
void* bench_structure_new(const char* method, const bench::BodyView* body);
void bench_structure_update(void* structure, const float* positions);
void bench_structure_nearest(const void* structure, bench::RayHit* rays, size_t count);
void bench_structure_occluded(const void* structure, bench::RayHit* rays, size_t count);
void bench_structure_free(void* structure);
}

namespace bench {
namespace {

class RustStructure : public Structure {
 public:
  RustStructure(void* structure, const float* positions) : structure_(structure), positions_(positions) {}
  ~RustStructure() override { bench_structure_free(structure_); }
  void update() override { bench_structure_update(structure_, positions_); }
  void nearest(RayHit* rays, size_t count) override { bench_structure_nearest(structure_, rays, count); }
  void occluded(RayHit* rays, size_t count) override { bench_structure_occluded(structure_, rays, count); }

 private:
  void* structure_;
  const float* positions_;
};

}  // namespace

std::unique_ptr<Peer> make_rust(const std::string& method, unsigned threads, const Bodies& bodies) {
  std::vector<std::unique_ptr<Structure>> structures;
  for (const auto& body : bodies) {
    void* structure = bench_structure_new(method.c_str(), &body);
    if (!structure) return nullptr;
    structures.push_back(std::make_unique<RustStructure>(structure, body.positions));
  }
  return std::make_unique<RayStep>(bodies, std::move(structures), threads);
}

}  // namespace bench
