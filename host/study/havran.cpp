#include "host/study/havran.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>

#include "host/scene/generate.hpp"
#include "host/study/grid_papers.hpp"
#include "host/study/studies.hpp"
#include "host/torus/topology.hpp"

namespace raya {
namespace {

constexpr std::uint32_t kUsualSide = 257;  // pixels: every other corner of SPD's 513
constexpr std::uint32_t kSpdSide = 513;
constexpr std::uint32_t kSpdBounces = 4;  // the eye ray is depth 1 of 5
constexpr int kBallsLevel = 4, kLatticeSize = 12;

const paper::UniformGrid* published(const GridRun& run) {
    const auto found =
        std::find_if(std::begin(paper::kHavran), std::end(paper::kHavran), [&](const paper::UniformGrid& grid) {
            return run.label == grid.scene &&
                   std::equal(run.divisions.begin(), run.divisions.end(), std::begin(grid.divisions));
        });
    return found == std::end(paper::kHavran) ? nullptr : found;
}

// Means over all rays, those that miss the box among them.
struct EachRay {
    double tests, steps, steps_beyond_first;

    explicit EachRay(const GridRun& run) {
        const auto rays = static_cast<double>(rays_of(run.events));
        tests = static_cast<double>(tests_of(run.events)) / rays;
        steps = static_cast<double>(run.events[RAYA_STEPS]) / rays;
        steps_beyond_first = steps - static_cast<double>(run.events[RAYA_WALKS]) / rays;
    }
};

std::string name_of(const GridRun& run) { return run.label + " " + sides_text(run.divisions); }

std::vector<Comparison> comparisons_of(const std::vector<GridRun>& runs) {
    std::vector<Comparison> comparisons;
    for (const GridRun& run : runs) {
        const paper::UniformGrid* known = published(run);
        const EachRay each(run);
        const auto printed = [&](double paper::UniformGrid::*figure) {
            return known ? std::optional<double>(known->*figure) : std::nullopt;
        };
        comparisons.push_back(
            {name_of(run) + ": tests a ray", "", printed(&paper::UniformGrid::tests), each.tests, ""});
        comparisons.push_back({name_of(run) + ": steps a ray", "", printed(&paper::UniformGrid::steps), each.steps,
                               fmt::format("{:.2f} without the first voxel of each walk", each.steps_beyond_first)});
    }
    return comparisons;
}

StudyTable rays_table(const std::vector<GridRun>& runs) {
    StudyTable table{"havran",
                     "What was counted",
                     {"scene", "A x B x C", "copies", "eye rays", "reflected", "refracted", "shadow rays", "walks",
                      "tests", "steps", "tests a walk", "steps a walk", "measured (ms)"},
                     {},
                     true};
    for (const GridRun& run : runs) {
        const auto count = [&](std::size_t event) { return static_cast<std::int64_t>(run.events[event]); };
        const auto walks = static_cast<double>(run.events[RAYA_WALKS]);
        table.rows.push_back({run.label, sides_text(run.divisions), static_cast<std::int64_t>(run.copies),
                              count(RAYA_PRIMARY), count(RAYA_REFLECTED), count(RAYA_REFRACTED), count(RAYA_SHADOW),
                              count(RAYA_WALKS), static_cast<std::int64_t>(tests_of(run.events)), count(RAYA_STEPS),
                              static_cast<double>(tests_of(run.events)) / walks,
                              static_cast<double>(run.events[RAYA_STEPS]) / walks, run.measured_ms});
    }
    return table;
}

StudyPlot plot_of(const std::vector<GridRun>& runs) {
    StudyPlot plot{"havran", "Tests against steps a ray", "steps a ray", "tests a ray", true, true, {}};
    PlotSeries printed{"Havran & Sixta", {}, {}, PlotStyle::kPaper};
    for (const GridRun& run : runs) {
        const EachRay each(run);
        if (plot.series.empty() || plot.series.back().label != run.label)
            plot.series.push_back({run.label, {}, {}, PlotStyle::kPoints});
        plot.series.back().x.push_back(each.steps);
        plot.series.back().y.push_back(each.tests);
        if (const paper::UniformGrid* known = published(run)) {
            printed.x.push_back(known->steps);
            printed.y.push_back(known->tests);
        }
    }
    if (!printed.x.empty()) plot.series.push_back(printed);
    return plot;
}

// How near ours come to a published figure.
std::string finding_of(const std::vector<GridRun>& runs, const char* what, double EachRay::*ours,
                       double paper::UniformGrid::*printed) {
    std::vector<std::string> words;
    for (const GridRun& run : runs)
        if (const paper::UniformGrid* known = published(run))
            words.push_back(fmt::format("{:.2f} ({})", EachRay(run).*ours / (known->*printed), name_of(run)));
    if (words.empty()) return fmt::format("{}: none were published for these grids.", what);
    return fmt::format("{} are {} times those that Havran & Sixta publish.", what, fmt::join(words, ", "));
}

// What a finer grid of one scene does, in ours and in theirs: free of how a ray or a test is counted.
std::vector<std::string> findings_of_finer(const std::vector<GridRun>& runs) {
    std::vector<std::string> findings;
    for (std::size_t i = 1; i < runs.size(); ++i) {
        const GridRun &coarse = runs[i - 1], &fine = runs[i];
        if (coarse.label != fine.label) continue;
        const EachRay before(coarse), after(fine);
        std::string text = fmt::format("{}, from {} to {} voxels: tests fall to {:.2f}, steps grow to {:.2f} times",
                                       fine.label, sides_text(coarse.divisions), sides_text(fine.divisions),
                                       after.tests / before.tests, after.steps / before.steps);
        const paper::UniformGrid *was = published(coarse), *is = published(fine);
        if (was && is)
            text += fmt::format("; theirs to {:.2f} and {:.2f}", is->tests / was->tests, is->steps / was->steps);
        findings.push_back(text + ".");
    }
    return findings;
}

std::vector<LabelledScene> spd_scenes() {
    return {{"balls", generate_balls(kBallsLevel)}, {"lattice", generate_lattice(kLatticeSize)}};
}

// Two grids: those published for the scene, or cubes as fine as those for lattice.
std::vector<Divisions> grids_for(const std::string& label) {
    std::vector<Divisions> grids;
    for (const paper::UniformGrid& grid : paper::kHavran)
        if (label == grid.scene) grids.push_back({grid.divisions[0], grid.divisions[1], grid.divisions[2]});
    if (grids.empty()) grids = {{20, 20, 20}, {44, 44, 44}};
    return grids;
}

}  // namespace

StudyPage havran_page(std::uint32_t side, const std::vector<GridRun>& runs) {
    StudyPage page;
    page.name = "havran";
    page.title = "Tests and steps a ray in uniform grids, beside Havran & Sixta 1999";
    page.question = "Does our grid do what others' grids do on the same scenes?";
    page.method = {
        fmt::format("One PE of grande in fp32, {} x {} rays through pixel corners{}, tree depth {} with the eye ray as "
                    "1, as SPD has it. The grid cuts the box of the whole scene.",
                    side, side, side == kSpdSide ? "" : " (SPD: 513 x 513)", kSpdBounces + 1),
        "A ray: every eye, reflected, refracted and shadow ray, whether it meets the box or not. Tests: with spheres, "
        "polygons and cylinders, of any ray. Steps: voxels that rays enter, the first one among them.",
        "Where ours may differ: no mailbox, so that an object in several voxels on a ray's way is tested in each; a "
        "shadow ray ends at the first object that is found to hide the light; objects are registered with a margin for "
        "rounding. What Havran & Sixta do in each of these, and whether they count the first voxel, is not known to "
        "us."};
    page.settings = {{"size", side}, {"bounces", kSpdBounces}, {"sampling", "corners"}, {"format", "fp32"}};
    page.comparisons = comparisons_of(runs);
    page.tables = {rays_table(runs)};
    page.plots = {plot_of(runs)};
    page.findings = {finding_of(runs, "Tests a ray", &EachRay::tests, &paper::UniformGrid::tests),
                     finding_of(runs, "Steps a ray", &EachRay::steps, &paper::UniformGrid::steps)};
    for (const std::string& finding : findings_of_finer(runs)) page.findings.push_back(finding);
    return page;
}

StudyPage study_havran(Laboratory& lab, const std::vector<LabelledScene>& scenes) {
    const std::uint32_t side = lab.size(kUsualSide);
    std::vector<GridRun> runs;
    for (const LabelledScene& scene : scenes.empty() ? spd_scenes() : scenes)
        for (const Divisions& grid : grids_for(scene.label))
            runs.push_back(run_grid(lab.session(), scene, grid,
                                    {.side = side, .bounces = kSpdBounces, .sampling = Sampling::kCorners}));
    return havran_page(side, runs);
}

}  // namespace raya
