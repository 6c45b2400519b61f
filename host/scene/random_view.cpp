#include "host/scene/random_view.hpp"

#include <cmath>
#include <numbers>

#include "host/scene/split_mix.hpp"

namespace raya {
namespace {

double rounded(double x) { return std::round(x * 1e6) / 1e6 + 0.0; }

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

}  // namespace

Scene random_view(Scene scene, std::uint64_t seed) {
    View& view = scene.view;
    const Vec3 up = view.up.normalized(), arm = view.from - view.at;
    const Vec3 other = std::abs(up.x) < 0.5 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
    const Vec3 east = up.cross(other).normalized(), north = up.cross(east);
    SplitMix random(seed);
    // Heights are even on a sphere (Archimedes): its zones are as large as they are high.
    const double height = random.uniform(std::sin(radians(kLowestView)), std::sin(radians(kHighestView)));
    const double azimuth = random.uniform(0, 2 * std::numbers::pi), level = std::sqrt(1 - height * height);
    const Vec3 direction = up * height + (east * std::cos(azimuth) + north * std::sin(azimuth)) * level;
    view.from = view.at + Vec3(rounded(direction.x), rounded(direction.y), rounded(direction.z)) * arm.length();
    return scene;
}

}  // namespace raya
