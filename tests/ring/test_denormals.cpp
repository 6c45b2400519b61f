// Lanes without work compute with ordinary numbers: a denormal operand costs some CPUs a hundred cycles. Kernels are
// built as they are written: an optimising compiler computes ahead what it then does not choose, of garbage too, a
// little of it. Hidden, as they need PoCL's basic device: ctest runs them as ring.denormals.
#include <catch2/catch.hpp>

#include "tests/kernels/denormals.hpp"
#include "tests/ring/render_scene.hpp"
#include "tests/thorough.hpp"

namespace raya {
namespace {

struct Way {
    const char* name;
    RingCase c;
    AccelKind accel = AccelKind::kNone;
};

const std::vector<Way>& ways() {
    static const std::vector<Way> all = {
        {"none", {.width = 20, .height = 15, .pes = 7}},
        {"one lane", {.width = 20, .height = 15, .pes = 7, .lanes = 1}},
        {"spa22", {.width = 20, .height = 15, .pes = 7, .format = "spa22"}},
        {"spa22, unfiltered", {.width = 20, .height = 15, .pes = 7, .format = "spa22", .filter = false}},
        {"grid", {.width = 20, .height = 15, .pes = 7}, AccelKind::kGrid},
        {"spa22, grid", {.width = 20, .height = 15, .pes = 7, .format = "spa22"}, AccelKind::kGrid},
        {"bvh", {.width = 20, .height = 15, .pes = 7}, AccelKind::kBvh},
        {"spa22, bvh", {.width = 20, .height = 15, .pes = 7, .format = "spa22"}, AccelKind::kBvh},
        {"filter", {.width = 20, .height = 15, .pes = 7, .antialias = {.method = AntialiasMethod::kFilter}}},
        {"supersample", {.width = 20, .height = 15, .pes = 7, .antialias = {.method = AntialiasMethod::kSupersample}}}};
    return all;
}

bool render_meets_denormals(Session& session, const Scene& scene, const Way& way,
                            const std::vector<SourcePatch>& patches) {
    RingSettings settings = settings_of(way.c);
    settings.accel.kind = way.accel;
    settings.kernels.sources.patches = patches;
    settings.kernels.sources.more_options = {"-cl-opt-disable"};
    RingRenderer renderer(session, scene, settings);
    renderer.render();  // PoCL compiles here
    return meets_denormals([&] { renderer.render(); });
}

TEST_CASE("no lane of the ring's kernels computes with denormals", "[.][denormals]") {
    REQUIRE(denormals_can_be_seen());
    Session session(choose_device(""));
    for (const std::string& name :
         quick<std::string>(2, {"polygons", "cones", "spheres", "centre", "mirrors", "glass", "planes"}))
        for (const Way& way : ways()) {
            CAPTURE(name, way.name);
            CHECK_FALSE(render_meets_denormals(session, project_scene(name), way, {}));
        }
}

TEST_CASE("a kernel whose idle lanes read counts as numbers is seen", "[.][denormals]") {
    REQUIRE(denormals_can_be_seen());
    Session session(choose_device(""));
    const SourcePatch word_0{"geometry/scene.clh", "(index)(first_object_at(all))", "(index)(0)"};
    for (const Way& way : {ways()[0], ways()[4]})
        CHECK(render_meets_denormals(session, project_scene("planes"), way, {word_0}));
}

}  // namespace
}  // namespace raya
