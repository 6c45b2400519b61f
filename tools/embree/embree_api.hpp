// The functions of Embree that trace rays, of Embree 3 or, with RAYA_EMBREE4, of Embree 4. The other functions,
// structures and constants that embree_peer uses are equal in both versions, so their declarations are always those of
// Embree 3.
#pragma once
#include <embree3/rtcore.h>

namespace raya {

#if RAYA_EMBREE4
/// RTCIntersectArguments and RTCOccludedArguments of Embree 4.
struct QueryArguments {
    int flags = 0;  // 1 << 16: coherent rays
    unsigned features = 0xffffffff;
    void *context = nullptr, *filter = nullptr, *callback = nullptr;
};
// Embree 4 stores one more word for each ray than Embree 3.
struct RayHit : RTCRayHit {
    unsigned instance_primitive;
};
struct RayHit16 : RTCRayHit16 {
    unsigned instance_primitives[16];
};
extern "C" {
void intersect1_of_embree4(RTCScene, RTCRayHit*, QueryArguments*) asm("rtcIntersect1");
void intersect16_of_embree4(const int*, RTCScene, RTCRayHit16*, QueryArguments*) asm("rtcIntersect16");
void occluded1_of_embree4(RTCScene, RTCRay*, QueryArguments*) asm("rtcOccluded1");
void occluded16_of_embree4(const int*, RTCScene, RTCRay16*, QueryArguments*) asm("rtcOccluded16");
}

/// Traces rays. `coherent`: with the flag for coherent rays.
class Tracing {
  public:
    explicit Tracing(bool coherent) { arguments_.flags = coherent ? 1 << 16 : 0; }
    void intersect(RTCScene scene, RayHit& ray) { intersect1_of_embree4(scene, &ray, &arguments_); }
    void intersect(const int* valid, RTCScene scene, RayHit16& rays) {
        intersect16_of_embree4(valid, scene, &rays, &arguments_);
    }
    void occluded(RTCScene scene, RTCRay& ray) { occluded1_of_embree4(scene, &ray, &arguments_); }
    void occluded(const int* valid, RTCScene scene, RTCRay16& rays) {
        occluded16_of_embree4(valid, scene, &rays, &arguments_);
    }

  private:
    QueryArguments arguments_;
};
#else
using RayHit = RTCRayHit;
using RayHit16 = RTCRayHit16;

/// Traces rays. `coherent`: with the flag for coherent rays.
class Tracing {
  public:
    explicit Tracing(bool coherent) {
        rtcInitIntersectContext(&context_);
        if (coherent) context_.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    }
    void intersect(RTCScene scene, RayHit& ray) { rtcIntersect1(scene, &context_, &ray); }
    void intersect(const int* valid, RTCScene scene, RayHit16& rays) { rtcIntersect16(valid, scene, &context_, &rays); }
    void occluded(RTCScene scene, RTCRay& ray) { rtcOccluded1(scene, &context_, &ray); }
    void occluded(const int* valid, RTCScene scene, RTCRay16& rays) { rtcOccluded16(valid, scene, &context_, &rays); }

  private:
    RTCIntersectContext context_;
};
#endif

}  // namespace raya
