// SPDX-License-Identifier: MIT OR Apache-2.0
// Rays against one body at rest with Embree 3.13: each by itself, or in streams. What is timed is tracing alone: the
// rays lie ready as Embree wants them, and are written over by their hits.
#include <embree3/rtcore.h>

#if defined(__SSE3__)
#include <pmmintrin.h>
#endif

#include <cstdio>
#include <string>

#include "peer.hpp"
#include "ray_step.hpp"

namespace bench {
namespace {

enum class Way : uint32_t { single, coherent_stream, incoherent_stream };

class Rays {
 public:
  Rays(const std::string& instructions, bool refits, const BodyView& body)
      : device_(rtcNewDevice(("threads=1,set_affinity=0" + instructions).c_str())), scene_(rtcNewScene(device_)) {
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSceneFlags(scene_, RTCSceneFlags(RTC_SCENE_FLAG_ROBUST | (refits ? RTC_SCENE_FLAG_DYNAMIC : 0)));
    rtcSetSceneBuildQuality(scene_, refits ? RTC_BUILD_QUALITY_LOW : RTC_BUILD_QUALITY_MEDIUM);
    rtcSetGeometryBuildQuality(geometry, refits ? RTC_BUILD_QUALITY_REFIT : RTC_BUILD_QUALITY_MEDIUM);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, body.positions, 0,
                               3 * sizeof(float), body.vertex_count);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, body.triangles, 0,
                               3 * sizeof(uint32_t), body.triangle_count);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
  }

  ~Rays() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }

  Rays(const Rays&) = delete;
  Rays& operator=(const Rays&) = delete;

  void trace(RTCRayHit* rays, size_t count, Way way) const {
#if defined(__SSE3__)
    // What Embree asks of threads that trace.
    const unsigned before = _mm_getcsr();
    _mm_setcsr(before | _MM_FLUSH_ZERO_ON | _MM_DENORMALS_ZERO_ON);
#endif
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    if (way == Way::coherent_stream) context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    if (way == Way::single) {
      for (size_t i = 0; i < count; ++i) rtcIntersect1(scene_, &context, rays + i);
    } else {
      rtcIntersect1M(scene_, &context, rays, unsigned(count), sizeof(RTCRayHit));
    }
#if defined(__SSE3__)
    _mm_setcsr(before);
#endif
  }

 private:
  RTCDevice device_;
  RTCScene scene_;
};

}  // namespace
}  // namespace bench

using bench::Rays;

extern "C" void* bench_rays_new(const char* instructions, bool refits, const bench::BodyView* body) {
  return new Rays(instructions, refits, *body);
}

extern "C" void bench_rays_trace(const void* rays, void* hits, size_t count, uint32_t way) {
  static_cast<const Rays*>(rays)->trace(static_cast<RTCRayHit*>(hits), count, bench::Way(way));
}

extern "C" void bench_rays_free(void* rays) { delete static_cast<Rays*>(rays); }
