// Seeded random scenes of one kind of object, and seeded random rays through them.
#pragma once
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "host/scene/polygon.hpp"
#include "host/scene/scene.hpp"
#include "host/scene/split_mix.hpp"
#include "tests/reference/reference.hpp"
#include "tests/scene/fp32.hpp"

namespace raya {

/// Maximum absolute coordinate of all objects and ray origins.
inline constexpr double kSceneReach = 3;

/// Returns a random integer 0 .. below - 1.
inline double whole_uniform(SplitMix& random, int below) { return std::floor(random.uniform(0, below)); }

inline Vec3 random_point(SplitMix& random, double reach) {
    const double x = random.uniform(-reach, reach), y = random.uniform(-reach, reach);
    return {x, y, random.uniform(-reach, reach)};
}

inline Vec3 random_direction(SplitMix& random) {
    for (;;) {
        const Vec3 v = random_point(random, 1);
        if (v.length() > 0.1 && v.length() < 1) return v.normalized();
    }
}

/// Returns a planar star-shaped outline around a random centre. It does not cross itself; it may be concave, because
/// the distances of its corners from the centre are random.
inline std::vector<Vec3> random_outline(SplitMix& random, int corners) {
    const Vec3 normal = random_direction(random), centre = random_point(random, 1.5);
    const Vec3 u = normal.cross(random_direction(random)).normalized(), v = normal.cross(u);
    std::vector<Vec3> outline;
    for (int i = 0; i < corners; ++i) {
        const double angle = 2 * std::numbers::pi * (i + random.uniform(0, 0.6)) / corners;
        const double arm = random.uniform(0.3, 1.2);
        outline.push_back(centre + arm * std::cos(angle) * u + arm * std::sin(angle) * v);
    }
    return outline;
}

/// Returns surfaces of every kind: matte, glossy, glass, glass that does not reflect, and a checker, which only flat
/// objects can have.
inline std::vector<Surface> every_surface() {
    Surface matte, gloss, glass, clear, checker;
    matte.colour = {0.9, 0.3, 0.1};
    matte.diffuse = 0.75;
    gloss = {{0.2, 0.5, 0.8}, 0.5, 0.4, 30, 0, 1, {}};
    glass = {{0.9, 1, 0.8}, 0.125, 0.25, 100, 0.7, 1.5, {}};
    clear = {{1, 1, 1}, 0.05, 0, 0, 0.92, 1.25, {}};
    checker.checker = Checker{{0.9, 0.8, 0.7}, {0.1, 0.2, 0.3}, 0.4};
    return {matte, gloss, glass, clear, checker};
}

/// Return the index of a random surface: any but the checker for round objects, any for flat objects.
inline int round_surface(SplitMix& random) { return static_cast<int>(whole_uniform(random, 4)); }
inline int flat_surface(SplitMix& random) { return static_cast<int>(whole_uniform(random, 5)); }

/// Adds a sphere. `sign`: -1 if only the inside is visible, else 1.
inline void add_sphere(Scene& scene, SplitMix& random, double sign) {
    scene.spheres.push_back({random_point(random, 2), sign * random.uniform(0.2, 0.9), round_surface(random)});
}

inline void add_plane(Scene& scene, SplitMix& random) {
    scene.planes.push_back({random_direction(random), random.uniform(-2, 2), flat_surface(random)});
}

inline void add_polygon(Scene& scene, SplitMix& random) {
    const int corners = 3 + static_cast<int>(whole_uniform(random, 7));
    scene.polygons.push_back({random_outline(random, corners), {}, flat_surface(random)});
}

/// Adds a patch. Some of its shading normals deviate from the geometric normal by more than a right angle, so they face
/// away from the visible side.
inline void add_patch(Scene& scene, SplitMix& random) {
    Polygon patch{random_outline(random, 3 + static_cast<int>(whole_uniform(random, 3))), {}, flat_surface(random)};
    const Vec3 normal = newell_normal(patch.vertices).normalized();
    const Vec3 along = normal.cross(random_direction(random)).normalized();
    const Vec3 mean = (random.uniform(-0.5, 2) * normal + along).normalized();
    for (std::size_t i = 0; i < patch.vertices.size(); ++i)
        patch.normals.push_back((mean + 0.4 * random_direction(random)).normalized());
    scene.polygons.push_back(patch);
}

/// Adds a cone. `taper`: ratio of the apex radius to the base radius; if negative, a random ratio, sometimes 0. `sign`:
/// -1 if only the inside is visible, else 1.
inline void add_cone(Scene& scene, SplitMix& random, double sign, double taper) {
    const Vec3 base = random_point(random, 1.5), axis = random_direction(random);
    const double r0 = random.uniform(0.2, 0.9), random_taper = std::max(0.0, random.uniform(-0.4, 1.5));
    const double r1 = r0 * (taper < 0 ? random_taper : taper);
    scene.cones.push_back({base, sign * r0, base + random.uniform(0.4, 1.5) * axis, sign * r1, round_surface(random)});
}

/// A kind of object and a function that adds such an object to a scene.
struct ObjectKind {
    std::string name;
    void (*add)(Scene& scene, SplitMix& random);
};

inline const std::vector<ObjectKind>& object_kinds() {
    static const std::vector<ObjectKind> kinds = {
        {"sphere", [](Scene& s, SplitMix& r) { add_sphere(s, r, 1); }},
        {"sphere seen from inside", [](Scene& s, SplitMix& r) { add_sphere(s, r, -1); }},
        {"plane", add_plane},
        {"polygon", add_polygon},
        {"patch", add_patch},
        {"cone", [](Scene& s, SplitMix& r) { add_cone(s, r, 1, -1); }},
        {"cylinder", [](Scene& s, SplitMix& r) { add_cone(s, r, 1, 1); }},
        {"cone seen from inside", [](Scene& s, SplitMix& r) { add_cone(s, r, -1, -1); }},
    };
    return kinds;
}

inline Scene empty_scene() {
    Scene scene;
    scene.name = "random";
    scene.background = {0.1, 0.2, 0.4};
    scene.view.from = {kSceneReach, kSceneReach, kSceneReach};
    scene.view.at = {0, 0, 0};
    scene.lights = {{{4, 5, 6}, {}}, {{-6, 3, 1}, Colour(0.5, 0.4, 0.3)}};
    scene.surfaces = every_surface();
    return scene;
}

inline Scene random_scene(const ObjectKind& kind, std::uint64_t seed, int objects = 20) {
    SplitMix random(seed);
    Scene scene = empty_scene();
    for (int i = 0; i < objects; ++i) kind.add(scene, random);
    return scene;
}

/// Returns a scene with three objects of every kind.
inline Scene mixed_scene(std::uint64_t seed) {
    SplitMix random(seed);
    Scene scene = empty_scene();
    for (const ObjectKind& kind : object_kinds())
        for (int i = 0; i < 3; ++i) kind.add(scene, random);
    return scene;
}

/// Returns rays from random origins towards the middle of the scene. Origins and directions are rounded to fp32, so
/// that kernel and reference trace the same rays.
inline std::vector<reference::Ray> random_rays(std::uint64_t seed, std::size_t count) {
    SplitMix random(seed);
    std::vector<reference::Ray> rays;
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3 origin = fp32(random_point(random, kSceneReach));
        rays.push_back({origin, fp32((random_point(random, 2) - origin).normalized())});
    }
    return rays;
}

}  // namespace raya
