#include "tools/embree/embree_scene.hpp"

#include <algorithm>
#include <chrono>

#include "host/error.hpp"
#include "host/scene/polygon.hpp"

namespace raya {
namespace {

PeerSurface surface_of(const Surface& s) {
    const Checker checker = s.checker.value_or(Checker{s.colour, s.colour, 0});
    return {to_float(checker.even),
            to_float(checker.odd),
            static_cast<float>(checker.size),
            static_cast<float>(s.diffuse),
            static_cast<float>(s.specular),
            static_cast<float>(s.shine),
            static_cast<float>(s.transmittance),
            static_cast<float>(s.refraction_index)};
}

void cone_bounds(const RTCBoundsFunctionArguments* args) {
    const PeerCone& c = static_cast<const PeerCone*>(args->geometryUserPtr)[args->primID];
    RTCBounds* box = args->bounds_o;
    const float* base = &c.base.x;
    const float* axis = &c.axis.x;
    float* lower = &box->lower_x;
    float* upper = &box->upper_x;
    for (int i = 0; i < 3; ++i) {
        const float disc_extent = std::sqrt(std::max(0.0f, 1 - axis[i] * axis[i]));
        const float apex = base[i] + c.height * axis[i], apex_radius = std::abs(c.radius + c.slope * c.height);
        lower[i] = std::min(base[i] - c.radius * disc_extent, apex - apex_radius * disc_extent);
        upper[i] = std::max(base[i] + c.radius * disc_extent, apex + apex_radius * disc_extent);
    }
}

// Returns t of the ray's nearest hit between `near` and `far`, and sets `normal`; returns kNoHit without a hit.
float cone_hit(const PeerCone& c, V3 origin, V3 direction, float near, float far, V3& normal) {
    // `start` is the ray's point nearest to the cone's base, relative to the base. With the origin instead, rounding
    // would let a ray that starts on the cone hit the cone there.
    const float start_t = dot(c.base - origin, direction);
    const V3 start = (origin - c.base) + start_t * direction;
    const float z = dot(start, c.axis), dz = dot(direction, c.axis);
    const V3 side = start - z * c.axis, dside = direction - dz * c.axis;
    const float radius = c.radius + c.slope * z, dradius = c.slope * dz;
    const float a = dot(dside, dside) - dradius * dradius, b = dot(side, dside) - radius * dradius;
    const float constant = dot(side, side) - radius * radius, discriminant = b * b - a * constant;
    constexpr float kNoHit = 1e30f;
    if (!(discriminant > 0)) return kNoHit;
    const float square_root = std::sqrt(discriminant), q = b > 0 ? -(b + square_root) : square_root - b;
    const float by_a = q / a, by_q = constant / q;                    // the two solutions of the quadratic equation
    const float in = b > 0 ? by_a : by_q, out = b > 0 ? by_q : by_a;  // t where the ray enters and leaves the cone
    for (const float t : {std::min(in, out), std::max(in, out)}) {
        if (c.inside && t != out) continue;
        const float axis_position = z + t * dz, distance = t + start_t;
        if (!(distance > near && distance < far && axis_position >= 0 && axis_position <= c.height)) continue;
        const V3 from_axis = side + t * dside;
        normal = from_axis - (c.slope * (c.radius + c.slope * axis_position)) * c.axis;
        return distance;
    }
    return kNoHit;
}

V3 origin_of(const RTCRayN* ray, unsigned n, unsigned i) {
    return {RTCRayN_org_x(const_cast<RTCRayN*>(ray), n, i), RTCRayN_org_y(const_cast<RTCRayN*>(ray), n, i),
            RTCRayN_org_z(const_cast<RTCRayN*>(ray), n, i)};
}
V3 direction_of(const RTCRayN* ray, unsigned n, unsigned i) {
    return {RTCRayN_dir_x(const_cast<RTCRayN*>(ray), n, i), RTCRayN_dir_y(const_cast<RTCRayN*>(ray), n, i),
            RTCRayN_dir_z(const_cast<RTCRayN*>(ray), n, i)};
}

void intersect_cones(const RTCIntersectFunctionNArguments* args) {
    const PeerCone& c = static_cast<const PeerCone*>(args->geometryUserPtr)[args->primID];
    RTCRayN* ray = RTCRayHitN_RayN(args->rayhit, args->N);
    RTCHitN* hit = RTCRayHitN_HitN(args->rayhit, args->N);
    for (unsigned i = 0; i < args->N; ++i) {
        if (args->valid[i] == 0) continue;
        V3 normal;
        float& far = RTCRayN_tfar(ray, args->N, i);
        const float t = cone_hit(c, origin_of(ray, args->N, i), direction_of(ray, args->N, i),
                                 RTCRayN_tnear(ray, args->N, i), far, normal);
        if (!(t < far)) continue;
        far = t;
        RTCHitN_Ng_x(hit, args->N, i) = normal.x;
        RTCHitN_Ng_y(hit, args->N, i) = normal.y;
        RTCHitN_Ng_z(hit, args->N, i) = normal.z;
        RTCHitN_primID(hit, args->N, i) = args->primID;
        RTCHitN_geomID(hit, args->N, i) = args->geomID;
    }
}

void occlude_cones(const RTCOccludedFunctionNArguments* args) {
    const PeerCone& c = static_cast<const PeerCone*>(args->geometryUserPtr)[args->primID];
    for (unsigned i = 0; i < args->N; ++i) {
        if (args->valid[i] == 0) continue;
        V3 normal;
        float& far = RTCRayN_tfar(args->ray, args->N, i);
        const float t = cone_hit(c, origin_of(args->ray, args->N, i), direction_of(args->ray, args->N, i),
                                 RTCRayN_tnear(args->ray, args->N, i), far, normal);
        if (t < far) far = -INFINITY;
    }
}

}  // namespace

EmbreeScene::EmbreeScene(const Scene& scene, bool robust) : device_(rtcNewDevice("")), scene_(rtcNewScene(device_)) {
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
    if (robust) rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    for (const Surface& s : scene.surfaces) surfaces_.push_back(surface_of(s));
    for (const Plane& p : scene.planes)
        planes_.push_back({to_float(p.normal), static_cast<float>(p.distance), p.surface});
    const auto start = std::chrono::steady_clock::now();
    if (!scene.spheres.empty()) add_spheres(scene);
    if (!scene.polygons.empty()) add_triangles(scene);
    if (!scene.cones.empty()) add_cones(scene);
    rtcCommitScene(scene_);
    build_s_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

EmbreeScene::~EmbreeScene() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
}

void EmbreeScene::add_spheres(const Scene& scene) {
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_SPHERE_POINT);
    auto* rows = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4,
                                                             4 * sizeof(float), scene.spheres.size()));
    for (const Sphere& s : scene.spheres) {
        if (s.radius < 0) throw UserError("a sphere is visible only from inside: Embree does not support it");
        const V3 centre = to_float(s.centre);
        for (const float word : {centre.x, centre.y, centre.z, static_cast<float>(s.radius)}) *rows++ = word;
        centres_.push_back(centre);
        sphere_surfaces_.push_back(s.surface);
    }
    rtcCommitGeometry(geometry);
    spheres_ = rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
}

