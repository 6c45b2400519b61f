#include <fmt/core.h>

#include <cmath>
#include <numbers>

#include "host/error.hpp"
#include "host/scene/generate.hpp"

namespace raya {
namespace {

/// To nine decimals: sine and cosine differ between platforms in the last bits.
double rounded(double x) { return std::round(x * 1e9) / 1e9 + 0.0; }

/// Where nine unit balls touch the one that they sit on, seen from the +z side, in SPD's order: of the twelve
/// neighbours in a dense packing the three below are left out. Three groups, a third of a turn apart, of one upper and
/// two on the equator.
std::array<Vec3, 9> nine_directions() {
    std::array<Vec3, 9> directions;
    const double upper = std::sqrt(2.0 / 3.0), outward = std::sqrt(1.0 / 3.0);
    for (std::size_t group = 0; group < 3; ++group) {
        const double azimuth = std::numbers::pi * (1.0 / 4 + 2.0 / 3 * static_cast<double>(group));
        const double before = azimuth - std::numbers::pi / 6, after = azimuth + std::numbers::pi / 6;
        directions[3 * group] = Vec3(outward * std::cos(azimuth), outward * std::sin(azimuth), upper);
        directions[3 * group + 1] = Vec3(std::cos(before), std::sin(before), 0);
        directions[3 * group + 2] = Vec3(std::cos(after), std::sin(after), 0);
    }
    return directions;
}

/// `v` turned by the shortest rotation that takes +z to the unit vector `axis` (Rodrigues); half a turn about y for -z,
/// as SPD has it.
Vec3 turned_from_z(const Vec3& v, const Vec3& axis) {
    if (axis.z < -1 + 1e-9) return {-v.x, v.y, -v.z};
    const Vec3 pivot(-axis.y, axis.x, 0);
    return v * axis.z + pivot.cross(v) + pivot * (pivot.dot(v) / (1 + axis.z));
}

void add_flake(Scene& scene, int level, const Vec3& centre, double radius, const Vec3& axis) {
    static const std::array<Vec3, 9> directions = nine_directions();
    scene.spheres.push_back({{rounded(centre.x), rounded(centre.y), rounded(centre.z)}, rounded(radius), 1});
    if (level == 0) return;
    for (const Vec3& direction : directions) {
        const Vec3 outward = turned_from_z(direction, axis);
        add_flake(scene, level - 1, centre + outward * (radius * 4 / 3), radius / 3, outward);
    }
}

}  // namespace

Scene generate_balls(int level) {
    if (level < 0 || level > kHighestBallsLevel)
        throw UserError(fmt::format("balls: level {}: must lie in 0..{}", level, kHighestBallsLevel));
    Scene scene;
    scene.name = fmt::format("balls{}.nff", level);
    scene.background = {0.078, 0.361, 0.753};
    scene.view = {{2.1, 1.3, 1.7}, {0, 0, 0}, {0, 0, 1}, 45, 0.01, 512, 512};
    scene.lights = {{{4, 3, 2}, {}}, {{1, -4, 4}, {}}, {{-3, 1, 5}, {}}};
    scene.surfaces = {{{1, 0.75, 0.33}, 0.8, 0, 100000, 0, 1, {}}, {{1, 0.9, 0.7}, 0.5, 0.5, 3.0827, 0, 1, {}}};
    scene.polygons = {{{{12, 12, -0.5}, {-12, 12, -0.5}, {-12, -12, -0.5}, {12, -12, -0.5}}, {}, 0}};
    add_flake(scene, level, {0, 0, 0}, 0.5, {0, 0, 1});
    share_surfaces(scene);
    return scene;
}

}  // namespace raya
