// --from, --at, --up, --angle, --background, --light: exactly the given values of the scene change.
#include <fmt/core.h>

#include <catch2/catch.hpp>

#include "host/cli/parse.hpp"
#include "host/scene/nff.hpp"
#include "host/scene/split_mix.hpp"
#include "tests/cli/run_program.hpp"

namespace raya {
namespace {

std::string text_of(const Vec3& v) { return fmt::format("{},{},{}", v.x, v.y, v.z); }

Vec3 random_vector(SplitMix& random, double low, double high) {
    return {random.uniform(low, high), random.uniform(low, high), random.uniform(low, high)};
}

/// Returns options that set the view, background and lights to those of the scene.
ViewOptions options_of(const Scene& scene) {
    ViewOptions v;
    v.from = text_of(scene.view.from);
    v.at = text_of(scene.view.at);
    v.up = text_of(scene.view.up);
    v.angle = scene.view.angle_degrees;
    v.background = text_of(scene.background);
    for (const Light& light : scene.lights)
        v.lights.push_back(text_of(light.position) + (light.colour ? "," + text_of(*light.colour) : ""));
    return v;
}

/// Returns the scene with a random camera, background and lights.
Scene with_random_view(const Scene& scene, SplitMix& random) {
    Scene changed = scene;
    changed.view.from = random_vector(random, 4, 9);
    changed.view.at = random_vector(random, -1, 1);
    changed.view.up = random_vector(random, -1, 1) + Vec3(0, 0, 3);
    changed.view.angle_degrees = random.uniform(10, 80);
    changed.background = random_vector(random, 0, 1);
    changed.lights.clear();
    for (std::uint64_t n = 1 + random.next() % 3; n > 0; --n) {
        Light light{random_vector(random, -20, 20), {}};
        if (random.next() % 2 == 0) light.colour = random_vector(random, 0, 2);
        changed.lights.push_back(light);
    }
    return changed;
}

TEST_CASE("change_view: replaces the given values of the scene exactly, and no others", "[cli]") {
    const Scene scene = read_nff(scene_file("centre"));
    SplitMix random(5);
    for (int i = 0; i < 200; ++i) {
        const Scene random_scene = with_random_view(scene, random);
        CAPTURE(i);
        Scene changed = scene;
        change_view(options_of(random_scene), changed);
        REQUIRE(changed == random_scene);
        change_view({}, changed);
        REQUIRE(changed == random_scene);
        ViewOptions only_at;
        only_at.at = text_of(random_scene.view.at);
        Scene changed_at = scene, expected = scene;
        expected.view.at = random_scene.view.at;
        change_view(only_at, changed_at);
        REQUIRE(changed_at == expected);
    }
}

}  // namespace
}  // namespace raya
