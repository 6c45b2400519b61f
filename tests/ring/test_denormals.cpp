// Idle lanes compute with normal numbers, because a denormal operand costs some CPUs a hundred cycles. The kernels are
// built without optimisation: an optimising compiler may compute speculatively with undefined values and discard the
// results. The tests are hidden because they need PoCL's basic device; ctest runs them by the name ring.denormals.
#include <catch2/catch.hpp>

#include "tests/kernels/denormals.hpp"
#include "tests/torus/render_torus.hpp"
#include "tests/ring/render_scene.hpp"
#include "tests/thorough.hpp"

namespace raya {
namespace {

struct DenormalCase {
    const char* name;
    RingCase c;
    AccelKind accel = AccelKind::kNone;
};

const std::vector<DenormalCase>& denormal_cases() {
    static const std::vector<DenormalCase> cases = {
        {"none", {.width = 20, .height = 15, .pes = 7}},
        {"grid", {.width = 20, .height = 15, .pes = 7}, AccelKind::kGrid},
        {"spa22", {.width = 20, .height = 15, .pes = 7, .format = "spa22"}},
        {"supersample", {.width = 20, .height = 15, .pes = 7, .antialias = {.method = AntialiasMethod::kSupersample}}},
        {"bvh", {.width = 20, .height = 15, .pes = 7}, AccelKind::kBvh},
        {"one lane", {.width = 20, .height = 15, .pes = 7, .lanes = 1}},
        {"spa22, unfiltered", {.width = 20, .height = 15, .pes = 7, .format = "spa22", .filter = false}},
        {"spa22, grid", {.width = 20, .height = 15, .pes = 7, .format = "spa22"}, AccelKind::kGrid},
        {"spa22, bvh", {.width = 20, .height = 15, .pes = 7, .format = "spa22"}, AccelKind::kBvh},
        {"filter", {.width = 20, .height = 15, .pes = 7, .antialias = {.method = AntialiasMethod::kFilter}}}};
    return cases;
}

/// A random scene with objects of every kind, or a scene of the project.
Scene scene_named(const std::string& name) { return name == "every kind" ? random_view_scene(1) : project_scene(name); }

bool render_meets_denormals(Session& session, const Scene& scene, const DenormalCase& denormal_case,
                            const std::vector<SourcePatch>& patches) {
    RingSettings settings = settings_of(denormal_case.c);
    settings.accel.kind = denormal_case.accel;
    settings.kernels.sources.patches = patches;
    settings.kernels.sources.more_options = {"-cl-opt-disable"};
    RingRenderer renderer(session, scene, settings);
    renderer.render();  // PoCL compiles the kernels in the first render
    return uses_denormals([&] { renderer.render(); });
}

TEST_CASE("no lane of the ring's kernels computes with denormals", "[.][denormals]") {
    REQUIRE(can_detect_denormals());
    Session session(choose_device(""));
    for (const std::string& name :
         quick<std::string>(1, {"every kind", "polygons", "cones", "spheres", "centre", "mirrors", "glass", "planes"}))
        for (const DenormalCase& c : quick_of(5, denormal_cases())) {
            CAPTURE(name, c.name);
            CHECK_FALSE(render_meets_denormals(session, scene_named(name), c, {}));
        }
}

TEST_CASE("a kernel whose idle lanes read integers as floats is detected", "[.][denormals]") {
    REQUIRE(can_detect_denormals());
    Session session(choose_device(""));
    const SourcePatch reads_header{"geometry/scene.clh", "(index)(first_object_at(all))", "(index)(0)"};
    for (const DenormalCase& c : {denormal_cases()[0], denormal_cases()[1]})
        CHECK(render_meets_denormals(session, scene_named("every kind"), c, {reads_header}));
}

}  // namespace
}  // namespace raya
