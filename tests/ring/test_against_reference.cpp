// The kernels' fp32 images against the double-precision reference, pixel by pixel.
#include <fmt/core.h>

#include <catch2/catch.hpp>

#include "host/scene/generate.hpp"
#include "tests/reference/reference.hpp"
#include "tests/ring/render_scene.hpp"

namespace raya {

TEST_CASE("fp32 renders agree with the double-precision reference", "[ring]") {
    constexpr std::uint32_t kSide = 160;
    constexpr double kExcusedShare = 0.02;  // pixels that may graze an edge, of all
    for (const std::string& name : project_scenes()) {
        CAPTURE(name);
        const Scene scene = project_scene(name);
        const RingResult result = render_scene(scene, {.width = kSide, .height = kSide});
        const reference::Options options{.width = kSide, .height = kSide};
        const reference::Image expected = reference::render(scene, options);
        const reference::Difference d = reference::compare(expected, result.image.rgb, scene, options);
        fmt::print(
            "{:8} PSNR {:5.1f} dB, largest {:.4f}, {} pixels off by more than 2/255, of which {} graze an edge ({:.2f} "
            "%)\n",
            name, d.psnr_db, d.largest, d.over, d.excused, 100.0 * d.excused / (kSide * kSide));
        CHECK(d.psnr_db >= 50);
        CHECK(d.over == d.excused);
        CHECK(d.excused <= kExcusedShare * kSide * kSide);
        // Counts may differ only where a ray grazes an edge.
        const auto near = [](std::uint64_t got, std::uint64_t wanted) {
            return std::abs(double(got) - double(wanted)) <= 0.002 * double(wanted) + 2;
        };
        CHECK(result.all.events[RAYA_PRIMARY] == expected.counts.primary);
        CHECK(near(result.all.events[RAYA_PRIMARY_HITS], expected.counts.primary_hits));
        CHECK(near(result.all.events[RAYA_REFLECTED], expected.counts.reflected));
        CHECK(near(result.all.events[RAYA_REFRACTED], expected.counts.refracted));
        CHECK(near(result.all.events[RAYA_SHADOW], expected.counts.shadow));
        CHECK(near(result.all.events[RAYA_SHADOW_HITS], expected.counts.shadow_hits));
    }
}

TEST_CASE("sampling by corners, other sizes and few bounces agree with the reference", "[ring]") {
    const Scene scene = project_scene("planes");
    for (const std::uint32_t bounces : {0u, 1u, 3u, 12u}) {
        CAPTURE(bounces);
        const RingResult result =
            render_scene(scene, {.width = 75, .height = 50, .bounces = bounces, .sampling = Sampling::kCorners});
        const reference::Options options{
            .width = 75, .height = 50, .bounces = static_cast<int>(bounces), .corners = true};
        const reference::Difference d =
            reference::compare(reference::render(scene, options), result.image.rgb, scene, options);
        CHECK(d.psnr_db >= 50);
        CHECK(d.over == d.excused);
    }
}

TEST_CASE("a scene larger than local memory is read from global memory, with the same answers", "[ring]") {
    const Scene scene = generate_random(60000, 7);
    const RingResult result = render_scene(scene, {.width = 20, .height = 20, .pes = 20});
    CHECK(result.pe_memory.job_words * 4 > device_info(choose_device("")).local_memory_bytes);
    CHECK(result.build_options.find("-DRAYA_WORDS_LOCAL=0") != std::string::npos);
    const reference::Options options{.width = 20, .height = 20};
    const reference::Difference d =
        reference::compare(reference::render(scene, options), result.image.rgb, scene, options);
    CHECK(d.over == d.excused);
    CHECK(d.excused <= 8);  // 60,000 overlapping spheres: a fiftieth of the pixels may graze an edge
}

}  // namespace raya
