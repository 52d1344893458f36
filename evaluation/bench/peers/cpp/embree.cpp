// SPDX-License-Identifier: MIT OR Apache-2.0
// Embree 3.13: one scene per body, sharing the host's arrays; rays in streams, marked as incoherent. Single rays,
// packets and coherent streams were no faster on any workload tried.
#include "embree.hpp"

#include <map>
#include <string>

#include "ray_step.hpp"

namespace bench {
namespace {

static_assert(sizeof(RayHit) == sizeof(RTCRayHit), "RayHit is laid out as Embree's");
static_assert(offsetof(RayHit, triangle) == offsetof(RTCRayHit, hit.primID), "RayHit is laid out as Embree's");

struct Context {
  RTCIntersectContext embree;
  const uint32_t* triangles;
};

// Refuses the triangles around the vertex that the ray starts from.
void refuse_touched(const RTCFilterFunctionNArguments* arguments) {
  const uint32_t* triangles = reinterpret_cast<const Context*>(arguments->context)->triangles;
  const unsigned n = arguments->N;
  for (unsigned i = 0; i < n; ++i) {
    if (arguments->valid[i] != -1) continue;
    const uint32_t vertex = RTCRayN_id(arguments->ray, n, i);
    const uint32_t* corner = triangles + 3 * size_t(RTCHitN_primID(arguments->hit, n, i));
    if (corner[0] == vertex || corner[1] == vertex || corner[2] == vertex) arguments->valid[i] = 0;
  }
}

class EmbreeStructure : public Structure {
 public:
  EmbreeStructure(RTCDevice device, const BodyView& body, RTCBuildQuality quality)
      : body_(body), scene_(rtcNewScene(device)) {
    // Only a dynamic scene keeps one tree per geometry, which alone can be refitted.
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_DYNAMIC | RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_LOW);
    geometry_ = add_triangles(device, scene_, body, quality);
    const Box<float> box = box_of(body.positions, body.vertex_count);
    t_min_ = 1e-6f * (box.upper_corner - box.lower_corner)[0];
  }

  ~EmbreeStructure() override {
    rtcReleaseGeometry(geometry_);
    rtcReleaseScene(scene_);
  }

  void update() override {
    rtcUpdateGeometryBuffer(geometry_, RTC_BUFFER_TYPE_VERTEX, 0);
    rtcCommitGeometry(geometry_);
    rtcCommitScene(scene_);
  }

  void nearest(RayHit* rays, size_t count) override {
    const FlushDenormals scope;
    Context context = new_context();
    rtcIntersect1M(scene_, &context.embree, reinterpret_cast<RTCRayHit*>(rays), unsigned(count), sizeof(RayHit));
  }

  void occluded(RayHit* rays, size_t count) override {
    const FlushDenormals scope;
    Context context = new_context();
    context.embree.filter = refuse_touched;
    // Touched triangles are met at rounding's distance from 0, nearly always below this, and then need no call of the
    // filter: that makes the test twice as fast.
    for (size_t i = 0; i < count; ++i) rays[i].t_min = t_min_;
    rtcOccluded1M(scene_, &context.embree, reinterpret_cast<RTCRay*>(rays), unsigned(count), sizeof(RayHit));
  }

 private:
  Context new_context() const {
    Context context;
    rtcInitIntersectContext(&context.embree);
    context.embree.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    context.triangles = body_.triangles;
    return context;
  }

  BodyView body_;
  RTCScene scene_;
  RTCGeometry geometry_;
  float t_min_ = 0;
};

// Where there are two threads, each commits and traces in its own part.
RTCDevice device(const std::string& instructions) {
  static std::map<std::string, RTCDevice> devices;
  RTCDevice& device = devices[instructions];
  if (!device) device = new_device(instructions);
  return device;
}

struct Settings {
  RTCBuildQuality quality;
  // Of Embree's configuration: the best that the processor has, or no better than these.
  const char* instructions;
};

}  // namespace

std::unique_ptr<Peer> make_embree(const std::string& method, unsigned threads, const Bodies& bodies) {
  static const std::map<std::string, Settings> all{
      {"embree-refit", {RTC_BUILD_QUALITY_REFIT, ""}},
      {"embree-refit-avx2", {RTC_BUILD_QUALITY_REFIT, ",isa=avx2"}},
      {"embree-refit-sse2", {RTC_BUILD_QUALITY_REFIT, ",isa=sse2"}},
      {"embree-low", {RTC_BUILD_QUALITY_LOW, ""}},
  };
  const auto found = all.find(method);
  if (found == all.end()) return nullptr;
  const RTCDevice chosen = device(found->second.instructions);
  std::vector<std::unique_ptr<Structure>> structures;
  for (const auto& body : bodies)
    structures.push_back(std::make_unique<EmbreeStructure>(chosen, body, found->second.quality));
  return std::make_unique<RayStep>(bodies, std::move(structures), threads);
}

}  // namespace bench
