// SPDX-License-Identifier: MIT OR Apache-2.0
// What both of Embree's programs need.
#pragma once
#include <embree3/rtcore.h>

#if defined(__SSE3__)
#include <pmmintrin.h>
#endif

#include <stdexcept>
#include <string>

#include "peer.hpp"

namespace bench {

// One thread inside Embree. `instructions`: of Embree's configuration, no better than these; "" for the processor's
// best.
inline RTCDevice new_device(const std::string& instructions) {
  const RTCDevice device = rtcNewDevice(("threads=1,set_affinity=0" + instructions).c_str());
  if (!device) throw std::runtime_error("Embree gives no device");
  return device;
}

// Puts the body's triangles into the scene, with the host's own arrays, and builds the tree. The geometry stays the
// caller's.
inline RTCGeometry add_triangles(RTCDevice device, RTCScene scene, const BodyView& body, RTCBuildQuality quality) {
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetGeometryBuildQuality(geometry, quality);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, body.positions, 0,
                             3 * sizeof(float), body.vertex_count);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, body.triangles, 0,
                             3 * sizeof(uint32_t), body.triangle_count);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcCommitScene(scene);
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
