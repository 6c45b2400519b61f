#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "host/base/encoding.hpp"
#include "host/scene/generate.hpp"
#include "host/scene/nff.hpp"
#include "host/scene/split_mix.hpp"
#include "tests/scene/spd_folder.hpp"

using namespace raya;

TEST_CASE("SplitMix64 generates the published numbers", "[generate]") {
    SplitMix random(1234567);
    CHECK(random.next() == 6457827717110365317u);
    CHECK(random.next() == 3203168211198807973u);
}

TEST_CASE("generated scenes have the same bytes on all platforms", "[generate]") {
    const std::vector<std::pair<Scene, std::string>> scenes = {
        {generate_balls(0), "cfa8df2cd309b079baf4ae68ffb658ec"},
        {generate_balls(4), "3cc8ad080a610b385a9afee6992e3d02"},
        {generate_lattice(1), "e331fa0f4a891e86477d60ed7a3dc5dd"},
        {generate_lattice(7), "3b30bd4f9ea6d89da9d75fe9a5f4135a"},
        {generate_gears(1), "92155d578508289c0838c69bc1ae9de4"},
        {generate_gears(4), "f15bd209630c847a62604533314cd308"},
        {generate_uniform(700, {64, 1, 1}), "3b35565266175a26b696e6a2e4909bd2"},
        {generate_uniform(3000, {3, 5, 2}), "3eebf0274a5f7c34208987e0a28d3fd2"},
        {generate_random(1, 7), "5610adb29674ddbf96d87b90abe45f45"},
        {generate_random(20000, 8), "e46ac2c7e061950bc838a6e733313d72"},
        {generate_cluster(1), "371dca7fa892ccfc1aafffc401a9d2d5"},
        {generate_cluster(300), "7f4df50a598028d1d135ac86d1203bef"}};
    for (const auto& [scene, hash] : scenes) {
        CAPTURE(scene.name);
        const std::string text = write_nff(scene);
        CHECK(bytes_hash(text) == hash);
        CHECK(parse_nff(text, scene.name) == scene);
    }
}

TEST_CASE("balls and lattice: scenes equal those of SPD's files, with objects in the same order", "[generate]") {
    const std::vector<std::pair<std::string, Scene>> scenes = {
        {"balls2", generate_balls(2)}, {"balls4", generate_balls(4)}, {"lattice", generate_lattice(12)}};
    for (const auto& [name, generated] : scenes) {
        const auto path = spd_folder() / (name + ".nff");
        if (!std::filesystem::exists(path)) {
            WARN("file missing, skipped: " << path);
            continue;
        }
        CAPTURE(name);
        const Scene spd = read_nff(path);
        REQUIRE(generated.spheres.size() == spd.spheres.size());
        REQUIRE(generated.cones.size() == spd.cones.size());
        double max_difference = 0;
        const auto compare = [&](const Vec3& a, const Vec3& b) {
            max_difference = std::max(max_difference, (a - b).length());
        };
        for (std::size_t i = 0; i < spd.spheres.size(); ++i) {
            compare(generated.spheres[i].centre, spd.spheres[i].centre);
            compare(Vec3(generated.spheres[i].radius), Vec3(spd.spheres[i].radius));
        }
        for (std::size_t i = 0; i < spd.cones.size(); ++i) {
            const Cone &a = generated.cones[i], &b = spd.cones[i];
            compare(a.base, b.base);
            compare(a.apex, b.apex);
            compare({a.base_radius, a.apex_radius, 0}, {b.base_radius, b.apex_radius, 0});
            REQUIRE(a.surface == b.surface);
        }
        compare(generated.view.from, spd.view.from);
        compare(generated.view.at, spd.view.at);
        CHECK(max_difference < 1e-5);  // the files have six digits
        CHECK(generated.view.up == spd.view.up);
        CHECK(generated.view.angle_degrees == spd.view.angle_degrees);
        CHECK(generated.background == spd.background);
        CHECK(generated.lights == spd.lights);
        CHECK(generated.surfaces == spd.surfaces);
        CHECK(generated.polygons == spd.polygons);
    }
}

TEST_CASE("generators refuse parameters out of range", "[generate]") {
    CHECK_THROWS_WITH(generate_balls(-1), "balls: level -1: must be 0..6");
    CHECK_THROWS_WITH(generate_balls(7), "balls: level 7: must be 0..6");
    CHECK_THROWS_WITH(generate_lattice(65), "lattice: size 65: must be 1..64");
    CHECK_THROWS_WITH(generate_gears(0), "gears: size 0: must be 1..16");
    CHECK_THROWS_WITH(generate_random(0, 1), "random: 0 spheres: must be 1..20000000");
    CHECK_THROWS_WITH(generate_uniform(20000001, {1, 1, 1}), "uniform: 20000001 spheres: must be 1..20000000");
    CHECK_THROWS_WITH(generate_uniform(1, {1, 1, 257}), "uniform: 257 voxels along an axis: must be 1..256");
    CHECK_THROWS_WITH(generate_uniform(1, {256, 256, 17}), "uniform: 1114112 voxels: at most 1048576");
}
