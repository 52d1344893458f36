// SPDX-License-Identifier: MIT OR Apache-2.0
// One scene per body, sharing the host's arrays. With Embree 3.13 rays in streams, marked as incoherent: single rays,
// packets and coherent streams were no faster on any workload tried. With Embree 4 single rays.
#include "embree.hpp"

#include <map>

namespace bench {
namespace {

class EmbreeStructure : public Structure {
 public:
  EmbreeStructure(const Embree& embree, RTCDevice device, const BodyView& body, RTCBuildQuality quality)
      : embree_(embree), body_(body), scene_(embree.rtcNewScene(device)) {
    // Only a dynamic scene keeps one tree per geometry, which alone can be refitted.
    embree_.rtcSetSceneFlags(scene_,
                             RTC_SCENE_FLAG_DYNAMIC | RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
    embree_.rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_LOW);
    geometry_ = add_triangles(embree_, device, scene_, body, quality);
    const Box<float> box = box_of(body.positions, body.vertex_count);
    t_min_ = 1e-6f * (box.upper_corner - box.lower_corner)[0];
  }

  ~EmbreeStructure() override {
    embree_.rtcReleaseGeometry(geometry_);
    embree_.rtcReleaseScene(scene_);
  }

  void update() override {
    embree_.rtcUpdateGeometryBuffer(geometry_, RTC_BUFFER_TYPE_VERTEX, 0);
    embree_.rtcCommitGeometry(geometry_);
    embree_.rtcCommitScene(scene_);
  }

  void nearest(RayHit* rays, size_t count) override { embree_.intersect(scene_, rays, count, Way::incoherent_stream); }

  void occluded(RayHit* rays, size_t count) override {
    // Touched triangles are met at rounding's distance from 0, nearly always below this, and then need no call of the
    // filter: that makes the test twice as fast.
    for (size_t i = 0; i < count; ++i) rays[i].t_min = t_min_;
    embree_.occluded(scene_, rays, count, body_.triangles);
  }

 private:
  const Embree& embree_;
  BodyView body_;
  RTCScene scene_;
  RTCGeometry geometry_;
  float t_min_ = 0;
};

struct Settings {
  const Embree& (*embree)();
  RTCBuildQuality quality;
  // Of Embree's configuration: the best that the processor has, or no better than these.
  const char* instructions;
};

}  // namespace

std::unique_ptr<Peer> make_embree(const std::string& method, unsigned threads, const Bodies& bodies) {
  static const std::map<std::string, Settings> all{
      {"embree-refit", {embree_3, RTC_BUILD_QUALITY_REFIT, ""}},
      {"embree-refit-avx2", {embree_3, RTC_BUILD_QUALITY_REFIT, ",isa=avx2"}},
      {"embree-refit-sse2", {embree_3, RTC_BUILD_QUALITY_REFIT, ",isa=sse2"}},
      {"embree-low", {embree_3, RTC_BUILD_QUALITY_LOW, ""}},
      {"embree4-refit", {embree_4, RTC_BUILD_QUALITY_REFIT, ""}},
  };
  const auto found = all.find(method);
  if (found == all.end()) return nullptr;
  const Settings& settings = found->second;
  const Embree& embree = settings.embree();
  // Where there are two threads, each commits and traces in its own part.
  static std::map<std::string, RTCDevice> devices;
  RTCDevice& device = devices[method];
  if (!device) device = new_device(embree, settings.instructions);
  std::vector<std::unique_ptr<Structure>> structures;
  for (const auto& body : bodies)
    structures.push_back(std::make_unique<EmbreeStructure>(embree, device, body, settings.quality));
  return std::make_unique<RayStep>(bodies, std::move(structures), threads);
}

}  // namespace bench
