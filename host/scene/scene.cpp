#include "host/scene/scene.hpp"

#include <malloc.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace raya {
namespace {

double largest_coordinate(const Vec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

/// Intensity of each light without a colour, and of ambient light, in a scene of n lights (SPD).
double default_intensity(std::size_t lights) {
    const auto n = static_cast<double>(lights);
    return std::sqrt(n) / (2 * n);
}

using SurfaceKey = std::array<double, 16>;

/// Returns all numbers of a surface, so that equal surfaces have equal keys.
SurfaceKey surface_key(const Surface& s) {
    const Checker c = s.checker.value_or(Checker{Colour(0), Colour(0), 0});
    return {s.colour.x, s.colour.y, s.colour.z, s.diffuse, s.specular, s.shine, s.transmittance, s.refraction_index,
            c.even.x,   c.even.y,   c.even.z,   c.odd.x,   c.odd.y,    c.odd.z, c.size,          s.checker ? 1.0 : 0.0};
}

}  // namespace

void merge_equal_surfaces(Scene& scene) {
    const std::vector<Surface> old_surfaces = std::exchange(scene.surfaces, {});
    std::map<SurfaceKey, int> index_of_key;
    std::vector<int> new_index(old_surfaces.size(), -1);  // new index of each old surface; -1: none so far
    const auto index_of = [&](std::size_t surface) {
        if (new_index.at(surface) >= 0) return new_index[surface];
        const auto [entry, added] =
            index_of_key.try_emplace(surface_key(old_surfaces[surface]), static_cast<int>(index_of_key.size()));
        if (added) scene.surfaces.push_back(old_surfaces[surface]);
        return new_index[surface] = entry->second;
    };
    const auto renumber = [&](auto& objects) {
        for (auto& object : objects) object.surface = index_of(static_cast<std::size_t>(object.surface));
    };
    renumber(scene.spheres);
    renumber(scene.planes);
    renumber(scene.polygons);
    renumber(scene.cones);
}

void drop_objects(Scene& scene) {
    // `= {}` would keep the vectors' memory.
    scene.spheres = std::vector<Sphere>();
    scene.planes = std::vector<Plane>();
    scene.polygons = std::vector<Polygon>();
    scene.cones = std::vector<Cone>();
#ifdef __GLIBC__
    malloc_trim(0);  // glibc keeps freed blocks of small size, which the vertices of polygons are
#endif
}

Colour light_colour(const Scene& scene, const Light& light) {
    return light.colour ? *light.colour : Colour(default_intensity(scene.lights.size()));
}

double ambient_intensity(const Scene& scene) {
    return scene.lights.empty() ? 1.0 : default_intensity(scene.lights.size());
}

double scene_extent(const Scene& scene) {
    double extent = largest_coordinate(scene.view.from);
    for (const Sphere& s : scene.spheres) extent = std::max(extent, largest_coordinate(s.centre) + std::abs(s.radius));
    for (const Polygon& p : scene.polygons)
        for (const Vec3& v : p.vertices) extent = std::max(extent, largest_coordinate(v));
    for (const Cone& c : scene.cones) {
        extent = std::max(extent, largest_coordinate(c.base) + std::abs(c.base_radius));
        extent = std::max(extent, largest_coordinate(c.apex) + std::abs(c.apex_radius));
    }
    return extent;
}

}  // namespace raya
