// A raya scene in Embree. Spheres and triangles are Embree's geometries, cones are user geometry. EmbreeScene itself
// intersects planes, because Embree has no infinite ones.
#pragma once
#include <embree3/rtcore.h>

#include <cmath>
#include <vector>

#include "host/scene/scene.hpp"

namespace raya {

struct V3 {
    float x = 0, y = 0, z = 0;
};
inline V3 operator+(V3 a, V3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline V3 operator-(V3 a, V3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline V3 operator*(float s, V3 a) { return {s * a.x, s * a.y, s * a.z}; }
inline V3 times(V3 a, V3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
inline float dot(V3 a, V3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline V3 normalized(V3 a) { return (1 / std::sqrt(dot(a, a))) * a; }
inline V3 to_float(const Vec3& v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

/// Shading parameters of a surface, in fp32.
struct PeerSurface {
    V3 even, odd;
    float checker = 0;  // side of a checker's square; 0: no checker
    float diffuse, specular, shine, transmittance, refraction_index;
};

struct PeerTriangle {
    int surface;
    int normals;  // index of the first of its three normals in EmbreeScene::normals_; -1: a flat triangle
};

struct PeerCone {
    V3 base, axis;
    float radius, height, slope;
    bool inside;  // only the inside is visible
    int surface;
};

/// The nearest hit of a ray.
struct PeerHit {
    float t = 0;
    V3 geometric, normal;  // geometric and shading normal, not turned towards the ray
    int surface = -1;      // -1: no hit
};

class EmbreeScene {
  public:
    /// `robust`: with Embree's flag for watertight tests. Throws UserError for a sphere that is visible only from
    /// inside, which Embree does not support.
    EmbreeScene(const Scene& scene, bool robust);
    ~EmbreeScene();
    EmbreeScene(const EmbreeScene&) = delete;
    EmbreeScene& operator=(const EmbreeScene&) = delete;

    RTCScene rtc() const { return scene_; }
    const std::vector<PeerSurface>& surfaces() const { return surfaces_; }
    double build_s() const { return build_s_; }

    /// Returns the hit that Embree found, which the parameters describe, or the hit of a plane if that is nearer.
    PeerHit hit(V3 origin, V3 direction, float t, unsigned geometry, unsigned primitive, V3 normal, float u,
                float v) const;
    /// Returns true if the ray hits a plane at less than `t`.
    bool plane_blocks(V3 origin, V3 direction, float t) const;

  private:
    struct PeerPlane {
        V3 normal;
        float distance;
        int surface;
    };
    void add_spheres(const Scene& scene);
    void add_triangles(const Scene& scene);
    void add_cones(const Scene& scene);

    RTCDevice device_;
    RTCScene scene_;
    unsigned spheres_ = RTC_INVALID_GEOMETRY_ID, triangles_ = RTC_INVALID_GEOMETRY_ID;
    std::vector<PeerSurface> surfaces_;
    std::vector<PeerPlane> planes_;
    std::vector<V3> centres_, normals_;
    std::vector<int> sphere_surfaces_;
    std::vector<PeerTriangle> faces_;
    std::vector<PeerCone> cones_;
    double build_s_ = 0;
};

}  // namespace raya
