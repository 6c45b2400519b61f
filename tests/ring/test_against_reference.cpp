// The kernels' fp32 images, compared pixel by pixel with the double-precision reference renderer.
#include <fmt/core.h>

#include <catch2/catch.hpp>

#include "host/scene/generate.hpp"
#include "tests/reference/reference.hpp"
#include "tests/ring/render_scene.hpp"

namespace raya {

TEST_CASE("fp32 renders agree with the double-precision reference", "[ring]") {
    constexpr std::uint32_t kSide = 160;
    constexpr double kMaxExcused = 0.02;  // maximum fraction of pixels that may differ because their rays graze an edge
    for (const std::string& name : project_scenes(4)) {
        CAPTURE(name);
        const Scene scene = project_scene(name);
        const RingResult result = render_scene(scene, {.width = kSide, .height = kSide});
        const reference::Options options{.width = kSide, .height = kSide, .bounces = kTestBounces};
        const reference::Image expected = reference::render(scene, options);
        const reference::Difference d = reference::compare(expected, result.image.rgb, scene, options);
        fmt::print(
            "{:8} PSNR {:5.1f} dB, largest difference {:.4f}, {} pixels differ by more than 2/255, of which {} graze "
            "an edge ({:.2f} %)\n",
            name, d.psnr_db, d.largest, d.above_limit, d.excused, 100.0 * d.excused / (kSide * kSide));
        CHECK(d.psnr_db >= 50);
        CHECK(d.above_limit == d.excused);
        CHECK(d.excused <= kMaxExcused * kSide * kSide);
        // Counts may differ a little, because rays that graze an edge may hit another object.
        const auto near = [](std::uint64_t got, std::uint64_t wanted) {
            return std::abs(double(got) - double(wanted)) <= 0.002 * double(wanted) + 2;
        };
        CHECK(result.events[RAYA_PRIMARY] == expected.counts.primary);
        CHECK(near(result.events[RAYA_PRIMARY_HITS], expected.counts.primary_hits));
        CHECK(near(result.events[RAYA_REFLECTED], expected.counts.reflected));
        CHECK(near(result.events[RAYA_REFRACTED], expected.counts.refracted));
        CHECK(near(result.events[RAYA_SHADOW], expected.counts.shadow));
        CHECK(near(result.events[RAYA_SHADOW_HITS], expected.counts.shadow_hits));
    }
}

TEST_CASE("corner sampling, images that are not square and 0 and 31 bounces agree with the reference", "[ring]") {
    const Scene scene = project_scene("planes");
    for (const std::uint32_t bounces : {0u, 31u}) {
        CAPTURE(bounces);
        const RingResult result =
            render_scene(scene, {.width = 75, .height = 50, .bounces = bounces, .sampling = Sampling::kCorners});
        const reference::Options options{
            .width = 75, .height = 50, .bounces = static_cast<int>(bounces), .corners = true};
        const reference::Difference d =
            reference::compare(reference::render(scene, options), result.image.rgb, scene, options);
        CHECK(d.psnr_db >= 50);
        CHECK(d.above_limit == d.excused);
    }
}

TEST_CASE("a scene larger than local memory is read from global memory, with the same results", "[ring]") {
    constexpr std::size_t kSphereBytes = 5 * sizeof(std::uint32_t);  // minimum size of a packed sphere
    Scene scene = project_scene("planes");
    scene.surfaces.push_back({.colour = {0.5, 0.5, 0.5}, .diffuse = 1});
    const int opaque = static_cast<int>(scene.surfaces.size()) - 1;
    const Sphere shell{{-2.4, 2.4, 3.4}, 0.4, opaque};  // in a corner, where the sphere touches nothing
    scene.spheres.push_back(shell);
    const RingCase c{.width = 20, .height = 20, .pes = 20};
    const RingResult small = render_scene(scene, c);
    CHECK(small.build_options.find("-DRAYA_WORDS_LOCAL=1") != std::string::npos);
    // Spheres hidden inside the opaque sphere, too many for the device's local memory.
    const std::size_t local_bytes = device_info(choose_device("")).local_memory_bytes;
    scene.spheres.insert(scene.spheres.end(), local_bytes / kSphereBytes + 1, {shell.centre, 0.01, opaque});
    const RingResult large = render_scene(scene, c);
    CHECK(large.pe_memory.job_words * sizeof(std::uint32_t) > local_bytes);
    CHECK(large.build_options.find("-DRAYA_WORDS_LOCAL=0") != std::string::npos);
    CHECK(pixel_hash(large.image) == pixel_hash(small.image));
    CHECK(large.events[RAYA_PRIMARY_HITS] == small.events[RAYA_PRIMARY_HITS]);
    CHECK(large.events[RAYA_SHADOW_HITS] == small.events[RAYA_SHADOW_HITS]);
    CHECK(large.events[RAYA_SPHERE_TESTS] > small.events[RAYA_SPHERE_TESTS]);
}

}  // namespace raya
