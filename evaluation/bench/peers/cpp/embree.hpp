// SPDX-License-Identifier: MIT OR Apache-2.0
// What both of Embree's programs need, from Embree 3.13 and from Embree 4.
#pragma once
#if defined(__SSE3__)
#include <pmmintrin.h>
#endif

#include "embree_library.hpp"
#include "ray_step.hpp"

namespace bench {

/// How rays are handed over. Embree 4 has no streams: there they go one by one.
enum class Way : uint32_t { single, coherent_stream, incoherent_stream };

/// One version's library, and how it traces.
class Embree : public EmbreeLibrary {
 public:
  using EmbreeLibrary::EmbreeLibrary;
  virtual ~Embree() = default;

  /// Finds the nearest hit of each ray.
  virtual void intersect(RTCScene scene, RayHit* rays, size_t count, Way way) const = 0;
  /// Sets t_max below zero where a ray meets one of the scene's triangles that does not touch its vertex.
  virtual void occluded(RTCScene scene, RayHit* rays, size_t count, const uint32_t* triangles) const = 0;
};

const Embree& embree_3();
const Embree& embree_4();

// One thread inside Embree. `instructions`: of Embree's configuration, no better than these; "" for the processor's
// best.
inline RTCDevice new_device(const Embree& embree, const std::string& instructions) {
  const RTCDevice device = embree.rtcNewDevice(("threads=1,set_affinity=0" + instructions).c_str());
  if (!device) throw std::runtime_error("Embree gives no device");
  return device;
}

// Puts the body's triangles into the scene, with the host's own arrays, and builds the tree. The geometry stays the
// caller's.
inline RTCGeometry add_triangles(const Embree& embree, RTCDevice device, RTCScene scene, const BodyView& body,
                                 RTCBuildQuality quality) {
  const RTCGeometry geometry = embree.rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  embree.rtcSetGeometryBuildQuality(geometry, quality);
  embree.rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, body.positions, 0,
                                    3 * sizeof(float), body.vertex_count);
  embree.rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, body.triangles, 0,
                                    3 * sizeof(uint32_t), body.triangle_count);
  embree.rtcCommitGeometry(geometry);
  embree.rtcAttachGeometry(scene, geometry);
  embree.rtcCommitScene(scene);
  return geometry;
}

// What Embree asks of threads that trace.
class FlushDenormals {
#if defined(__SSE3__)
 public:
  FlushDenormals() : before_(_mm_getcsr()) { _mm_setcsr(before_ | _MM_FLUSH_ZERO_ON | _MM_DENORMALS_ZERO_ON); }
  ~FlushDenormals() { _mm_setcsr(before_); }

 private:
  unsigned before_;
#endif
};

}  // namespace bench