void EmbreeScene::add_triangles(const Scene& scene) {
    std::vector<V3> corners;
    for (const Polygon& p : scene.polygons)
        for (const auto& t : triangulate(p.vertices, newell_normal(p.vertices))) {
            faces_.push_back({p.surface, p.normals.empty() ? -1 : static_cast<int>(normals_.size())});
            for (const int corner : t) {
                corners.push_back(to_float(p.vertices[static_cast<std::size_t>(corner)]));
                if (!p.normals.empty()) normals_.push_back(to_float(p.normals[static_cast<std::size_t>(corner)]));
            }
        }
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* places = static_cast<V3*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(V3), corners.size()));
    std::copy(corners.begin(), corners.end(), places);
    auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                   3 * sizeof(unsigned), faces_.size()));
    for (unsigned i = 0; i < corners.size(); ++i) indices[i] = i;
    rtcCommitGeometry(geometry);
    triangles_ = rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
}

void EmbreeScene::add_cones(const Scene& scene) {
    for (const Cone& c : scene.cones) {
        const Vec3 base_to_apex = c.apex - c.base;
        const double height = base_to_apex.length();
        const double base = std::abs(c.base_radius), apex = std::abs(c.apex_radius);
        cones_.push_back({to_float(c.base), to_float(base_to_apex / height), static_cast<float>(base),
                          static_cast<float>(height), static_cast<float>((apex - base) / height),
                          c.base_radius < 0 || c.apex_radius < 0, c.surface});
    }
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(cones_.size()));
    rtcSetGeometryUserData(geometry, cones_.data());
    rtcSetGeometryBoundsFunction(geometry, cone_bounds, nullptr);
    rtcSetGeometryIntersectFunction(geometry, intersect_cones);
    rtcSetGeometryOccludedFunction(geometry, occlude_cones);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
}

PeerHit EmbreeScene::hit(V3 origin, V3 direction, float t, unsigned geometry, unsigned primitive, V3 normal, float u,
                         float v) const {
    PeerHit h;
    h.t = t;
    if (geometry == RTC_INVALID_GEOMETRY_ID) {
        h.t = INFINITY;
    } else if (geometry == spheres_) {
        h.geometric = h.normal = normalized(origin + t * direction - centres_[primitive]);
        h.surface = sphere_surfaces_[primitive];
    } else if (geometry == triangles_) {
        h.geometric = h.normal = normalized(normal);
        const PeerTriangle& face = faces_[primitive];
        h.surface = face.surface;
        if (face.normals >= 0) {
            const V3* n = &normals_[static_cast<std::size_t>(face.normals)];
            h.normal = normalized((1 - u - v) * n[0] + u * n[1] + v * n[2]);
        }
    } else {
        h.geometric = h.normal = normalized(normal);
        h.surface = cones_[primitive].surface;
    }
    for (const PeerPlane& p : planes_) {
        const float to_plane = (p.distance - dot(p.normal, origin)) / dot(p.normal, direction);
        if (!(to_plane > 0 && to_plane < h.t)) continue;
        h.t = to_plane;
        h.geometric = h.normal = p.normal;
        h.surface = p.surface;
    }
    return h;
}

bool EmbreeScene::plane_blocks(V3 origin, V3 direction, float t) const {
    return std::any_of(planes_.begin(), planes_.end(), [&](const PeerPlane& p) {
        const float to_plane = (p.distance - dot(p.normal, origin)) / dot(p.normal, direction);
        return to_plane > 0 && to_plane < t;
    });
}

}  // namespace raya
