// The words of jobs: those after the header by their hash, the header, and its camera.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <utility>

#include "host/base/encoding.hpp"
#include "host/scene/nff.hpp"
#include "host/scene/packer.hpp"
#include "tests/paths.h"
#include "tests/reference/reference.hpp"
#include "tests/scene/fp32.hpp"

using namespace raya;

namespace {

JobSettings settings_for(std::uint32_t width, std::uint32_t height, Sampling sampling = Sampling::kCentres) {
    JobSettings settings;
    settings.image = {width, height};
    settings.sampling = sampling;
    return settings;
}

/// Returns a scene of two patches (a quadrangle and a triangle), a concave polygon and a checkered surface.
Scene patch_scene() {
    Scene scene;
    scene.view.from = {0, 0, -5};
    scene.surfaces.resize(2);
    scene.surfaces[1].checker = Checker{{0.1, 0.2, 0.3}, {0.4, 0.5, 0.6}, 0.7};
    const Vec3 a = Vec3(0.6, 0, 0.8), b = Vec3(0, 0.6, 0.8), c = Vec3(0, 0, 1);
    scene.polygons = {{{{0, 0, 1}, {1, 0, 1}, {1.2, 1, 1}, {0, 1, 1}}, {a, b, c, a}, 0},
                      {{{0, 0, 2}, {2, 0, 1}, {0, 2, 1}}, {b, a, c}, 1},
                      {{{0, 0, 3}, {3, 0, 3}, {1, 1, 3}, {0, 3, 3}}, {}, 0}};
    return scene;
}

}  // namespace

// Each number is rounded once, by correctly rounded operations, so that the words are the same on all platforms.
TEST_CASE("the words of a job after its header do not change", "[packer]") {
    struct Row {
        const char *scene, *fp32, *e6m15;  // hashes of the words; in e6m15 lengths are multiplied by 8
    };
    for (const auto& [name, fp32, e6m15] :
         {Row{"centre", "c8c9e98e2ba001347c9f477d1f865c7c", "3c6f706c09be706d177fdd745adb9014"},
          Row{"spheres", "68d27d4bc5d842a9ba97a0acfbb2d113", "d76d8de5d59e13634232092166288f8b"},
          Row{"mirrors", "20f696dd48bd25caeb2c56896f524bde", "99e54ff1a00f2cb1215b8e3ac5112130"},
          Row{"glass", "9907e1c52158416b7739d4aad650e76e", "09d1557246da75abda47cf388c435385"},
          Row{"polygons", "285a95606636cd533ed2f10374ceab8b", "bfb405f194d2b20d6b25b415d4ba151f"},
          Row{"cones", "c437ec4c834be2c48c6f17844cb98d02", "14b4e27b6bfec0b30a1108fbc7e70ebe"},
          Row{"planes", "98735375f7d5836e6e95c288b1911fa2", "f272f6d9699d0d0fc64ccb6c32d0c6eb"},
          Row{"", "a29e80dd5ad9f81a5b506c155c11fc8a", "c1e98e95cfcf8a2f26b2ac4a217e4d3d"}}) {
        CAPTURE(name);
        const std::string file = name;
        const Scene scene = file.empty() ? patch_scene() : read_nff(RAYA_SOURCE_DIR "/scenes/" + file + ".nff");
        for (const NumberFormat& format : {NumberFormat{}, NumberFormat{6, 15, false}}) {
            JobSettings settings = settings_for(64, 48);
            settings.format = format;
            settings.length_exponent = format.is_fp32() ? 0 : 3;
            const PackedJob job = pack_job(scene, settings);
            CHECK(words_hash(std::span(job.words()).subspan(kWordsOf<raya_job>)) == (format.is_fp32() ? fp32 : e6m15));
            CHECK(job.has_patches() == (file.empty() || file == "polygons"));
        }
    }
}

TEST_CASE("a job's header contains settings, background, ambient light and extent", "[packer]") {
    Scene scene = patch_scene();
    scene.background = {0.1, 0.2, 0.3};
    JobSettings settings = settings_for(32, 24);
    settings.bounces = 3;
    for (std::uint32_t i = 0; i < RAYA_EVENTS; ++i) settings.cycles[i] = 100 + i;
    raya_job job = record_at<raya_job>(pack_job(scene, settings).words(), 0);
    CHECK((job.mapping.width == 32 && job.mapping.height == 24 && job.mapping.pes == 1));
    CHECK((job.mapping.parameter == 0 && job.mapping.kind == RAYA_FOLD_CYCLIC));
    CHECK(job.bounces == 3);
    CHECK(std::equal(settings.cycles.begin(), settings.cycles.end(), job.cycles));
    CHECK(Vec3(job.eye[0], job.eye[1], job.eye[2]) == Vec3(0, 0, -5));
    CHECK(Vec3(job.background[0], job.background[1], job.background[2]) == fp32(scene.background));
    CHECK(job.ambient == 1);  // the scene has no lights
    CHECK(job.extent == 5);   // the eye's distance
    scene.lights = {{{1, 2, 3}, {}}, {{4, 5, 6}, Colour(0.1, 0.2, 0.3)}};
    scene.spheres = {{{-8, 0, 0}, -2, 0}};
    job = record_at<raya_job>(pack_job(scene, settings).words(), 0);
    CHECK(job.ambient == static_cast<float>(std::sqrt(2.0) / 4));
    CHECK(job.extent == 10);
}

TEST_CASE("a job's corner and steps give the reference's primary rays", "[packer]") {
    Scene scene = patch_scene();
    scene.view = {{3, -4, 5}, {0.5, 1, -2}, {0.1, 0.2, 1}, 50, 0, 1, 1};
    for (const bool corners : {false, true})
        for (const auto& [width, height] :
             {std::pair{64u, 48u}, std::pair{1u, 7u}, std::pair{9u, 1u}, std::pair{1u, 1u}}) {
            const Sampling sampling = corners ? Sampling::kCorners : Sampling::kCentres;
            const raya_job job = record_at<raya_job>(pack_job(scene, settings_for(width, height, sampling)).words(), 0);
            reference::Options options;
            options.width = static_cast<int>(width);
            options.height = static_cast<int>(height);
            options.corners = corners;
            const auto vector = [](const float(&xyz)[3]) { return Vec3(xyz[0], xyz[1], xyz[2]); };
            for (std::uint32_t j = 0; j < height; ++j)
                for (std::uint32_t x = 0; x < width; ++x) {
                    const Vec3 direction =
                        vector(job.corner) + double(x) * vector(job.column_step) + double(j) * vector(job.row_step);
                    const reference::Ray ray = reference::primary_ray(scene, options, x, j);
                    CAPTURE(corners, width, height, x, j);
                    CHECK((direction.normalized() - ray.direction).length() <= 8 * 0x1p-24);
                    CHECK(vector(job.eye) == ray.origin);
                }
        }
}
