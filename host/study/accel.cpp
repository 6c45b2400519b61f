// Every object, a grid or a tree: which finds a ray's nearest hit the soonest, and how that grows with the objects.
#include <algorithm>
#include <cmath>

#include "host/base/program.hpp"
#include "host/scene/generate.hpp"
#include "host/study/accel_rows.hpp"
#include "host/study/prose.hpp"
#include "host/study/rows.hpp"
#include "host/study/studies.hpp"

namespace raya {
namespace {

using namespace accel;

constexpr std::uint64_t kSeeds = 5;

bool is_counted(const Row& row) { return row.is_counted(); }

std::string text_of(const Estimate& estimate) {
    const auto digits = [](double value) { return fmt::format("{:.{}f}", value, value < 100 ? 2 : 0); };
    return digits(estimate.mean) + (estimate.has_interval() ? " +- " + digits(estimate.half_width) : "");
}

std::string ratios_text(const Ratios& all) {
    return joined(all, ", ", [](const Ratio& one) { return fmt::format("{} ({})", text_of(one.times), one.group); });
}

// From how many objects on the other way pays, in scenes that differ in their number of objects.
std::string pays_from(const Ratios& all, const std::string& way) {
    std::size_t from = all.size();
    while (from > 0 && all[from - 1].is_faster()) --from;
    if (from == all.size()) return fmt::format("{} is not shown to pay at {} objects", way, all.back().objects);
    return fmt::format("{} pays from {} objects on{}", way, all[from].objects, from == 0 ? ", the fewest tried" : "");
}

std::string finding_of_paying(const Rows& rows, const std::string& series) {
    const Rows some = of_series(rows, series);
    const Ratios tree = ratios(some, kNoAccel, kBvhWay), grid = ratios(some, kNoAccel, kGridWay);
    if (tree.empty()) return fmt::format("{}: nothing was rendered without an accelerator.", series);
    if (series == kNamed)
        return fmt::format(
            "Without an accelerator the scenes that were named take {} times as long as with bvh, {} "
            "times as long as with grid.",
            ratios_text(tree), ratios_text(grid));
    return fmt::format(
        "{}: against testing all objects, {}, {}; at {} objects none takes {} times as long as bvh, {} "
        "times as long as grid.",
        series, pays_from(tree, kBvhWay), pays_from(grid, kGridWay), tree.back().objects, text_of(tree.back().times),
        text_of(grid.back().times));
}

// Which of two ways is the faster, over all groups.
std::string finding_of_two(const Rows& rows, const std::string& way, const std::string& other) {
    const Ratios all = ratios(rows, way, other);
    if (all.empty()) return fmt::format("No scene has a ratio of {} to {}.", way, other);
    const auto faster = std::ranges::count_if(all, &Ratio::is_faster),
               slower = std::ranges::count_if(all, &Ratio::is_slower);
    return fmt::format("{0} is faster than {1} in {2} of {3}, slower in {4}{5}; time of {1} over {0}: {6}.", other, way,
                       faster, all.size(), slower,
                       faster + slower < std::ssize(all)
                           ? fmt::format(", not told apart in {}", std::ssize(all) - faster - slower)
                           : "",
                       ratios_text(all));
}

std::string finding_of_growth(const std::vector<Growth>& all, const std::string& series) {
    const auto some = where(all, [&](const Growth& one) { return one.series == series; });
    return fmt::format(
        "{}: what a ray takes grows as the objects to the power of {}; ten times the objects take {} "
        "times as long.",
        series,
        joined(some, ", ",
               [](const Growth& one) {
                   return fmt::format("{} ({}, {} to {} objects)", text_of(one.time), one.way, one.from, one.to);
               }),
        joined(some, ", ",
               [](const Growth& one) { return fmt::format("{:.2f} ({})", std::pow(10, one.time.mean), one.way); }));
}

// Of the most objects of a series: what grid and tree take beside the scene, and how long to make them.
std::string finding_of_memory(const Rows& rows, const std::string& series) {
    const Rows made =
        where(of_series(rows, series), [](const Row& row) { return row.is_counted() && row.way() != kNoAccel; });
    const Row& most = *std::ranges::max_element(made, {}, &Row::objects);
    const Rows some = where(made, [&](const Row& row) { return row.group() == most.group(); });
    const auto objects = static_cast<double>(most.objects());
    return finding("accel", "memory", "group"_a = most.group(), "scene"_a = most.scene_bytes() / objects,
                   "ways"_a = joined(some, ", ", [&](const Row& row) {
                       return fmt::format(
                           "{} takes {:.1f} bytes an object and is made in {:.3g} ms, the time of {:.2g} renders",
                           row.way(), row.accel_bytes() / objects, row.build_ms(), row.build_ms() / row.mean_ms());
                   }));
}

std::string finding_of_left_out(const std::vector<LeftOut>& all) {
    return fmt::format("Not rendered without an accelerator: {}.", joined(all, ", ", [](const LeftOut& one) {
                           return fmt::format("{} ({} objects, about {:.0f} s)", one.group, one.objects,
                                              one.predicted_s);
                       }));
}

// Runs of Embree whose rays are not raya's.
Runs other_work(const Rows& rows) {
    Runs others;
    for (const Row& row : of_way(rows, kEmbreeWay))
        for (const AccelRun& run : row.runs)
            for (const Row& ours : of_way(of_series(rows, row.series()), kBvhWay))
                for (const AccelRun& beside : ours.runs)
                    if (beside.group == run.group && beside.seed == run.seed && !same_rays(beside, run))
                        others.push_back(run);
    return others;
}

std::vector<std::string> findings_of_embree(const Rows& rows, const AccelRuns& all) {
    if (!all.has_peer) return {sentence("accel", "no embree")};
    std::vector<std::string> findings;
    if (!of_way(rows, kEmbreeWay).empty()) findings.push_back(finding_of_two(rows, kEmbreeWay, kBvhWay));
    if (const Runs others = other_work(rows); !others.empty())
        findings.push_back(
            fmt::format("Embree traces more or fewer rays by over one in a thousand, and has no ratio, "
                        "in {}.",
                        joined(others, ", ", [](const AccelRun& run) {
                            return run.seed > 0 ? fmt::format("{} (seed {})", run.group, run.seed) : run.group;
                        })));
    if (!all.peer_failures.empty())
        findings.push_back(fmt::format("Embree was not measured in {}.", fmt::join(all.peer_failures, "; ")));
    return findings;
}

std::vector<std::string> findings_of(const Rows& rows, const std::vector<Growth>& growth, const AccelRuns& all) {
    std::vector<std::string> findings;
    const auto series = distinct(rows, &Row::series);
    for (const std::string& one : series) findings.push_back(finding_of_paying(rows, one));
    findings.push_back(finding_of_two(rows, kGridWay, kBvhWay));
    for (const std::string& one : distinct(growth, &Growth::series)) findings.push_back(finding_of_growth(growth, one));
    for (const std::string& one : series) findings.push_back(finding_of_memory(rows, one));
    if (!all.left_out.empty()) findings.push_back(finding_of_left_out(all.left_out));
    for (std::string& one : findings_of_embree(rows, all)) findings.push_back(std::move(one));
    return findings;
}

// Nothing where there is none: of a single scene no interval, of Embree no count.
Cell shown(bool there, double value) { return there ? Cell(value) : Cell("-"); }
Cell interval(bool there, const Estimate& e) { return shown(there && e.has_interval(), e.half_width); }

StudyTable table_of_rows(const Rows& rows) {
    return table_of("accel", "Each number of objects and way", rows,
                    {{"scene", &Row::group},
                     {"objects", &Row::objects},
                     {"way", &Row::way},
                     {"scenes", &Row::scenes},
                     {"tests a ray", [](const Row& row) { return shown(row.is_counted(), row.tests().mean); }},
                     {"tests +-", [](const Row& row) { return interval(row.is_counted(), row.tests()); }},
                     {"steps a ray", [](const Row& row) { return shown(row.is_counted(), row.steps().mean); }},
                     {"steps +-", [](const Row& row) { return interval(row.is_counted(), row.steps()); }},
                     {"best", &Row::mean_ms, "ms"},
                     {"best +-", [](const Row& row) { return interval(true, row.best_ms()); }, "ms"},
                     {"median", &Row::median_ms, "ms"},
                     {"a ray", &Row::ns_a_ray, "ns"},
                     {"build", [](const Row& row) { return shown(row.way() != kNoAccel, row.build_ms()); }, "ms"},
                     {"memory", [](const Row& row) { return shown(row.is_counted(), row.pe_kb()); }, "KB"}});
}

StudyTable table_of_scenes(const Runs& runs) {
    return table_of("accel-scenes", "Each scene and way", runs,
                    {{"scene", &AccelRun::group},
                     {"seed", &AccelRun::seed},
                     {"objects", &AccelRun::objects},
                     {"way", &AccelRun::way},
                     {"rays", &AccelRun::rays},
                     {"tests", [](const AccelRun& run) { return test_count(run.events); }},
                     {"steps", [](const AccelRun& run) { return run.events[RAYA_STEPS]; }},
                     {"best", [](const AccelRun& run) { return run.time.min_ms; }, "ms"},
                     {"median", [](const AccelRun& run) { return run.time.median_ms; }, "ms"},
                     {"samples", [](const AccelRun& run) { return run.time.runs; }},
                     {"build", &AccelRun::build_ms, "ms"},
                     {"scene words", &AccelRun::scene_words},
                     {"accelerator words", &AccelRun::accel_words}},
                    false);
}

StudyTable table_of_growth(const std::vector<Growth>& growth) {
    return table_of("accel-growth", "Exponent of objects in what a ray takes", growth,
                    {{"scenes", &Growth::series},
                     {"way", &Growth::way},
                     {"from", &Growth::from, "objects"},
                     {"to", &Growth::to, "objects"},
                     {"time", [](const Growth& one) { return one.time.mean; }},
                     {"time +-", [](const Growth& one) { return interval(true, one.time); }},
                     {"tests", [](const Growth& one) { return shown(one.is_counted, one.tests.mean); }},
                     {"tests +-", [](const Growth& one) { return interval(one.is_counted, one.tests); }}});
}

std::vector<StudyPlot> plots_of(const Rows& rows) {
    std::vector<StudyPlot> plots;
    for (const std::string& series : distinct(rows, &Row::series))
        plots.push_back({"accel-" + series, "Time against the number of objects: " + series, "objects",
                         "best time of a render (ms)", Axes::kLogBoth,
                         lines(of_series(rows, series), &Row::way, &Row::objects, &Row::mean_ms,
                               series == kNamed ? PlotStyle::kPoints : PlotStyle::kLine)});
    const Rows counted = where(rows, is_counted);
    const PlotStyle style = rows.front().series() == kNamed ? PlotStyle::kPoints : PlotStyle::kLine;
    plots.push_back({"accel-tests", "Tests a ray against the number of objects", "objects", "tests a ray",
                     Axes::kLogBoth, lines(counted, &Row::line, &Row::objects, &Row::mean_tests, style)});
    plots.push_back({"accel-memory", "What a PE holds against the number of objects", "objects",
                     "scene with grid or tree (KB)", Axes::kLogBoth,
                     lines(counted, &Row::line, &Row::objects, &Row::pe_kb, style)});
    return plots;
}

std::vector<AccelScene> own_scenes() {
    std::vector<AccelScene> scenes;
    for (int level = 1; level <= kHighestBallsLevel; ++level)
        scenes.push_back({kBalls, fmt::format("balls {}", level), 0, [level] { return generate_balls(level); }});
    for (const int spheres : {10, 100, 1'000, 10'000, 100'000})
        for (std::uint64_t seed = 1; seed <= kSeeds; ++seed)
            scenes.push_back({kRandom, fmt::format("random {}", spheres), seed,
                              [spheres, seed] { return generate_random(spheres, seed); }});
    return scenes;
}

std::vector<AccelScene> named_scenes(const Scenes& named) {
    std::vector<AccelScene> scenes;
    for (const LabelledScene& one : named)
        scenes.push_back({kNamed, one.label, 0, [scene = one.scene] { return scene; }});
    return scenes;
}

}  // namespace

StudyPage accel_page(const AccelSettings& settings, const AccelRuns& all) {
    const Rows rows = rows_of(all.runs);
    const std::vector<Growth> growth = growth_of(rows);
    const bool own = rows.front().series() != kNamed;
    StudyPage page = page_about(
        "accel",
        {{"size", settings.side}, {"bounces", settings.bounces}, {"rounds", settings.rounds}, {"format", "fp32"}},
        {{"tile", tile_side(settings.side)},
         {"enough", fmt::format("{}", settings.enough_s)},
         {"bearable", fmt::format("{}", settings.bearable_s)},
         {"fitted", kFittedFrom},
         {"scenes", own ? "SPD's balls, each level nine times the spheres of the one before; and spheres scattered at "
                          "random over a cube, some of them mirrors, several seeds of each number."
                        : "The scenes that were named."}});
    page.findings = findings_of(rows, growth, all);
    page.tables = {table_of_rows(rows), table_of_scenes(all.runs)};
    if (!growth.empty()) page.tables.push_back(table_of_growth(growth));
    page.plots = plots_of(rows);
    return page;
}

StudyPage study_accel(Laboratory& lab, const Scenes& scenes) {
    const AccelSettings settings{.side = lab.size(256)};
    AccelBench bench(lab.session(), settings, program_beside_this("embree_peer"));
    for (const AccelScene& scene : scenes.empty() ? own_scenes() : named_scenes(scenes)) bench.measure(scene);
    return accel_page(settings, bench.runs());
}

}  // namespace raya
