// SPDX-License-Identifier: MIT OR Apache-2.0
// Where Embree 3.13 and Embree 4 differ: how rays are traced.
#include "embree.hpp"

namespace bench {
namespace {

static_assert(offsetof(RayHit, vertex) == offsetof(RTCRayHit, ray.id), "RayHit is laid out as Embree's");
static_assert(offsetof(RayHit, instance) == offsetof(RTCRayHit, hit.instID), "RayHit is laid out as Embree's");

template <typename OfEmbree>
struct Context {
  OfEmbree embree;
  const uint32_t* triangles;
};

// Refuses the triangles around the vertex that the ray starts from.
template <typename OfEmbree>
void refuse_touched(const RTCFilterFunctionNArguments* arguments) {
  const uint32_t* triangles = reinterpret_cast<const Context<OfEmbree>*>(arguments->context)->triangles;
  const unsigned n = arguments->N;
  for (unsigned i = 0; i < n; ++i) {
    if (arguments->valid[i] != -1) continue;
    const uint32_t vertex = RTCRayN_id(arguments->ray, n, i);
    const uint32_t* corner = triangles + 3 * size_t(RTCHitN_primID(arguments->hit, n, i));
    if (corner[0] == vertex || corner[1] == vertex || corner[2] == vertex) arguments->valid[i] = 0;
  }
}

class Embree3 : public Embree {
 public:
  using Embree::Embree;

  void intersect(RTCScene scene, RayHit* rays, size_t count, Way way) const override {
    const FlushDenormals scope;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    if (way == Way::coherent_stream) context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    if (way == Way::single) {
      for (size_t i = 0; i < count; ++i) rtcIntersect1(scene, &context, reinterpret_cast<RTCRayHit*>(rays + i));
    } else {
      rtcIntersect1M(scene, &context, reinterpret_cast<RTCRayHit*>(rays), unsigned(count), sizeof(RayHit));
    }
  }

  void occluded(RTCScene scene, RayHit* rays, size_t count, const uint32_t* triangles) const override {
    const FlushDenormals scope;
    Context<RTCIntersectContext> context;
    rtcInitIntersectContext(&context.embree);
    context.embree.filter = refuse_touched<RTCIntersectContext>;
    context.triangles = triangles;
    rtcOccluded1M(scene, &context.embree, reinterpret_cast<RTCRay*>(rays), unsigned(count), sizeof(RayHit));
  }

 private:
  CALLED(rtcIntersect1);
  CALLED(rtcIntersect1M);
  CALLED(rtcOccluded1M);
};

class Embree4 : public Embree {
 public:
  using Embree::Embree;

  void intersect(RTCScene scene, RayHit* rays, size_t count, Way) const override {
    const FlushDenormals scope;
    QueryContext context;
    QueryArguments arguments{0, all_features, &context, nullptr, nullptr};
    for (size_t i = 0; i < count; ++i) intersect_(scene, rays + i, &arguments);
  }

  void occluded(RTCScene scene, RayHit* rays, size_t count, const uint32_t* triangles) const override {
    const FlushDenormals scope;
    Context<QueryContext> context{{}, triangles};
    QueryArguments arguments{invokes_filter, all_features, &context.embree, refuse_touched<QueryContext>, nullptr};
    for (size_t i = 0; i < count; ++i) occluded_(scene, rays + i, &arguments);
  }

 private:
  // As its manual has them (rtcIntersect1, rtcInitIntersectArguments), so that its headers need not be there.
  struct QueryContext {
    unsigned instance = RTC_INVALID_GEOMETRY_ID, part_of_instance = RTC_INVALID_GEOMETRY_ID;
  };
  struct QueryArguments {
    unsigned flags, features;
    QueryContext* context;
    RTCFilterFunctionN filter;
    void (*callback)(const void*);
  };
  static constexpr unsigned invokes_filter = 1 << 1, all_features = ~0u;

  using Trace = void (*)(RTCScene, RayHit*, QueryArguments*);
  const Trace intersect_ = find<Trace>("rtcIntersect1"), occluded_ = find<Trace>("rtcOccluded1");
};

}  // namespace

const Embree& embree_3() {
  static const Embree3 library("libembree3.so.3");
  return library;
}

const Embree& embree_4() {
  static const Embree4 library(EMBREE_4);
  return library;
}

}  // namespace bench
