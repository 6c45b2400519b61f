// Random views: only the camera moves, to positions that are uniform between the elevation limits.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <set>

#include "host/scene/generate.hpp"
#include "host/scene/scene.hpp"
#include "host/scene/split_mix.hpp"

namespace raya {
namespace {

double sine(double degrees) { return std::sin(degrees * std::numbers::pi / 180); }

TEST_CASE("a random view moves only the camera, at the same distance and within the elevation limits", "[view]") {
    SplitMix random(3);
    for (std::uint64_t seed = 0; seed < 500; ++seed) {
        Scene scene = generate_random(3, seed);
        const auto coordinate = [&] { return random.uniform(-5, 5); };
        scene.view.from = {coordinate(), coordinate(), coordinate()};
        scene.view.at = {coordinate(), coordinate(), coordinate()};
        scene.view.up = {coordinate(), coordinate(), coordinate()};
        CAPTURE(seed);
        Scene viewed = random_view(scene, seed);
        const Vec3 arm = viewed.view.from - viewed.view.at;
        CHECK(arm.length() == Approx((scene.view.from - scene.view.at).length()).epsilon(1e-5));
        const double height = arm.normalized().dot(scene.view.up.normalized());
        CHECK(height > sine(kMinElevationDegrees) - 1e-5);
        CHECK(height < sine(kMaxElevationDegrees) + 1e-5);
        viewed.view.from = scene.view.from;
        CHECK(viewed == scene);
    }
}

TEST_CASE("random views are uniform in azimuth and height between the elevation limits", "[view]") {
    const Scene scene = generate_cluster(1);
    constexpr int kViews = 4000, kParts = 8;
    int heights[kParts] = {}, azimuths[kParts] = {};
    std::set<double> x_components;
    for (std::uint64_t seed = 1; seed <= kViews; ++seed) {
        const View view = random_view(scene, seed).view;
        const Vec3 d = (view.from - view.at).normalized();
        x_components.insert(d.x);
        const double height_fraction =
            (d.z - sine(kMinElevationDegrees)) / (sine(kMaxElevationDegrees) - sine(kMinElevationDegrees));
        const double azimuth_fraction = std::atan2(d.y, d.x) / (2 * std::numbers::pi) + 0.5;
        ++heights[std::min(kParts - 1, std::max(0, static_cast<int>(height_fraction * kParts)))];
        ++azimuths[std::min(kParts - 1, static_cast<int>(azimuth_fraction * kParts))];
    }
    CHECK(static_cast<double>(x_components.size()) > kViews * 0.99);
    for (int i = 0; i < kParts; ++i) {  // expected: 500 views per part, standard deviation 21
        CHECK(std::abs(heights[i] - kViews / kParts) < 100);
        CHECK(std::abs(azimuths[i] - kViews / kParts) < 100);
    }
}

}  // namespace
}  // namespace raya
