// Launches whose loops the device ends early are repeated or refused.
#include <fmt/core.h>

#include <catch2/catch.hpp>

#include "host/cl/kernel_options.hpp"
#include "tests/ranks/same_results.hpp"
#include "tests/torus/render_torus.hpp"

namespace raya {

TEST_CASE("a launch whose loops the device cuts short is repeated with half the work, for any kernel", "[torus]") {
    struct Row {
        const char* kernel;
        const char* corruption;  // statements that corrupt what a cut launch may have written
    };
    const char* const corrupt_counts =
        "events[(size_t)slot * RAYA_EVENTS] += 1000; made[(size_t)slot * RAYA_KINDS + 1] += 9; "
        "queues[(size_t)slot * run->queue].head.pixel += 1;";
    const char* const corrupt_moves =
        "ended[(size_t)slot * RAYA_KINDS + 2] += 9; status[RAYA_STATUS_QUEUE_MAX] += 1000; "
        "queues[(size_t)slot * run->queue].head.pixel += 1;";
    const Row rows[] = {{"inject", corrupt_counts},
                        {"trace_voxel", corrupt_counts},
                        {"route", corrupt_moves},
                        {"accept", corrupt_moves}};
    const Scene scene = random_view_scene(kSceneSeeds[0]);
    TorusCase c{.width = 6, .height = 5, .nodes = {2, 2, 1}, .lanes = 1, .group = 3};
    for (const Row& row : rows) {
        CAPTURE(row.kernel);
        Session session(choose_device(""));
        c.sources = {};
        const TorusResult whole = render_torus(session, scene, c);
        const std::string file = fmt::format("torus/{}.cl", row.kernel);
        const std::string text = kernel_file(file);
        const std::size_t at = text.find("if (loops_were_cut("), end = text.find('\n', at);
        c.sources.patches = {{file, text.substr(at, end - at),
                              fmt::format("if (work > 3u) {{ status[RAYA_STATUS_CUT] = 1; {} }}", row.corruption)}};
        session.launch_limit(row.kernel) = 8;
        check_same(render_torus(session, scene, c), whole);
        CHECK(session.launch_limit(row.kernel) == 2);
        check_same(render_torus(session, scene, c), whole);
    }
}

TEST_CASE("compose is repeated with more work-groups if the device ends loops early", "[torus]") {
    Session session(choose_device(""));
    const Scene scene = random_view_scene(kSceneSeeds[0]);
    TorusCase c{.width = 16, .height = 15, .nodes = {2, 1, 1}, .lanes = 1, .group = 3};
    const std::string expected = image_and_counts(render_torus(session, scene, c));
    c.sources.patches = {
        {"torus/compose.cl", "if (loops_were_cut(", "if (pixels > 4 * get_global_size(0) || loops_were_cut("}};
    CHECK(image_and_counts(render_torus(session, scene, c)) == expected);
}

TEST_CASE("a loop that the device ends early is detected in every kernel", "[torus]") {
    Session session(choose_device(""));
    const Scene scene = random_view_scene(kSceneSeeds[0]);
    TorusCase c{.width = 6, .height = 5, .nodes = {2, 1, 1}, .lanes = 1, .group = 3};
    std::vector<SourcePatch> patches;
    for (const char* kernel : {"inject", "trace_voxel", "route", "accept", "compose"})
        patches.push_back({fmt::format("torus/{}.cl", kernel), "if (loops_were_cut(", "if (!loops_were_cut("});
    // The canary must detect that its loop ends after the first iteration.
    patches.push_back({"shared/loop_canary.clh", "i < two; ++i) iterations = iterations + 1;",
                       "i < two; ++i) { iterations = iterations + 1; break; }"});
    for (const SourcePatch& patch : patches) {
        CAPTURE(patch.file);
        c.sources.patches = {patch};
        CHECK_THROWS_AS(render_torus(session, scene, c), DeviceError);
        CHECK_THROWS_WITH(render_torus(session, scene, c),
                          Catch::Contains("stopped this kernel's loops before their end and reported no error") &&
                              Catch::Contains("remedy"));
    }
}

}  // namespace raya
