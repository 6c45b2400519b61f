#include "host/scene/generate.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "host/error.hpp"
#include "host/scene/split_mix.hpp"

namespace raya {
namespace {

constexpr double kMillionths = 1e6;  // for the parameter `parts` of rounded()

/// `text`: describes the number in the message.
void check_number(const std::string& text, int number, int lowest, int highest) {
    if (number < lowest || number > highest) throw UserError(fmt::format("{}: must be {}..{}", text, lowest, highest));
}

/// Returns a view of the cube [-1, 1]^3 from outside one of its corners. The cube fills most of the image.
View view_of_cube() { return {{2.6, 3.4, 1.9}, {0, 0, -0.1}, {0, 0, 1}, 36, 0, 512, 512}; }

/// Adds `count` spheres in the box with the lower corner `low_corner` and the given sides. Divides the box into k^3
/// cells; each sphere lies in a different cell.
void fill_box(Scene& scene, const Vec3& low_corner, const Vec3& sides, std::int64_t count, SplitMix& random) {
    std::int64_t k = 1;
    while (k * k * k < count) ++k;
    const Vec3 cell = sides / static_cast<double>(k);
    const double max_radius = std::min({cell.x, cell.y, cell.z}) / 2;
    for (std::int64_t i = 0; i < count; ++i) {
        const std::int64_t cell_index = i * k * k * k / count;
        const Vec3 corner =
            low_corner + Vec3(static_cast<double>(cell_index % k), static_cast<double>(cell_index / k % k),
                              static_cast<double>(cell_index / k / k)) *
                             cell;
        const double radius = max_radius * random.uniform(0.5, 0.9);
        // Maximum distance of the sphere's centre from the middle of a cubic cell along an axis, divided by
        // `max_radius`.
        const double max_shift = 0.98 * (1 - radius / max_radius);
        const auto random_coordinate = [&](double side) {
            return side / 2 + (side / 2 - max_radius + max_radius * max_shift) * random.uniform(-1, 1);
        };
        const double x = random_coordinate(cell.x), y = random_coordinate(cell.y), z = random_coordinate(cell.z);
        scene.spheres.push_back({rounded(corner + Vec3(x, y, z), kMillionths), rounded(radius, kMillionths),
                                 static_cast<int>(scene.spheres.size() % 4)});
    }
}

// Sizes of a cluster, found by a search (scenes/README.md).
constexpr double kClusterRadius = 1.6, kClusterHeight = 2.1, kMinClusterSphere = 0.4, kMaxClusterSphere = 0.7;

Sphere draw_sphere(SplitMix& random) {
    const double radius = random.uniform(kMinClusterSphere, kMaxClusterSphere);
    const double azimuth = random.uniform(0, 2 * std::numbers::pi);
    const double distance = kClusterRadius * std::sqrt(random.uniform(0, 1));
    const double height = radius + random.uniform(0, kClusterHeight);
    return {rounded({distance * std::cos(azimuth), distance * std::sin(azimuth), height}), rounded(radius), 0};
}

bool touches(const Sphere& sphere, const std::vector<Sphere>& spheres) {
    return std::ranges::any_of(
        spheres, [&](const Sphere& s) { return (sphere.centre - s.centre).length() < sphere.radius + s.radius; });
}

}  // namespace

Scene generate_uniform(int count, std::array<int, 3> voxels) {
    check_number(fmt::format("uniform: {} spheres", count), count, 1, kMaxObjects);
    std::int64_t voxel_count = 1;
    for (const int axis_voxels : voxels) {
        check_number(fmt::format("uniform: {} voxels along an axis", axis_voxels), axis_voxels, 1, kMaxVoxelsPerAxis);
        voxel_count *= axis_voxels;
    }
    constexpr std::int64_t kMaxVoxels = 1 << 20;
    if (voxel_count > kMaxVoxels)
        throw UserError(fmt::format("uniform: {} voxels: at most {}", voxel_count, kMaxVoxels));

    Scene scene;
    scene.name = fmt::format("uniform{}_{}x{}x{}.nff", count, voxels[0], voxels[1], voxels[2]);
    scene.background = {0.15, 0.2, 0.3};
    scene.view = view_of_cube();
    scene.lights = {{{5, 4, 8}, {}}};
    for (const Colour& colour :
         {Colour(0.9, 0.5, 0.3), Colour(0.4, 0.7, 0.9), Colour(0.9, 0.8, 0.4), Colour(0.5, 0.8, 0.5)})
        scene.surfaces.push_back({colour, 0.9, 0, 0, 0, 1, {}});
    const Vec3 sides(2.0 / voxels[0], 2.0 / voxels[1], 2.0 / voxels[2]);
    scene.spheres.reserve(static_cast<std::size_t>(count));
    SplitMix random(static_cast<std::uint64_t>(count));
    for (std::int64_t voxel = 0; voxel < voxel_count; ++voxel) {
        const std::int64_t spheres = (voxel + 1) * count / voxel_count - voxel * count / voxel_count;
        const Vec3 position(static_cast<double>(voxel % voxels[0]), static_cast<double>(voxel / voxels[0] % voxels[1]),
                            static_cast<double>(voxel / voxels[0] / voxels[1]));
        fill_box(scene, Vec3(-1) + position * sides, sides, spheres, random);
    }
    merge_equal_surfaces(scene);
    return scene;
}

Scene generate_random(int count, std::uint64_t seed) {
    check_number(fmt::format("random: {} spheres", count), count, 1, kMaxObjects);
    Scene scene;
    scene.name = fmt::format("random{}_{}.nff", count, seed);
    scene.background = {0.2, 0.3, 0.45};
    scene.view = view_of_cube();
    scene.lights = {{{5, 4, 8}, {}}, {{-4, 6, 5}, {}}};
    SplitMix random(seed);
    constexpr int kSurfaces = 12;
    for (int i = 0; i < kSurfaces; ++i) {
        const double red = random.uniform(0.25, 1), green = random.uniform(0.25, 1), blue = random.uniform(0.25, 1);
        const double specular = i % 3 == 0 ? 0 : i % 3 == 1 ? 0.2 : 0.5;
        scene.surfaces.push_back(
            {rounded({red, green, blue}, kMillionths), 0.9 - specular, specular, i % 3 == 0 ? 0.0 : 30.0, 0, 1, {}});
    }
    scene.spheres.reserve(static_cast<std::size_t>(count));
    const double mean_radius = std::cbrt(0.05 * 8 / (count * 4 / 3.0 * std::numbers::pi));
    for (int i = 0; i < count; ++i) {
        const double x = random.uniform(-1, 1), y = random.uniform(-1, 1), z = random.uniform(-1, 1);
        const double radius = std::min(0.6, mean_radius * random.uniform(0.5, 1.5));
        const int surface = static_cast<int>(random.next() % kSurfaces);
        scene.spheres.push_back({rounded({x, y, z}, kMillionths), rounded(radius, kMillionths), surface});
    }
    merge_equal_surfaces(scene);
    return scene;
}

Scene generate_cluster(std::uint64_t seed) {
    constexpr int kGlassSpheres = 3, kMirrorSpheres = 1, kSpheres = 7;
    constexpr int kMaxRedraws = 200;  // maximum number of new places and radii of a sphere that touches another one
    enum { kGlass, kMirror, kMatt, kFloor };
    Scene scene;
    scene.name = fmt::format("cluster{}.nff", seed);
    scene.background = {0.3, 0.5, 0.85};
    scene.view = {{0, -11, 4.4}, {0, 0, 1.1}, {0, 0, 1}, 20, 0, 256, 256};
    scene.lights = {{{-7, -8, 11}, Colour(0.7, 0.7, 0.7)}};
    scene.surfaces = {
        {{1, 1, 1}, 0.02, 0.12, 200, 0.85, 1.5, {}},
        {{1, 1, 1}, 0.1, 0.8, 200, 0, 1, {}},
        {{0.9, 0.3, 0.1}, 0.85, 0, 0, 0, 1, {}},
        {{0.9, 0.9, 0.9}, 0.85, 0, 0, 0, 1, Checker{{0.9, 0.87, 0.8}, {0.2, 0.3, 0.34}, 2.35}},
    };
    SplitMix random(seed);
    for (int i = 0; i < kSpheres; ++i) {
        Sphere sphere = draw_sphere(random);
        for (int tries = 0; tries < kMaxRedraws && touches(sphere, scene.spheres); ++tries)
            sphere = draw_sphere(random);
        sphere.surface = i < kGlassSpheres ? kGlass : i < kGlassSpheres + kMirrorSpheres ? kMirror : kMatt;
        scene.spheres.push_back(sphere);
    }
    scene.planes.push_back({{0, 0, 1}, 0, kFloor});
    merge_equal_surfaces(scene);
    return scene;
}

Scene scattered(const Scene& scene, std::uint64_t seed) {
    const Scene random_scene = generate_random(static_cast<int>(scene.spheres.size()), seed);
    Scene moved = scene;
    for (std::size_t i = 0; i < moved.spheres.size(); ++i) {
        Sphere& sphere = moved.spheres[i];
        for (int axis = 0; axis < 3; ++axis)
            sphere.centre[axis] =
                std::clamp(random_scene.spheres[i].centre[axis], -1 + sphere.radius, 1 - sphere.radius);
    }
    return moved;
}

Scene moved_into_voxels(const Scene& scene) {
    constexpr double kVoxels = 4, kVoxel = 2 / kVoxels;  // number of voxels along an axis; side of a voxel
    // Upper bound of the distance by which a hit region (host/accel) exceeds its sphere.
    constexpr double kGap = kVoxel / 16;
    Scene moved = scene;
    for (Sphere& sphere : moved.spheres)
        for (int axis = 0; axis < 3; ++axis) {
            double& coordinate = sphere.centre[axis];
            const double voxel_low = -1 + kVoxel * std::clamp(std::floor((coordinate + 1) / kVoxel), 0.0, kVoxels - 1);
            const double margin = std::min(sphere.radius + kGap, kVoxel / 2);
            coordinate = std::clamp(coordinate, voxel_low + margin, voxel_low + kVoxel - margin);
        }
    return moved;
}

Scene touching_walls(Scene scene) {
    for (int axis = 0; axis < 3; ++axis)
        for (const double sign : {-1.0, 1.0}) {
            const auto extent = [&](const Sphere& sphere) { return sign * sphere.centre[axis] + sphere.radius; };
            Sphere& outermost_sphere = *std::ranges::max_element(scene.spheres, {}, extent);
            outermost_sphere.centre[axis] = sign * (1 - outermost_sphere.radius);
        }
    return scene;
}

namespace {

/// Returns the directions from a sphere with axis +z to the nine smaller spheres that touch it, in SPD's order: the
/// directions to the twelve neighbours in a dense sphere packing, without the three downward ones. The nine directions
/// form three groups, a third of a turn apart. Each group has one upward direction and two in the equatorial plane.
std::array<Vec3, 9> nine_directions() {
    std::array<Vec3, 9> directions;
    const double upper = std::sqrt(2.0 / 3.0), outward = std::sqrt(1.0 / 3.0);
    for (std::size_t group = 0; group < 3; ++group) {
        const double azimuth = std::numbers::pi * (1.0 / 4 + 2.0 / 3 * static_cast<double>(group));
        const double left_azimuth = azimuth - std::numbers::pi / 6, right_azimuth = azimuth + std::numbers::pi / 6;
        directions[3 * group] = Vec3(outward * std::cos(azimuth), outward * std::sin(azimuth), upper);
        directions[3 * group + 1] = Vec3(std::cos(left_azimuth), std::sin(left_azimuth), 0);
        directions[3 * group + 2] = Vec3(std::cos(right_azimuth), std::sin(right_azimuth), 0);
    }
    return directions;
}

/// Returns `v` after the shortest rotation that maps +z to the unit vector `axis` (Rodrigues' formula); if `axis` is
/// -z, after half a turn about y, as in SPD.
Vec3 turned_from_z(const Vec3& v, const Vec3& axis) {
    if (axis.z < -1 + 1e-9) return {-v.x, v.y, -v.z};
    const Vec3 pivot(-axis.y, axis.x, 0);
    return v * axis.z + pivot.cross(v) + pivot * (pivot.dot(v) / (1 + axis.z));
}

void add_flake(Scene& scene, int level, const Vec3& centre, double radius, const Vec3& axis) {
    static const std::array<Vec3, 9> directions = nine_directions();
    scene.spheres.push_back({rounded(centre), rounded(radius), 1});
    if (level == 0) return;
    for (const Vec3& direction : directions) {
        const Vec3 outward = turned_from_z(direction, axis);
        add_flake(scene, level - 1, centre + outward * (radius * 4 / 3), radius / 3, outward);
    }
}

/// Number of teeth of a wheel. It is a multiple of four, so that wheels that mesh on one side mesh on all four sides.
constexpr int kTeeth = 24;

/// A corner of the outline of a tooth.
struct Corner {
    double turn;    // angle from the tooth's centre line, in pitches; a pitch is 1 / kTeeth of a turn
    double radius;  // distance from the wheel's axis, as a multiple of the radius of the pitch circle
};

/// The outline of a tooth, counter-clockwise: foot, flank, tip, tip, flank, foot. A tooth is narrower than half a pitch
/// at the pitch circle, and shorter than the gap that it enters, so that meshing wheels do not touch.
constexpr std::array<Corner, 6> kTooth{
    {{-0.32, 0.9}, {-0.235, 1}, {-0.12, 1.075}, {0.12, 1.075}, {0.235, 1}, {0.32, 0.9}}};

/// A wheel with a vertical axis.
struct Wheel {
    Vec3 centre;
    double radius;     // radius of the pitch circle
    double thickness;  // length along the axis
    double turn;       // angle of the first tooth from the x axis, in pitches
    int surface;
};

/// Returns the wheel's outline at z = `height`, counter-clockwise as seen from above.
std::vector<Vec3> outline(const Wheel& wheel, double height) {
    std::vector<Vec3> corners;
    for (int tooth = 0; tooth < kTeeth; ++tooth)
        for (const Corner& corner : kTooth) {
            const double angle = 2 * std::numbers::pi * (tooth + wheel.turn + corner.turn) / kTeeth;
            const double radius = wheel.radius * corner.radius;
            corners.emplace_back(rounded(wheel.centre.x + radius * std::cos(angle)),
                                 rounded(wheel.centre.y + radius * std::sin(angle)), height);
        }
    return corners;
}

/// Adds the upper face, the lower face, and a quadrilateral for each of their edges. All fronts face outwards.
void add_wheel(Scene& scene, const Wheel& wheel) {
    const std::vector<Vec3> upper = outline(wheel, rounded(wheel.centre.z + wheel.thickness / 2));
    const std::vector<Vec3> lower = outline(wheel, rounded(wheel.centre.z - wheel.thickness / 2));
    scene.polygons.push_back({upper, {}, wheel.surface});
    scene.polygons.push_back({{lower.rbegin(), lower.rend()}, {}, wheel.surface});
    for (std::size_t i = 0; i < upper.size(); ++i) {
        const std::size_t next = (i + 1) % upper.size();
        scene.polygons.push_back({{lower[i], lower[next], upper[next], upper[i]}, {}, wheel.surface});
    }
}

// Sizes of the lattice, relative to the distance between the centres of neighbouring spheres. A cylinder starts inside
// a sphere, at 0.99 of half the sphere's radius from the centre, and ends at the same depth inside the next sphere.
constexpr double kSphereRadius = 1.0 / 4, kCylinderRadius = 1.0 / 16, kCylinderStart = 0.99 / 8;

/// Returns a view from near the middle of an upper edge, diagonally down through the cube. The eye is half a lattice
/// distance away from a column and from a layer of spheres, so the eye is outside all objects. SPD's own view is known
/// only for size 12.
View view_of_lattice(int size) {
    const double x = (size / 2 + 0.5) / size, z = 1 - 0.5 / size;
    return {rounded({x, 1, z}), rounded({x, -1, z - 2}), {0.2, 1, 0}, 60, 0, 512, 512};
}

// Adds a sphere and the cylinders from it to its neighbours in the directions +x, +y and +z.
void add_sphere_and_cylinders(Scene& scene, int size, const std::array<int, 3>& position) {
    const double distance = 1.0 / size;
    const Vec3 centre(position[0] * distance, position[1] * distance, position[2] * distance);
    scene.spheres.push_back({rounded(centre), rounded(kSphereRadius * distance), 0});
    for (int axis = 0; axis < 3; ++axis) {
        if (position[static_cast<std::size_t>(axis)] == size) continue;
        Vec3 base = centre, apex = centre;
        base[axis] += kCylinderStart * distance;
        apex[axis] += (1 - kCylinderStart) * distance;
        const double radius = rounded(kCylinderRadius * distance);
        scene.cones.push_back({rounded(base), radius, rounded(apex), radius, 1 + axis});
    }
}

}  // namespace

Scene generate_balls(int level) {
    check_number(fmt::format("balls: level {}", level), level, 0, 6);
    Scene scene;
    scene.name = fmt::format("balls{}.nff", level);
    scene.background = {0.078, 0.361, 0.753};
    scene.view = {{2.1, 1.3, 1.7}, {0, 0, 0}, {0, 0, 1}, 45, 0.01, 512, 512};
    scene.lights = {{{4, 3, 2}, {}}, {{1, -4, 4}, {}}, {{-3, 1, 5}, {}}};
    scene.surfaces = {{{1, 0.75, 0.33}, 0.8, 0, 100000, 0, 1, {}}, {{1, 0.9, 0.7}, 0.5, 0.5, 3.0827, 0, 1, {}}};
    scene.polygons = {{{{12, 12, -0.5}, {-12, 12, -0.5}, {-12, -12, -0.5}, {12, -12, -0.5}}, {}, 0}};
    add_flake(scene, level, {0, 0, 0}, 0.5, {0, 0, 1});
    merge_equal_surfaces(scene);
    return scene;
}

Scene generate_gears(int size) {
    check_number(fmt::format("gears: size {}", size), size, 1, 16);
    Scene scene;
    scene.name = fmt::format("gears{}.nff", size);
    scene.background = {0.078, 0.361, 0.753};
    scene.view = {{2.4, 3.2, 3.0}, {0, 0, -0.15}, {0, 0, 1}, 36, 0, 512, 512};
    scene.lights = {{{4, 3, 5}, {}}, {{1, 6, 3}, {}}, {{-4, 2, 6}, {}}, {{5, -2, 2}, {}}, {{0, 0, 8}, {}}};
    constexpr int ground = 4;
    scene.surfaces = {{{0.85, 0.65, 0.25}, 0.7, 0.3, 30, 0, 1, {}},       // brass
                      {{0.75, 0.8, 0.85}, 0.4, 0.6, 100, 0, 1, {}},       // steel
                      {{0.75, 0.95, 0.85}, 0.2, 0.1, 100, 0.7, 1.1, {}},  // glass
                      {{0.8, 0.15, 0.12}, 0.9, 0.1, 20, 0, 1, {}},        // red enamel
                      {{0.85, 0.8, 0.7}, 0.9, 0, 0, 0, 1, {}}};
    scene.polygons = {{{{12, 12, -1.2}, {-12, 12, -1.2}, {-12, -12, -1.2}, {12, -12, -1.2}}, {}, ground}};
    const double distance = 2.0 / size;
    for (int x = 0; x < size; ++x)
        for (int y = 0; y < size; ++y)
            for (int z = 0; z < size; ++z) {
                const Vec3 centre = Vec3(-1) + (Vec3(x, y, z) + Vec3(0.5)) * distance;
                const double turn = (x + y) % 2 == 0 ? 0 : 0.5;  // pitches; 0.5: teeth face the gaps of the neighbours
                add_wheel(scene, {centre, distance / 2, 0.4 * distance, turn, (x + 2 * y + z) % ground});
            }
    merge_equal_surfaces(scene);
    return scene;
}

Scene generate_lattice(int size) {
    check_number(fmt::format("lattice: size {}", size), size, 1, 64);
    Scene scene;
    scene.name = fmt::format("lattice{}.nff", size);
    scene.background = {0.078, 0.361, 0.753};
    scene.view = view_of_lattice(size);
    for (int axis = 0; axis < 3; ++axis)
        for (const double coordinate : {2, -1}) {
            Vec3 position(0.5);
            position[axis] = coordinate;
            scene.lights.push_back({position, {}});
        }
    scene.surfaces = {{{0.9, 0.9, 0.9}, 0.5, 0.5, 3.0827, 0, 0, {}}};
    for (const Colour& colour : {Colour(0.9, 0.1, 0.1), Colour(0.1, 0.9, 0.1), Colour(0.1, 0.1, 0.9)})
        scene.surfaces.push_back({colour, 0.99, 0, 100000, 0, 0, {}});
    for (int x = 0; x <= size; ++x)
        for (int y = 0; y <= size; ++y)
            for (int z = 0; z <= size; ++z) add_sphere_and_cylinders(scene, size, {x, y, z});
    merge_equal_surfaces(scene);
    return scene;
}

}  // namespace raya
