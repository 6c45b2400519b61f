// --from, --at, --up, --angle, --background, --light: the image equals the image of a scene with the same values.
#include <fmt/core.h>

#include "host/base/whole_file.hpp"
#include "host/cli/options.hpp"
#include "host/error.hpp"
#include "host/scene/nff.hpp"
#include "host/scene/split_mix.hpp"
#include "tests/cli/refusals.hpp"
#include "tests/cli/render_files.hpp"

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

TEST_CASE("change_view: refuses the values that the scene reader refuses, and names the option", "[cli]") {
    const auto refusal = [](const ViewOptions& v) -> std::string {
        Scene scene = read_nff(scene_file("centre"));
        const Scene before = scene;
        try {
            change_view(v, scene);
        } catch (const UserError& error) {
            return error.what();
        }
        FAIL("accepted");
        return {};
    };
    using Catch::Matchers::Contains;
    for (const char* text : {"1,2", "1,2,3,4", "1,2,", ",1,2", "1 2 3", "1,2,x", "1,2,3x", "nan,0,0", "1,inf,0",
                             "1e31,0,0", "1,2,1e999", "x"}) {
        CAPTURE(text);
        CHECK_THAT(refusal({.from = text}),
                   Catch::StartsWith(std::string("--from ") + text + ": must be three numbers"));
        CHECK_THAT(refusal({.at = text}), Catch::StartsWith("--at "));
        CHECK_THAT(refusal({.up = text}), Catch::StartsWith("--up "));
        CHECK_THAT(refusal({.background = text}), Catch::StartsWith("--background "));
        CHECK_THAT(refusal({.lights = {"0,0,1", text}}), Catch::StartsWith(std::string("--light ") + text));
    }
    CHECK_THAT(refusal({.lights = {"1,2,3,4,5"}}), Contains("X,Y,Z,R,G,B"));
    CHECK_THAT(refusal({.lights = {"1,2,3,-1,0,0"}}), Contains("colours from 0 to 1e9"));
    CHECK_THAT(refusal({.background = "0,1e10,0"}), Contains("from 0 to 1e9"));
    CHECK_THAT(refusal({.background = "0,-0.5,0"}), Contains("from 0 to 1e9"));
    CHECK(refusal({.from = "1,1,1", .at = "1,1,1"}) == "--from 1,1,1 --at 1,1,1: 'from' and 'at' are the same point");
    for (const double angle : {0.0, 180.0, -1.0}) CHECK_THAT(refusal({.angle = angle}), Contains("between 0 and 180"));
    CHECK_THAT(refusal({.up = "0,0,0"}), Catch::StartsWith("--up 0,0,0: 'up' is zero"));
    CHECK_THAT(refusal({.from = "0,0,5", .at = "0,0,0", .up = "0,0,-2"}),
               Contains("parallel to the viewing direction"));
}

/// Returns the options as command-line arguments.
Arguments arguments_of(const ViewOptions& v) {
    Arguments arguments = {"--from",       v.from,      "--at",    v.at,
                           "--up",         v.up,        "--angle", fmt::format("{}", *v.angle),
                           "--background", v.background};
    for (const std::string& light : v.lights) arguments.insert(arguments.end(), {"--light", light});
    return arguments;
}

TEST_CASE("render: view options, or the view of a report, give the image of a scene with the same values", "[cli]") {
    const ScratchFolder folder;
    const Scene scene = read_nff(scene_file("centre"));
    SplitMix random(6);
    const Scene random_scene = with_random_view(scene, random);
    write_whole_file(folder / "other.nff", write_nff(random_scene));
    const auto report_of = [&](const std::string& file, Arguments arguments) {
        arguments.insert(arguments.begin(), {"render", file, "-o", folder / "x.pfm", "--size", "16", "--lanes", "4",
                                             "--format", "fp32", "--report", folder / "x.json"});
        const RunOutcome run = run_raya(arguments);
        INFO(run.describe());
        REQUIRE(run.code == 0);
        return Document::parse(file_contents(folder / "x.json"));
    };
    for (const char* machine : {"grande", "torus"}) {
        CAPTURE(machine);
        const Document file_report = report_of(folder / "other.nff", {"--machine", machine});
        Arguments arguments = arguments_of(options_of(random_scene));
        arguments.insert(arguments.end(), {"--machine", machine});
        const Document options_report = report_of(scene_file("centre"), arguments);
        CHECK(options_report["image"]["hash"] == file_report["image"]["hash"]);
        CHECK(options_report["view"] == file_report["view"]);
        CHECK(report_of(scene_file("centre"), {"--machine", machine})["image"]["hash"] != file_report["image"]["hash"]);

        const Document& view = options_report["view"];
        const auto vector = [](const Document& v) {
            return fmt::format("{},{},{}", v[0].get<double>(), v[1].get<double>(), v[2].get<double>());
        };
        ViewOptions options_of_report{.from = vector(view["from"]),
                                      .at = vector(view["at"]),
                                      .up = vector(view["up"]),
                                      .background = vector(view["background"]),
                                      .angle = view["angle_degrees"].get<double>(),
                                      .lights = {}};
        for (const Document& light : view["lights"])
            options_of_report.lights.push_back(vector(light["position"]) + "," + vector(light["colour"]));
        arguments = arguments_of(options_of_report);
        arguments.insert(arguments.end(), {"--machine", machine});
        CHECK(report_of(scene_file("centre"), arguments)["image"]["hash"] == file_report["image"]["hash"]);
    }
}

TEST_CASE("bench: uses view options, and --light does not take the scene as a second value", "[cli]") {
    const ScratchFolder folder;
    const auto hash_of = [&](Arguments arguments) -> std::string {
        arguments.insert(arguments.begin(), "bench");
        arguments.insert(arguments.end(), {"--size", "16", "--samples", "1", "--lanes", "4", "--format", "fp32",
                                           "--report", folder / "b.json"});
        const RunOutcome run = run_raya(arguments);
        INFO(run.describe());
        REQUIRE(run.code == 0);
        return Document::parse(file_contents(folder / "b.json"))["rows"][0]["hash"];
    };
    const std::string default_hash = hash_of({scene_file("planes")});
    const std::string lit_hash = hash_of({"--light", "1,2,3", "--light=-4,5,6,1,1,0", scene_file("planes")});
    CHECK(lit_hash != default_hash);
    CHECK(hash_of({scene_file("planes"), "--angle", "20"}) != default_hash);
}

}  // namespace
}  // namespace raya
