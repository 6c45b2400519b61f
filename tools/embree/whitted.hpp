// Secondary rays and shading of Whitted ray tracing (kernels/README.md), in fp32 with the compiler's rounding.
#pragma once
#include <cmath>
#include <vector>

#include "tools/embree/embree_scene.hpp"

namespace raya {

struct Camera {
    V3 eye, gaze, right, top;  // right, top: from the image's centre to its edges; the image is at distance 1
    int width, height;

    V3 direction(int row, int column) const {  // through the pixel's centre
        const auto fraction = [](int index, int count) {
            return (static_cast<float>(index) + 0.5f) / static_cast<float>(count);
        };
        return normalized(gaze + (2 * fraction(column, width) - 1) * right + (1 - 2 * fraction(row, height)) * top);
    }
};

inline Camera camera_of(const View& view, int width, int height) {
    const Vec3 gaze = (view.at - view.from).normalized(), right = gaze.cross(view.up).normalized();
    const double h = std::tan(view.angle_degrees * M_PI / 360), w = h * width / height;
    const Vec3 top = h * right.cross(gaze);
    return {to_float(view.from), to_float(gaze), to_float(w * right), to_float(top), width, height};
}

struct PeerLight {
    V3 position, colour;
};

/// A pending ray of a pixel's ray tree.
struct PendingRay {
    V3 origin, direction;
    float weight;
    int level;
};

/// Geometry and colour of a hit; the normal is turned towards the ray.
struct ShadingPoint {
    V3 point, outer, inner, normal, colour;  // outer, inner: origins of reflected and refracted rays
    const PeerSurface* surface;
    bool leaving;  // the ray leaves the object
};

struct Whitted {
    Whitted(const Scene& scene, const EmbreeScene& embree, int bounces)
        : embree(embree),
          bounces(bounces),
          ambient_light(static_cast<float>(ambient_intensity(scene))),
          margin(static_cast<float>(scene_extent(scene)) * 0x1p-20f),
          background(to_float(scene.background)) {
        for (const Light& l : scene.lights) lights.push_back({to_float(l.position), to_float(light_colour(scene, l))});
    }

    /// Returns the hit point of a ray, with its normal, colour and the origins of the next rays.
    ShadingPoint shading_point(const PendingRay& r, const PeerHit& h) const {
        ShadingPoint m;
        m.surface = &embree.surfaces()[static_cast<std::size_t>(h.surface)];
        m.point = r.origin + h.t * r.direction;
        m.leaving = dot(h.geometric, r.direction) > 0;
        const V3 geometric = m.leaving ? -1 * h.geometric : h.geometric;
        m.normal = dot(h.normal, geometric) < 0 ? -1 * h.normal : h.normal;
        m.outer = m.point + margin * geometric;
        m.inner = m.point - margin * geometric;
        m.colour = m.surface->checker > 0 ? checker_colour(m, geometric) : m.surface->even;
        return m;
    }

    V3 ambient(const ShadingPoint& m) const { return (ambient_light * m.surface->diffuse) * m.colour; }

    /// Returns the contribution of a visible light; `to_light` has length 1.
    V3 light_contribution(const PendingRay& r, const ShadingPoint& m, const PeerLight& light, V3 to_light) const {
        const PeerSurface& s = *m.surface;
        const V3 mirror = r.direction - 2 * dot(m.normal, r.direction) * m.normal;
        const float cosine = dot(mirror, to_light);
        const float highlight = s.specular > 0 && cosine > 0 ? s.specular * std::pow(cosine, s.shine) : 0;
        return times(light.colour,
                     (s.diffuse * dot(m.normal, to_light)) * m.colour + V3{highlight, highlight, highlight});
    }

    /// Pushes the reflected and refracted rays on the stack; the last one pushed is traced first.
    template <class Stack>
    void push_secondary_rays(Stack& stack, const PendingRay& r, const ShadingPoint& m) const {
        if (r.level >= bounces) return;
        const PeerSurface& s = *m.surface;
        float mirror_weight = s.specular;
        if (s.transmittance > 0) {
            const float e = m.leaving ? s.refraction_index : 1 / s.refraction_index, c = -dot(m.normal, r.direction);
            const float g = 1 - e * e * (1 - c * c);
            if (g < 0) {
                mirror_weight += s.transmittance;
            } else {
                const V3 through = normalized(e * r.direction + (e * c - std::sqrt(g)) * m.normal);
                stack.push_back({m.inner, through, r.weight * s.transmittance, r.level + 1});
            }
        }
        if (mirror_weight > 0)
            stack.push_back({m.outer, r.direction - 2 * dot(m.normal, r.direction) * m.normal, r.weight * mirror_weight,
                             r.level + 1});
    }

    static V3 checker_colour(const ShadingPoint& m, V3 geometric) {
        const float x = std::abs(geometric.x), y = std::abs(geometric.y), z = std::abs(geometric.z);
        const float side = m.surface->checker;
        const float u = x >= y && x >= z ? m.point.y : y >= z ? m.point.z : m.point.x;
        const float v = x >= y && x >= z ? m.point.z : y >= z ? m.point.x : m.point.y;
        const float half_sum = 0.5f * (std::floor(u / side) + std::floor(v / side));
        return half_sum == std::floor(half_sum) ? m.surface->even : m.surface->odd;
    }

    const EmbreeScene& embree;
    int bounces;
    float ambient_light, margin;
    V3 background;
    std::vector<PeerLight> lights;
};

}  // namespace raya
