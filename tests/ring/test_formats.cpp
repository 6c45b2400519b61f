// Images in reduced formats: where the sphere filter is valid, and images agree with the reference.
#include <fmt/core.h>

#include <catch2/catch.hpp>

#include "tests/reference/reference.hpp"
#include "tests/ring/render_scene.hpp"

namespace raya {
TEST_CASE("the sphere filter is off if its error bounds do not hold", "[ring]") {
    const NumberFormat spa22 = parse_format("spa22");
    CHECK(filters_are_valid(spa22, 16384));
    CHECK_FALSE(filters_are_valid(spa22, 16385));
    CHECK_FALSE(filters_are_valid(parse_format("fp32"), 1));
    CHECK_FALSE(filters_are_valid(parse_format("e6m9"), 1));
    CHECK(filters_are_valid(parse_format("e5m10"), 64));
    CHECK_FALSE(filters_are_valid(parse_format("e5m10"), 65));
}

TEST_CASE("spa22 images show neither shadow acne nor light leaks", "[ring]") {
    // Counts the pixels that differ by 0.1 or more, except those within an eighth of a pixel of an edge. The format's
    // rounding moves edges by less than an eighth of a pixel; shadow acne and light leaks would affect whole areas.
    constexpr std::uint32_t kSide = 128;
    constexpr double kMaxWrongPixels = 0.002;  // fraction of all pixels
    for (const std::string& name : project_scenes(3)) {
        CAPTURE(name);
        const Scene scene = project_scene(name);
        const RingResult result = render_scene(scene, {.width = kSide, .height = kSide, .format = "spa22"});
        const reference::Options options{.width = kSide, .height = kSide, .bounces = kTestBounces};
        const reference::Difference d =
            reference::compare(reference::render(scene, options), result.image.rgb, scene, options, 0.1, 1.0 / 8);
        fmt::print("{:8} spa22: PSNR {:4.1f} dB, {} pixels differ by more than 0.1, of which {} graze an edge\n", name,
                   d.psnr_db, d.above_limit, d.excused);
        CHECK(d.above_limit - d.excused <= kMaxWrongPixels * kSide * kSide);
    }
}

}  // namespace raya
