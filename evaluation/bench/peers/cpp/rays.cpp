// SPDX-License-Identifier: MIT OR Apache-2.0
// Rays against one body at rest with Embree 3.13: each by itself, or in streams. What is timed is tracing alone: the
// rays lie ready as Embree wants them, and are written over by their hits.
#include <string>

#include "embree.hpp"

namespace bench {
namespace {

enum class Way : uint32_t { single, coherent_stream, incoherent_stream };

class Rays {
 public:
  Rays(const std::string& instructions, bool refits, const BodyView& body)
      : device_(new_device(instructions)), scene_(rtcNewScene(device_)) {
    rtcSetSceneFlags(scene_, RTCSceneFlags(RTC_SCENE_FLAG_ROBUST | (refits ? RTC_SCENE_FLAG_DYNAMIC : 0)));
    rtcSetSceneBuildQuality(scene_, refits ? RTC_BUILD_QUALITY_LOW : RTC_BUILD_QUALITY_MEDIUM);
    rtcReleaseGeometry(
        add_triangles(device_, scene_, body, refits ? RTC_BUILD_QUALITY_REFIT : RTC_BUILD_QUALITY_MEDIUM));
  }

  ~Rays() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }

  Rays(const Rays&) = delete;
  Rays& operator=(const Rays&) = delete;

  void trace(RTCRayHit* rays, size_t count, Way way) const {
    const FlushDenormals scope;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    if (way == Way::coherent_stream) context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    if (way == Way::single) {
      for (size_t i = 0; i < count; ++i) rtcIntersect1(scene_, &context, rays + i);
    } else {
      rtcIntersect1M(scene_, &context, rays, unsigned(count), sizeof(RTCRayHit));
    }
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
