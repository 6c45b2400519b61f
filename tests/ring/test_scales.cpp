// Scenes scaled to other units: scaling by a power of two changes no bit of the image; scaling by a power of ten
// changes only the rounding.
#include <fmt/core.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "tests/ring/render_scene.hpp"
#include "tests/scene/scaled_scene.hpp"
#include "tests/thorough.hpp"

namespace raya {
namespace {

const RingCase kCase{.width = 48, .height = 48, .pes = 48, .lanes = 4};

RingCase in_format(const std::string& format) {
    RingCase c = kCase;
    c.format = format;
    return c;
}

/// Returns one of the project's scenes without the scene's planes, because the horizon of planes depends on the
/// format's range and not on the scene.
Scene without_planes(const std::string& name) {
    Scene scene = project_scene(name);
    scene.planes.clear();
    return scene;
}

/// Returns the mean absolute difference of all colour values, which are first clamped to 0..1.
double mean_difference(const Image& a, const Image& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.rgb.size(); ++i)
        sum += std::abs(std::clamp(a.rgb[i], 0.0f, 1.0f) - std::clamp(b.rgb[i], 0.0f, 1.0f));
    return sum / static_cast<double>(a.rgb.size());
}

}  // namespace

// The images are equal if no number comes near the format's limits. In e5mY, whose smallest number is 2^-14, some
// numbers always come near a limit.
TEST_CASE("a scene scaled by a power of two gives the same bits and counts", "[ring][scales]") {
    for (const char* format : quick(2, {"spa22", "fp32", "e8m7t", "e7m12", "e6m10"}))
        for (const char* name : quick(2, {"mirrors", "cones", "polygons", "centre", "glass", "spheres"})) {
            const Scene scene = without_planes(name);
            const RingResult unscaled = render_scene(scene, in_format(format));
            CHECK(unscaled.events[RAYA_PRIMARY_HITS] > 100);
            for (const int k : {14, -17, 40, -40, 80, -80}) {
                CAPTURE(format, name, k);
                const RingResult scaled = render_scene(scaled_scene(scene, std::ldexp(1, k)), in_format(format));
                CHECK(pixel_hash(scaled.image) == pixel_hash(unscaled.image));
                CHECK(scaled.events == unscaled.events);
            }
        }
}

// A plane ends at the maximum hit distance, which is 256 times the scene's largest length after scaling.
TEST_CASE("scaling a scene into the format moves only the horizon of its planes", "[ring][scales]") {
    const Scene scene = project_scene("spheres");
    const RingResult unscaled = render_scene(scene, in_format("spa22"));
    const RingResult scaled = render_scene(scaled_scene(scene, 0x1p14), in_format("spa22"));
    CHECK(scaled.scale.exponent != 0);
    const double difference = mean_difference(unscaled.image, scaled.image);
    INFO(difference);
    CHECK(difference < 0.01);
    CHECK(scaled.events[RAYA_PRIMARY_HITS] > unscaled.events[RAYA_PRIMARY_HITS] * 95 / 100);
}

TEST_CASE("a scene scaled by a power of ten gives the same image except for rounding", "[ring][scales]") {
    // The different rounding of lengths moves edges by a fraction of a pixel, and rays between mirrors by more.
    for (const auto& [format, max_difference] : {std::pair{"fp32", 2e-6}, {"spa22", 2e-4}})
        for (const char* name : quick(1, {"mirrors", "polygons", "cones", "centre"}))
            for (const int k : {-5, 4, -12, 12}) {
                const Scene scene = without_planes(name);
                const double difference =
                    mean_difference(render_scene(scene, in_format(format)).image,
                                    render_scene(scaled_scene(scene, std::pow(10, k)), in_format(format)).image);
                CAPTURE(format, name, k, difference);
                CHECK(difference < max_difference);
            }
}

}  // namespace raya
