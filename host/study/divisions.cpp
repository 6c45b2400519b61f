#include "host/study/divisions.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>

#include "host/machine/machine.hpp"
#include "host/scene/generate.hpp"
#include "host/study/grid_papers.hpp"
#include "host/study/studies.hpp"
#include "host/torus/topology.hpp"

namespace raya {
namespace {

constexpr std::uint32_t kUsualSide = 96;            // pixels
constexpr std::uint32_t kMostPower = 13;            // 8192 divisions
constexpr std::uint32_t kPowers[] = {6, 8, 9, 10};  // of the objects: 64, 256, 512, 1024
constexpr int kTimedRuns = 5;

using Figure = std::function<double(const GridRun&)>;

double tests(const GridRun& run) { return static_cast<double>(tests_of(run.events)); }
double modelled_s(const GridRun& run) { return 1e-3 * t805_ms(run.events); }
double measured_ms(const GridRun& run) { return run.measured_ms; }

// A figure for each render, and what to call it.
struct Column {
    std::string name, title, y_label, optimum;
    Figure figure;
};

const std::vector<Column>& columns() {
    static const std::vector<Column> all = {
        {"divisions-modelled", "Modelled time against divisions", "modelled time of a T805 (s)", "least modelled time",
         modelled_s},
        {"divisions-tests", "Intersection tests against divisions", "intersection tests", "fewest tests", tests},
        {"divisions-measured", "Measured time against divisions", "measured time (ms)", "least measured time",
         measured_ms}};
    return all;
}

// Into how many voxels an object comes.
double voxels_of_object(const GridRun& run) {
    return 1 + static_cast<double>(run.copies) / static_cast<double>(run.objects);
}

// Of equal figures the one with fewer divisions.
const GridRun& least(const DivisionsSeries& series, const Figure& figure) {
    return *std::min_element(series.begin(), series.end(),
                             [&](const GridRun& a, const GridRun& b) { return figure(a) < figure(b); });
}

const GridRun* with_voxels(const DivisionsSeries& series, std::uint64_t voxels) {
    const auto found =
        std::find_if(series.begin(), series.end(), [&](const GridRun& run) { return voxels_of(run) == voxels; });
    return found == series.end() ? nullptr : &*found;
}

StudyPlot plot_of(const Column& column, const std::vector<DivisionsSeries>& all, bool from_paper) {
    StudyPlot plot{column.name, column.title, "divisions", column.y_label, true, true};
    for (const DivisionsSeries& series : all) {
        PlotSeries line{series.front().label, {}, {}, PlotStyle::kLine};
        for (const GridRun& run : series) {
            line.x.push_back(static_cast<double>(voxels_of(run)));
            line.y.push_back(column.figure(run));
        }
        plot.series.push_back(line);
    }
    if (from_paper && column.name == "divisions-modelled")
        plot.series.push_back({"paper, 1024 objects, its machine",
                               {double{paper::kFewDivisions}, double{paper::kManyDivisions}},
                               {paper::kFewDivisionsS, paper::kManyDivisionsS},
                               PlotStyle::kPaper});
    return plot;
}

StudyTable table_of(const std::vector<DivisionsSeries>& all) {
    StudyTable table{"divisions",
                     "Each number of objects and divisions",
                     {"scene", "divisions", "A x B x C", "copies", "rays", "tests", "steps", "tests a ray",
                      "steps a ray", "modelled (s)", "measured (ms)"},
                     {},
                     true};
    for (const DivisionsSeries& series : all)
        for (const GridRun& run : series) {
            const auto whole = [](std::uint64_t value) { return static_cast<std::int64_t>(value); };
            const std::uint64_t rays = rays_of(run.events), steps = run.events[RAYA_STEPS];
            const double each = 1 / static_cast<double>(rays);
            table.rows.push_back({run.label, whole(voxels_of(run)), sides_text(run.divisions), whole(run.copies),
                                  whole(rays), whole(tests_of(run.events)), whole(steps), tests(run) * each,
                                  static_cast<double>(steps) * each, modelled_s(run), run.measured_ms});
        }
    return table;
}

// The figure at 32 divisions over that at 1024.
double fall_of(const DivisionsSeries& series, const Figure& figure) {
    const GridRun *few = with_voxels(series, paper::kFewDivisions), *many = with_voxels(series, paper::kManyDivisions);
    if (few == nullptr || many == nullptr) throw std::logic_error("the paper's divisions are not among the runs");
    return figure(*few) / figure(*many);
}

std::vector<Comparison> comparisons_of(const std::vector<DivisionsSeries>& all, bool from_paper) {
    std::vector<Comparison> comparisons;
    if (from_paper) {
        const DivisionsSeries& most = all.back();
        const std::string what = "32 over 1024 divisions, 1024 objects: ";
        comparisons = {{what + "modelled time", "", paper::kDivisionsFall, fall_of(most, modelled_s), "a T805's"},
                       {what + "measured time", "", paper::kDivisionsFall, fall_of(most, measured_ms), "this device's"},
                       {what + "tests", "", paper::kTestsFall, fall_of(most, tests), "the paper: \"about 1/5\""}};
    }
    for (const Column& column : columns())
        for (const DivisionsSeries& series : all) {
            const GridRun& best = least(series, column.figure);
            const auto paper = from_paper && column.name != "divisions-measured"
                                   ? std::optional<double>(static_cast<double>(best.objects))
                                   : std::nullopt;
            comparisons.push_back({fmt::format("{}, {}", column.optimum, best.label), "divisions", paper,
                                   static_cast<double>(voxels_of(best)), sides_text(best.divisions)});
        }
    return comparisons;
}

std::string finding_of_fall(const DivisionsSeries& most) {
    return fmt::format(
        "1024 objects at 32 divisions, beside 1024: the paper's time is {:.1f} times as long, ours {:.1f} times "
        "modelled "
        "and {:.1f} times measured; the tests are {:.1f} times as many, beside the paper's \"about 1/5\".",
        paper::kDivisionsFall, fall_of(most, modelled_s), fall_of(most, measured_ms), fall_of(most, tests));
}

// Where the optima lie as multiples of the objects, in words.
std::string finding_of_optimum(const Column& column, const std::vector<DivisionsSeries>& all) {
    std::vector<std::string> words;
    std::size_t equal = 0, last = 0;
    for (const DivisionsSeries& series : all) {
        const GridRun& best = least(series, column.figure);
        words.push_back(fmt::format("{} for {}", voxels_of(best), best.label));
        equal += voxels_of(best) == best.objects;
        last += &best == &series.back();
    }
    std::string text = fmt::format("{}: at divisions {}; divisions = objects is it for {} of {}", column.optimum,
                                   fmt::join(words, ", "), equal, all.size());
    if (last > 0) text += fmt::format("; {} at the last division tried, so it may lie beyond", last);
    text[0] = static_cast<char>(std::toupper(text[0]));
    return text + ".";
}

// What is lost by divisions = objects, where it was tried, and how far the objects then are from one voxel each.
std::string finding_of_loss(const std::vector<DivisionsSeries>& all) {
    std::vector<std::string> times, tests_each, voxels;
    for (const DivisionsSeries& series : all)
        if (const GridRun* equal = with_voxels(series, series.front().objects)) {
            times.push_back(
                fmt::format("{:.2f} ({})", modelled_s(*equal) / modelled_s(least(series, modelled_s)), equal->label));
            tests_each.push_back(fmt::format("{:.2f}", tests(*equal) / tests(least(series, tests))));
            voxels.push_back(fmt::format("{:.2f}", voxels_of_object(*equal)));
        }
    if (times.empty()) return "No scene here was cut into as many voxels as it has objects.";
    return fmt::format(
        "Divisions = objects takes {} times the least modelled time and {} times the fewest tests; an object then lies "
        "in {} voxels.",
        fmt::join(times, ", "), fmt::join(tests_each, ", "), fmt::join(voxels, ", "));
}

// How far times rise again behind their least.
std::string finding_of_rise(const std::vector<DivisionsSeries>& all) {
    std::vector<std::string> words;
    for (const DivisionsSeries& series : all)
        words.push_back(fmt::format("{:.2f} ({})", modelled_s(series.back()) / modelled_s(least(series, modelled_s)),
                                    series.front().label));
    return fmt::format("At {} divisions the modelled time is {} times the least.", voxels_of(all.front().back()),
                       fmt::join(words, ", "));
}

// Percent of the modelled time that the events take.
double share_of(const GridRun& run, std::initializer_list<std::size_t> events) {
    EventCounts part{};
    for (const std::size_t event : events) part[event] = run.events[event];
    return 100 * t805_ms(part) / t805_ms(run.events);
}

// Fewer tests come with more steps, and what rays and hits take stays.
std::string finding_of_parts(const DivisionsSeries& series) {
    std::vector<std::string> at, testing, walking;
    for (const GridRun* run :
         {with_voxels(series, paper::kFewDivisions), with_voxels(series, paper::kManyDivisions), &series.back()}) {
        if (run == nullptr) continue;
        at.push_back(fmt::format("{}", voxels_of(*run)));
        testing.push_back(fmt::format(
            "{:.0f}", share_of(*run, {RAYA_SPHERE_TESTS, RAYA_PLANE_TESTS, RAYA_POLYGON_TESTS, RAYA_CONE_TESTS})));
        walking.push_back(fmt::format("{:.0f}", share_of(*run, {RAYA_WALKS, RAYA_STEPS})));
    }
    return fmt::format(
        "{}: at {} divisions, tests take {} % of the modelled time, walking from voxel to voxel {} %; an object lies "
        "in "
        "{:.1f} voxels at the last.",
        series.front().label, fmt::join(at, ", "), fmt::join(testing, ", "), fmt::join(walking, ", "),
        voxels_of_object(series.back()));
}

std::vector<DivisionsSeries> run_all(Laboratory& lab, const std::vector<LabelledScene>& scenes, std::uint32_t side) {
    std::vector<DivisionsSeries> all;
    for (const LabelledScene& scene : scenes) {
        all.emplace_back();
        for (std::uint32_t k = 0; k <= kMostPower; ++k)
            all.back().push_back(
                run_grid(lab.session(), scene, divisions_of_power(k), {.side = side, .runs = kTimedRuns}));
    }
    return all;
}

std::vector<LabelledScene> even_scenes() {
    std::vector<LabelledScene> scenes;
    for (const std::uint32_t k : kPowers) {
        const Divisions d = divisions_of_power(k);
        scenes.push_back(
            {fmt::format("{} objects", 1u << k), generate_uniform(1 << k, {int(d[0]), int(d[1]), int(d[2])})});
    }
    return scenes;
}

}  // namespace

Divisions divisions_of_power(std::uint32_t k) { return {1u << (k + 2) / 3, 1u << (k + 1) / 3, 1u << k / 3}; }

StudyPage divisions_page(std::uint32_t side, const std::vector<DivisionsSeries>& series, bool from_paper) {
    StudyPage page;
    page.name = "divisions";
    page.title = "Fig. 3 of Yoshitani & Yamazaki: time against the number of divisions";
    page.question = "Into how many voxels should one machine cut the space of so many objects?";
    page.method = {
        fmt::format(
            "One PE of grande in fp32, {} x {} pixels, primary and shadow rays; every ray walks through the grid.",
            side, side),
        from_paper
            ? "64 to 1024 matt spheres, one in each of as many voxels of a cube. Our grid cuts the box of the "
              "spheres, which is a little smaller than that cube: some spheres lie across its planes."
            : "The scenes that were named. A x B x C as near to a cube as powers of two allow, whatever the box.",
        "Modelled time: the events that were counted, at what each takes a T805 of 40 ns a cycle, those for packets "
        "among them; no message. Measured time: the least of several, of tracing on this device.",
        "Tests count an object again in each voxel that it shares with others on the way of a ray."};
    page.settings = {{"size", side}, {"bounces", 0}, {"format", "fp32"}};
    for (const DivisionsSeries& one : series)
        page.settings["scenes"].push_back({{"scene", one.front().label}, {"objects", one.front().objects}});
    page.comparisons = comparisons_of(series, from_paper);
    page.tables = {table_of(series)};
    for (const Column& column : columns()) {
        page.plots.push_back(plot_of(column, series, from_paper));
        page.findings.push_back(finding_of_optimum(column, series));
    }
    for (const std::string& finding :
         {finding_of_loss(series), finding_of_rise(series), finding_of_parts(series.back())})
        page.findings.push_back(finding);
    if (from_paper) page.findings.insert(page.findings.begin(), finding_of_fall(series.back()));
    return page;
}

StudyPage study_divisions(Laboratory& lab, const std::vector<LabelledScene>& scenes) {
    const std::uint32_t side = lab.size(kUsualSide);
    return divisions_page(side, run_all(lab, scenes.empty() ? even_scenes() : scenes, side), scenes.empty());
}

}  // namespace raya
