// Tests and steps a ray in uniform grids, beside Havran & Sixta 1999.
#include <algorithm>

#include "host/scene/generate.hpp"
#include "host/study/grid_run.hpp"
#include "host/study/paper.hpp"
#include "host/study/prose.hpp"
#include "host/study/rows.hpp"
#include "host/study/studies.hpp"

namespace raya {
namespace {

constexpr std::uint32_t kUsualSide = 257;  // pixels: every other corner of SPD's 513
constexpr std::uint32_t kSpdSide = 513;
constexpr std::uint32_t kSpdBounces = 4;  // the eye ray is depth 1 of 5
constexpr int kBallsLevel = 4, kLatticeSize = 12;

// A render, and what was published of its grid.
struct Row {
    GridRun run;
    const paper::UniformGrid* published;  // null: nothing

    std::string scene() const { return run.label; }
    std::string name() const { return run.label + " " + run.sides(); }
    double count(std::size_t event) const { return static_cast<double>(run.events[event]); }
    // Means over all rays, those that miss the box among them.
    double tests() const { return run.tests() / static_cast<double>(run.rays()); }
    double steps() const { return count(RAYA_STEPS) / static_cast<double>(run.rays()); }
    double beyond_first() const { return steps() - count(RAYA_WALKS) / static_cast<double>(run.rays()); }
    double published_tests() const { return published->tests; }
    double published_steps() const { return published->steps; }
};
using Rows = std::vector<Row>;

Row row_of(const GridRun& run) {
    const auto found = std::ranges::find_if(paper::kHavran, [&](const paper::UniformGrid& grid) {
        return run.label == grid.scene && std::ranges::equal(run.divisions, grid.divisions);
    });
    return {run, found == std::end(paper::kHavran) ? nullptr : found};
}

bool is_published(const Row& row) { return row.published != nullptr; }

std::vector<Comparison> comparisons_of(const Rows& rows) {
    std::vector<Comparison> all;
    for (const Row& row : rows) {
        const auto paper = [&](double paper::UniformGrid::*figure) {
            return row.published ? std::optional(row.published->*figure) : std::nullopt;
        };
        all.push_back({row.name() + ": tests a ray", "", paper(&paper::UniformGrid::tests), row.tests()});
        all.push_back({row.name() + ": steps a ray", "", paper(&paper::UniformGrid::steps), row.steps(),
                       fmt::format("{:.2f} without the first voxel of each walk", row.beyond_first())});
    }
    return all;
}

StudyTable table_of_rays(const Rows& rows) {
    const auto counted = [](std::size_t event) { return [=](const Row& row) { return row.run.events[event]; }; };
    return table_of("havran", "What was counted", rows,
                    {{"scene", &Row::scene},
                     {"A x B x C", [](const Row& row) { return row.run.sides(); }},
                     {"copies", [](const Row& row) { return row.run.copies; }},
                     {"eye rays", counted(RAYA_PRIMARY)},
                     {"reflected", counted(RAYA_REFLECTED)},
                     {"refracted", counted(RAYA_REFRACTED)},
                     {"shadow rays", counted(RAYA_SHADOW)},
                     {"walks", counted(RAYA_WALKS)},
                     {"tests", [](const Row& row) { return test_count(row.run.events); }},
                     {"steps", counted(RAYA_STEPS)},
                     {"tests a walk", [](const Row& row) { return row.run.tests() / row.count(RAYA_WALKS); }},
                     {"steps a walk", [](const Row& row) { return row.count(RAYA_STEPS) / row.count(RAYA_WALKS); }},
                     {"measured", [](const Row& row) { return row.run.measured_ms; }, "ms"}});
}

StudyPlot plot_of(const Rows& rows) {
    StudyPlot plot{"havran",       "Tests against steps a ray",
                   "steps a ray",  "tests a ray",
                   Axes::kLogBoth, lines(rows, &Row::scene, &Row::steps, &Row::tests, PlotStyle::kPoints)};
    if (const Rows known = where(rows, is_published); !known.empty())
        plot.series.push_back(
            line("Havran & Sixta", known, &Row::published_steps, &Row::published_tests, PlotStyle::kPaper));
    return plot;
}

// How near ours come to a published figure.
std::string finding_of(const Rows& rows, const char* what, double (Row::*ours)() const, double (Row::*theirs)() const) {
    const Rows known = where(rows, is_published);
    if (known.empty()) return fmt::format("{}: none were published for these grids.", what);
    return fmt::format("{} are {} times those that Havran & Sixta publish.", what,
                       joined(known, ", ", [&](const Row& row) {
                           return fmt::format("{:.2f} ({})", (row.*ours)() / (row.*theirs)(), row.name());
                       }));
}

// What a finer grid of one scene does, in ours and in theirs: free of how a ray or a test is counted.
std::string finding_of_finer(const Row& coarse, const Row& fine) {
    std::string theirs;
    if (is_published(coarse) && is_published(fine))
        theirs = fmt::format("; theirs to {:.2f} and {:.2f}", fine.published->tests / coarse.published->tests,
                             fine.published->steps / coarse.published->steps);
    return fmt::format("{}, from {} to {} voxels: tests fall to {:.2f}, steps grow to {:.2f} times{}.", fine.scene(),
                       coarse.run.sides(), fine.run.sides(), fine.tests() / coarse.tests(),
                       fine.steps() / coarse.steps(), theirs);
}

// Two grids: those published for the scene, or cubes as fine as those for lattice.
std::vector<Divisions> grids_for(const std::string& label) {
    std::vector<Divisions> grids;
    for (const paper::UniformGrid& grid : paper::kHavran)
        if (label == grid.scene) grids.push_back(grid.divisions);
    return grids.empty() ? std::vector<Divisions>{{20, 20, 20}, {44, 44, 44}} : grids;
}

}  // namespace

StudyPage havran_page(std::uint32_t side, const std::vector<GridRun>& runs) {
    const Rows rows = each(runs, row_of);
    StudyPage page =
        page_about("havran", {{"size", side}, {"bounces", kSpdBounces}, {"sampling", "corners"}, {"format", "fp32"}},
                   {{"spd", side == kSpdSide ? "" : " (SPD: 513 x 513)"}, {"depth", kSpdBounces + 1}});
    page.comparisons = comparisons_of(rows);
    page.findings = {finding_of(rows, "Tests a ray", &Row::tests, &Row::published_tests),
                     finding_of(rows, "Steps a ray", &Row::steps, &Row::published_steps)};
    for (std::size_t i = 1; i < rows.size(); ++i)
        if (rows[i - 1].scene() == rows[i].scene()) page.findings.push_back(finding_of_finer(rows[i - 1], rows[i]));
    page.tables = {table_of_rays(rows)};
    page.plots = {plot_of(rows)};
    return page;
}

StudyPage study_havran(Laboratory& lab, const Scenes& scenes) {
    const Scenes own = {{"balls", generate_balls(kBallsLevel)}, {"lattice", generate_lattice(kLatticeSize)}};
    const std::uint32_t side = lab.size(kUsualSide);
    std::vector<GridRun> runs;
    for (const LabelledScene& scene : scenes.empty() ? own : scenes)
        for (const Divisions& grid : grids_for(scene.label))
            runs.push_back(run_grid(lab.session(), scene, grid,
                                    {.side = side, .bounces = kSpdBounces, .sampling = Sampling::kCorners}));
    return havran_page(side, runs);
}

}  // namespace raya
