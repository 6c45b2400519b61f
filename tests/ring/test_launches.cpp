// Launches of the trace kernel end after a bounded amount of work and save their ray trees. The next launch continues
// these ray trees.
#include <fmt/core.h>

#include <catch2/catch.hpp>

#include "host/error.hpp"
#include "tests/ring/render_scene.hpp"

namespace raya {
namespace {

struct LaunchResult {
    std::string hash;
    EventCounts events;
    std::vector<std::uint64_t> loads, costs;
    bool operator==(const LaunchResult&) const = default;
};

LaunchResult launch_result_of(const RingResult& r) {
    return {pixel_hash(r.image), r.events, r.load.per_pe, r.cost().cycles};
}

std::size_t launches_of(const RingResult& result) {
    std::size_t launches = 0;
    for (const LabelSummary& commands : result.commands)
        if (commands.kind == "kernel" && (commands.label == kTracePass || commands.label == kSupersamplePass))
            launches += commands.launches;
    return launches;
}

}  // namespace

TEST_CASE("launches report increasing progress; the first report comes when each lane has traced a few pixels",
          "[ring]") {
    const Scene scene = project_scene("centre");
    Session session(choose_device(""));
    RingSettings settings = settings_of({.width = 96, .height = 96, .pes = 4});
    settings.record_costs = true;
    RingRenderer renderer(session, scene, settings);
    std::vector<double> reported;
    const auto report = [&](double done) { reported.push_back(done); };
    const RingResult first = renderer.render(report);
    CHECK(std::is_sorted(reported.begin(), reported.end()));
    CHECK(reported.size() > 1);
    CHECK(reported.front() < 6 * first.lanes * first.group_size / (96 * 96 / 4.0));
    CHECK(reported.back() == 1);
    CHECK(launches_of(renderer.render()) ==
          1);  // without a progress callback, a launch may take a second, which is enough for this render
    settings.work_per_launch = 5000;
    RingRenderer limited(session, scene, settings);
    reported.clear();
    const RingResult second = limited.render(report);
    CHECK(std::is_sorted(reported.begin(), reported.end()));
    CHECK(reported.back() == 1);
    CHECK(launch_result_of(second) == launch_result_of(first));
    CHECK(launches_of(second) == reported.size());
    CHECK(reported.size() > 4);
}

// Maximum work of a launch that completes on the device that truncating_patches() simulates. The device ends the loops
// of launches with more work. Such a launch sets the cut flag and corrupts counts, costs, pixels and saved ray trees.
constexpr std::uint32_t kMaxCompletedWork = 40;

std::vector<SourcePatch> truncating_patches() {
    return {{"ring/trace.cl", "if (loops_were_cut(min(word_count, 2u))) atomic_inc(&mine->cut);",
             fmt::format(
                 "if (work > {}u) {{\n"
                 "        atomic_inc(&mine->cut);\n"
                 "        for (uint e = 0; e < RAYA_EVENTS; ++e) events[get_global_id(0) * RAYA_EVENTS + e] += 1000;\n"
                 "        for (uint i = item; i < capacity; i += RAYA_GROUP) store.pixels[i] = store.cycles[i] = 7;\n"
                 "        for (uint w = 0; w < 3; ++w) saved[(w * get_global_size(0) + get_global_id(0)) * RAYA_LANES] "
                 "= 9;\n"
                 "    }}",
                 kMaxCompletedWork)}};
}

TEST_CASE("a launch whose loops are cut is repeated with half the work, and its results are discarded", "[ring]") {
    const auto accel = GENERATE(AccelKind::kNone, AccelKind::kBvh);
    const auto method = GENERATE(AntialiasMethod::kNone, AntialiasMethod::kSupersample);
    CAPTURE(accel, antialias_name(method));
    const Scene scene = project_scene("glass");
    RingCase c{.width = 20, .height = 15, .pes = 4, .group = 3, .record_costs = true};
    c.antialias.method = method;
    RingSettings settings = settings_of(c);
    settings.accel.kind = accel;
    Session session(choose_device(""));
    const RingResult whole = RingRenderer(session, scene, settings).render();
    settings.kernels.sources.patches = truncating_patches();
    session.launch_limit(kTracePass) = session.launch_limit(kSupersamplePass) = 300;
    const RingResult first = RingRenderer(session, scene, settings).render();
    CHECK(launch_result_of(first) == launch_result_of(whole));
    CHECK(session.launch_limit(kTracePass) == 37);
    CHECK(session.launch_limit(kSupersamplePass) == (method == AntialiasMethod::kNone ? 300 : 37));
    const RingResult second = RingRenderer(session, scene, settings).render();
    CHECK(launch_result_of(second) == launch_result_of(whole));
    // The first render repeats the launches with the limits 300, 150 and 75, once for each of the two kernels.
    CHECK(launches_of(second) == launches_of(first) - (method == AntialiasMethod::kNone ? 3 : 6));
}

TEST_CASE("further launches have an amount of work for the intended time; in a captured run, that of the first",
          "[ring]") {
    Session session(choose_device(""));
    auto state = session.buffer<std::uint32_t>("state", 1);
    const auto amounts = [&] {
        std::vector<std::uint32_t> works;
        LaunchLoop<std::uint32_t> launches("");
        launches.run(
            session, "amounts", 8, 3600, [&](std::uint32_t work, bool) { works.push_back(work); },
            [&] { return LaunchEnd{.done = works.size() == 3}; }, state);
        return works;
    };
    CHECK(amounts() == std::vector<std::uint32_t>{8, 32, 128});
    const Capture capture(0, "", [](const Json&) {});
    CHECK(amounts() == std::vector<std::uint32_t>{8, 8, 8});
}

TEST_CASE("on a device that ends loops early, the render ends with an error", "[ring]") {
    const Scene scene = project_scene("glass");
    Session session(choose_device(""));
    RingSettings settings = settings_of({.width = 20, .height = 15, .pes = 4});
    settings.kernels.sources.patches = {{"shared/loop_canary.clh", "i < two", "i < two - 1"}};
    for (const std::uint32_t limit :
         {UINT32_MAX, 300u}) {  // without a limit the render fails at once; with 300 it first repeats launches
        session.launch_limit(kTracePass) = limit;
        CHECK_THROWS_WITH(RingRenderer(session, scene, settings).render(),
                          Catch::Contains("stopped this kernel's loops before their end") && Catch::Contains("remedy"));
    }
    CHECK(session.launch_limit(kTracePass) == 1);
}

}  // namespace raya
