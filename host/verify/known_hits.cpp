#include "host/verify/hits.hpp"

namespace raya {
namespace {

constexpr std::array<float, 3> kRight = {1, 0, 0}, kLeft = {-1, 0, 0}, kUp = {0, 1, 0}, kAhead = {0, 0, 1},
                               kBack = {0, 0, -1};
constexpr float kJustAbove11 = 11.0078125F;  // 11 + 2^-7

Scene empty_scene() {
    Scene scene;
    scene.surfaces.emplace_back();
    return scene;
}

// Returns a sphere with centre (x, 0, z). With the default z and radius, a ray along +z from (x, h, 0) hits the sphere
// at t = 16 - sqrt(25 - h^2).
Sphere ball(double x, double z = 16, double radius = 5) { return {{x, 0, z}, radius, 0}; }

KnownScene spheres() {
    Scene scene = empty_scene();
    scene.spheres = {ball(0), ball(32, 16, -5), ball(64), ball(64), ball(96), ball(96, 4, 2)};
    for (int i = 0; i < 30; ++i) scene.spheres.push_back(ball(200 + 16 * i));  // kernels test spheres in batches of 32
    scene.spheres.push_back(ball(664, 12));                                    // in front of the previous sphere
    return {"spheres",
            scene,
            {{"through the centre", {0, 0, 0}, kAhead, 0, 11},
             {"beside the centre", {3, 0, 0}, kAhead, 0, 12},
             {"tangent", {0, 5, 0}, kAhead, 0, 16},
             {"outside the sphere: a miss", {0, 5.25, 0}, kAhead, kNoObject, 0},
             {"from the centre outward", {0, 0, 16}, kAhead, 0, 5},
             {"from the surface inward", {0, 3, 12}, kAhead, 0, 8},
             {"from the surface outward", {0, 3, 20}, kAhead, kNoObject, 0},
             {"behind the ray", {0, 0, 32}, kAhead, kNoObject, 0},
             {"along -z", {0, 0, 32}, kBack, 0, 11},
             {"at the ray's limit", {0, 0, 0}, kAhead, kNoObject, 0, 11},
             {"just within the ray's limit", {0, 0, 0}, kAhead, 0, 11, kJustAbove11},
             {"a lane without a ray", {0, 0, 0}, kAhead, kNoObject, 0, 0},
             {"only the inside is visible", {35, 0, 0}, kAhead, 1, 20},
             {"equal distances: the lower number", {64, 4, 0}, kAhead, 2, 13},
             {"the nearer sphere has the higher number", {96, 0, 0}, kAhead, 5, 2},
             {"tangent to the nearer sphere", {96, 2, 0}, kAhead, 5, 4},
             {"the nearer sphere is missed", {96, 3, 0}, kAhead, 4, 12},
             {"the nearer sphere is the last in the scene", {664, 3, 0}, kAhead, 36, 8}}};
}

// Two equal planes z = 16, the plane y = 64, a sphere that touches the planes z = 16, and a square in these planes.
KnownScene planes() {
    Scene scene = empty_scene();
    scene.spheres = {{{0, 32, 21}, 5, 0}};
    scene.planes = {{{0, 0, 1}, 16, 0}, {{0, 0, 1}, 16, 0}, {{0, 1, 0}, 64, 0}};
    scene.polygons = {{{{8, 8, 16}, {16, 8, 16}, {16, 16, 16}, {8, 16, 16}}, {}, 0}};
    return {"planes",
            scene,
            {{"head on; equal distances: the lower number", {0, 0, 0}, kAhead, 1, 16},
             {"along -z", {0, 0, 32}, kBack, 1, 16},
             {"behind the ray", {0, 0, 32}, kAhead, kNoObject, 0},
             {"parallel to the planes z = 16", {0, 0, 0}, kRight, kNoObject, 0},
             {"the plane y = 64", {0, 0, 0}, kUp, 3, 64},
             {"oblique", {0, 0, 0}, {0.25F, 0.5F, 1}, 1, 16},
             {"from the plane itself", {0, 0, 16}, kAhead, kNoObject, 0},
             {"a sphere that touches the plane comes first", {0, 32, 0}, kAhead, 0, 16},
             {"a polygon in the plane comes last", {10, 10, 0}, kAhead, 1, 16},
             {"at the ray's limit", {0, 0, 0}, kAhead, kNoObject, 0, 16}}};
}

// An L-shaped polygon (8 x 8 without the upper right quarter), a triangle with vertex normals, a square with vertex
// normals (two triangles), two equal walls perpendicular to x, and a square near a quadrilateral that is not planar.
KnownScene polygons() {
    Scene scene = empty_scene();
    const Vec3 back = {0, 0, -1};
    const std::vector<Vec3> wall = {{128, 0, 0}, {128, 8, 0}, {128, 8, 8}, {128, 0, 8}};
    scene.polygons = {{{{0, 0, 16}, {8, 0, 16}, {8, 4, 16}, {4, 4, 16}, {4, 8, 16}, {0, 8, 16}}, {}, 0},
                      {{{32, 0, 16}, {40, 0, 16}, {32, 8, 16}}, {back, back, back}, 0},
                      {{{64, 0, 16}, {72, 0, 16}, {72, 8, 16}, {64, 8, 16}}, {back, back, back, back}, 0},
                      {wall, {}, 0},
                      {wall, {}, 0},
                      {{{200, 0, 12}, {200, 8, 20}, {192, 8, 12}, {192, 0, 20}}, {}, 0},
                      {{{188, 0, 13}, {192, 0, 13}, {192, 8, 13}, {188, 8, 13}}, {}, 0}};
    return {"polygons",
            scene,
            {{"inside the L's corner", {2, 2, 0}, kAhead, 0, 16},
             {"inside the L's right arm", {6, 2, 0}, kAhead, 0, 16},
             {"inside the L's upper arm", {2, 6, 0}, kAhead, 0, 16},
             {"in the L's notch", {6, 6, 0}, kAhead, kNoObject, 0},
             {"on the lower edge: inside", {2, 0, 0}, kAhead, 0, 16},
             {"on the left edge: inside", {0, 2, 0}, kAhead, 0, 16},
             {"on an upper edge: outside", {6, 4, 0}, kAhead, kNoObject, 0},
             {"on the right edge: outside", {8, 2, 0}, kAhead, kNoObject, 0},
             {"from behind", {2, 2, 32}, kBack, 0, 16},
             {"oblique", {2, 2, 0}, {0.25F, 0.0625F, 1}, 0, 16},
             {"inside a triangle", {35, 4, 0}, kAhead, 1, 16},
             {"on a triangle's slanting edge: outside", {36, 4, 0}, kAhead, kNoObject, 0},
             {"a square's lower left triangle", {65, 6, 0}, kAhead, 2, 16},
             {"a square's upper right triangle", {71, 6, 0}, kAhead, 3, 16},
             {"a wall, from the left; equal distances: the lower number", {120, 4, 4}, kRight, 4, 8},
             {"a wall, from the right", {136, 4, 4}, kLeft, 4, 8},
             {"parallel to the wall", {128, 4, -4}, kAhead, kNoObject, 0},
             {"past the wall", {120, 9, 4}, kRight, kNoObject, 0},
             // The ray meets the plane z = 12 at t = 12, outside the quadrilateral's box, which it enters at 14.67.
             {"t is clipped to the polygon's box", {181, 4, 0}, {0.75F, 0, 1}, 7, 13}}};
}

// Cylinders of radius 5 and height 16 along y from (x, 0, 16), and two cones of height 8 that narrow from radius 8 to
// 0, one along y and one along z.
KnownScene cones() {
    Scene scene = empty_scene();
    const auto cylinder = [](double x, double radius) { return Cone{{x, 0, 16}, radius, {x, 16, 16}, radius, 0}; };
    scene.cones = {
        cylinder(0, 5),   cylinder(32, -5), {{64, 0, 16}, 8, {64, 8, 16}, 0, 0}, {{96, 0, 16}, 8, {96, 0, 24}, 0, 0},
        cylinder(128, 5), cylinder(128, 5)};
    return {"cones",
            scene,
            {{"through the axis", {0, 4, 0}, kAhead, 0, 11},
             {"beside the axis", {3, 4, 0}, kAhead, 0, 12},
             {"tangent: a miss", {5, 4, 0}, kAhead, kNoObject, 0},
             {"outside the cylinder: a miss", {5.25, 4, 0}, kAhead, kNoObject, 0},
             {"at the height of the base", {0, 0, 0}, kAhead, 0, 11},
             {"at the height of the apex", {0, 16, 0}, kAhead, 0, 11},
             {"below the base", {0, -1, 0}, kAhead, kNoObject, 0},
             {"above the apex", {0, 17, 0}, kAhead, kNoObject, 0},
             {"along the axis: open ends", {0, -4, 16}, kUp, kNoObject, 0},
             {"from inside", {0, 4, 16}, kAhead, 0, 5},
             {"along -z", {0, 4, 32}, kBack, 0, 11},
             {"only the inside is visible", {35, 4, 0}, kAhead, 1, 20},
             {"a cone where its radius is 5", {67, 3, 0}, kAhead, 2, 12},
             {"above a cone's tip", {64, 9, 0}, kAhead, kNoObject, 0},
             {"into a cone through its base", {99, 0, 0}, kAhead, 3, 21},
             {"onto a cone from the side of its tip", {99, 0, 40}, kBack, 3, 19},
             {"equal distances: the lower number", {131, 4, 0}, kAhead, 4, 12}}};
}

}  // namespace

std::vector<KnownScene> known_scenes() { return {spheres(), planes(), polygons(), cones()}; }

}  // namespace raya
