// SPDX-License-Identifier: MIT OR Apache-2.0
// Rays against one body at rest with Embree: each by itself, or in streams. What is timed is tracing alone: the rays
// lie ready as Embree wants them, and are written over by their hits.
#include "embree.hpp"

namespace bench {
namespace {

class Rays {
 public:
  Rays(const Embree& embree, const std::string& instructions, bool refits, const BodyView& body)
      : embree_(embree), device_(new_device(embree, instructions)), scene_(embree.rtcNewScene(device_)) {
    embree_.rtcSetSceneFlags(scene_, RTCSceneFlags(RTC_SCENE_FLAG_ROBUST | (refits ? RTC_SCENE_FLAG_DYNAMIC : 0)));
    embree_.rtcSetSceneBuildQuality(scene_, refits ? RTC_BUILD_QUALITY_LOW : RTC_BUILD_QUALITY_MEDIUM);
    embree_.rtcReleaseGeometry(
        add_triangles(embree_, device_, scene_, body, refits ? RTC_BUILD_QUALITY_REFIT : RTC_BUILD_QUALITY_MEDIUM));
  }

  ~Rays() {
    embree_.rtcReleaseScene(scene_);
    embree_.rtcReleaseDevice(device_);
  }

  Rays(const Rays&) = delete;
  Rays& operator=(const Rays&) = delete;

  void trace(RayHit* rays, size_t count, Way way) const { embree_.intersect(scene_, rays, count, way); }

 private:
  const Embree& embree_;
  RTCDevice device_;
  RTCScene scene_;
};

}  // namespace
}  // namespace bench

using namespace bench;

// Without exceptions, so that their message is shown instead of Rust's that it cannot catch them.
extern "C" void* bench_rays_new(bool is_embree_4, const char* instructions, bool refits,
                                const BodyView* body) noexcept {
  return new Rays(is_embree_4 ? embree_4() : embree_3(), instructions, refits, *body);
}

extern "C" void bench_rays_trace(const void* rays, void* hits, size_t count, uint32_t way) {
  static_cast<const Rays*>(rays)->trace(static_cast<RayHit*>(hits), count, Way(way));
}

extern "C" void bench_rays_free(void* rays) { delete static_cast<Rays*>(rays); }
