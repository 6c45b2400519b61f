// Fig. 4: 64 transputers, 64 to 8320 objects. Is random slower than even, is it for the copies, and does time grow as
// the objects do?
#include "host/study/objects.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <set>

#include "host/study/object_scenes.hpp"
#include "host/study/studies.hpp"
#include "host/study/torus_runs.hpp"

namespace raya {
namespace {

constexpr std::uint32_t kSides = kObjectSides;  // nodes along each axis too
const std::vector<int> kCounts = {64, 192, 256, 512, 1024, 8320};
constexpr int kSeeds = 3;
constexpr double kNoticed = 1.02;  // times as long: slower

enum { kEven, kRandom, kWithin, kKinds };
constexpr const char* kNames[kKinds] = {"even", "random", "random, none astride"};

// Means over the scenes of one kind and number of objects.
struct Figures {
    double copies = 0, tests = 0, tests_per_ray = 0, steps_per_ray = 0, imbalance = 0;
    double overlapped_ms = 0, stepwise_ms = 0, compute_ms = 0, root_ms = 0, measured_ms = 0;
    // Of primary rays alone: how many hit; of those that meet the box, how many end in the first voxel, hit or out of
    // the box, and through how many voxels they go. Even and random alone.
    double hit_share = 0, first_share = 0, primary_steps = 0;
};

struct Row {
    int objects = 0;
    std::array<Figures, kKinds> of;
};

TorusPlan plan_of_paper() {
    TorusPlan plan;
    plan.nodes = plan.voxels = {kSides, kSides, kSides};
    plan.links = Links::kTorus2d;
    plan.bounces = 0;
    return plan;
}

// Without lights there are no shadow rays, and every event is a primary ray's.
void add_primary_rays(Figures& f, Session& session, Scene scene, std::uint32_t size, double weight) {
    scene.lights.clear();
    std::set<std::uint32_t> gone_on;  // pixels whose rays left the voxel by which they came in
    const TorusRun run =
        run_on_torus(session, {scene.name, scene}, size, plan_of_paper(), [&](const PacketRecord& record) {
            if (raya_state_kind(record.head[RAYA_PACKET_STATE]) == RAYA_KIND_PRIMARY)
                gone_on.insert(record.head[RAYA_PACKET_PIXEL]);
        });
    const EventCounts& e = run.result.events;
    const double walks = std::max(1.0, static_cast<double>(e[RAYA_WALKS]));
    f.hit_share += weight * static_cast<double>(e[RAYA_PRIMARY_HITS]) / static_cast<double>(e[RAYA_PRIMARY]);
    f.first_share += weight * (1 - static_cast<double>(gone_on.size()) / walks);
    f.primary_steps += weight * static_cast<double>(e[RAYA_STEPS]) / walks;
}

void add_run(Figures& f, Session& session, const Scene& scene, std::uint32_t size, double weight) {
    const TorusRun run = run_on_torus(session, {scene.name, scene}, size, plan_of_paper());
    f.copies += weight * static_cast<double>(run.result.copies);
    f.tests += weight * static_cast<double>(run.tests());
    f.tests_per_ray += weight * run.tests_per_ray();
    f.steps_per_ray += weight * run.steps_per_ray();
    f.imbalance += weight * run.result.load.imbalance;
    f.overlapped_ms += weight * run.time.overlapped_ms;
    f.stepwise_ms += weight * run.time.stepwise_ms;
    f.compute_ms += weight * run.time.compute_ms;
    f.root_ms += weight * run.root_ms();
    f.measured_ms += weight * run.measured_ms();
}

Row row_of(Session& session, int objects, std::uint32_t size, int seeds) {
    Row row{objects, {}};
    const Scene even = moved_within(even_scene(objects).scene);
    add_run(row.of[kEven], session, touching_walls(even), size, 1);
    add_primary_rays(row.of[kEven], session, touching_walls(even), size, 1);
    for (int seed = 1; seed <= seeds; ++seed) {
        const Scene random = scattered(even, static_cast<std::uint64_t>(seed));
        add_run(row.of[kRandom], session, touching_walls(random), size, 1.0 / seeds);
        add_primary_rays(row.of[kRandom], session, touching_walls(random), size, 1.0 / seeds);
        add_run(row.of[kWithin], session, touching_walls(moved_within(random)), size, 1.0 / seeds);
    }
    return row;
}

StudyTable main_table(const std::vector<Row>& rows) {
    StudyTable table{
        "objects",
        "Time and work for each number of objects",
        {"objects", "kind", "objects a voxel", "copies", "tests", "tests a ray", "steps a ray", "u", "overlapped (ms)",
         "stepwise (ms)", "busiest node computes (ms)", "the root alone (ms)", "measured (ms)"},
        {},
        true};
    for (const Row& row : rows)
        for (int kind = 0; kind < kKinds; ++kind) {
            const Figures& f = row.of[kind];
            table.rows.push_back({std::int64_t{row.objects}, kNames[kind], row.objects / std::pow(kSides, 3), f.copies,
                                  f.tests, f.tests_per_ray, f.steps_per_ray, f.imbalance, f.overlapped_ms,
                                  f.stepwise_ms, f.compute_ms, f.root_ms, f.measured_ms});
        }
    return table;
}

StudyTable primary_table(const std::vector<Row>& rows) {
    StudyTable table{"objects-primary",
                     "How deep primary rays go",
                     {"objects", "kind", "hit (% of primary rays)", "end in the first voxel (% of those in the box)",
                      "voxels a ray in the box"},
                     {},
                     true};
    for (const Row& row : rows)
        for (const int kind : {kEven, kRandom}) {
            const Figures& f = row.of[kind];
            table.rows.push_back(
                {std::int64_t{row.objects}, kNames[kind], 100 * f.hit_share, 100 * f.first_share, f.primary_steps});
        }
    return table;
}

StudyPlot plot_of(const std::vector<Row>& rows, const std::string& name, const std::string& title,
                  const std::string& y_label, bool log_y, const std::vector<int>& kinds, double Figures::*figure) {
    StudyPlot plot{name, title, "objects", y_label, true, log_y, {}};
    for (const int kind : kinds) {
        plot.series.push_back({kNames[kind], {}, {}, PlotStyle::kLine});
        for (const Row& row : rows) {
            plot.series.back().x.push_back(row.objects);
            plot.series.back().y.push_back(row.of[kind].*figure);
        }
    }
    return plot;
}

std::vector<StudyPlot> plots_of(const std::vector<Row>& rows) {
    const std::vector<int> all = {kEven, kRandom, kWithin};
    StudyPlot time = plot_of(rows, "objects", "Time against the number of objects, overlapped", "modelled ms", true,
                             all, &Figures::overlapped_ms);
    PlotSeries linear{"as the objects, from the even scene's first", {}, {}, PlotStyle::kLine};
    for (const Row& row : rows) {
        linear.x.push_back(row.objects);
        linear.y.push_back(rows.front().of[kEven].overlapped_ms * row.objects / rows.front().objects);
    }
    time.series.push_back(linear);
    StudyPlot tests = plot_of(rows, "objects-tests", "Tests a ray against the number of objects", "tests a ray", true,
                              all, &Figures::tests_per_ray);
    StudyPlot depth = plot_of(rows, "objects-depth", "How deep primary rays go", "voxels a ray in the box", false,
                              {kEven, kRandom}, &Figures::primary_steps);
    return {time, tests, depth};
}

// A figure of one kind over that of another, of every number of objects.
std::vector<double> ratios(const std::vector<Row>& rows, double Figures::*figure, int kind, int other) {
    std::vector<double> all;
    for (const Row& row : rows) all.push_back(row.of[kind].*figure / row.of[other].*figure);
    return all;
}

std::string times_text(const std::vector<double>& all) {
    std::vector<std::string> words;
    for (const double one : all) words.push_back(fmt::format("{:.2f}", one));
    return fmt::format("{}", fmt::join(words, ", "));
}

std::string finding_of_random(const std::vector<Row>& rows) {
    const std::vector<double> all = ratios(rows, &Figures::overlapped_ms, kRandom, kEven);
    const auto slower = std::count_if(all.begin(), all.end(), [](double ratio) { return ratio > 1; });
    std::vector<int> objects;
    for (const Row& row : rows) objects.push_back(row.objects);
    return fmt::format(
        "Random objects are slower than even ones for {} of {} numbers of objects: they take {} times as long "
        "(overlapped; {} objects).",
        slower, all.size(), times_text(all), fmt::join(objects, ", "));
}

// Of the numbers of objects for which random is slower: for how many the copies take the greater part of what it takes
// more.
std::string copies_text(const std::vector<double>& random, const std::vector<double>& within) {
    std::size_t slower = 0, copies = 0;
    for (std::size_t i = 0; i < random.size(); ++i) {
        if (random[i] < kNoticed) continue;
        ++slower;
        copies += random[i] - within[i] > within[i] - 1;
    }
    if (slower == 0) return "No number of objects is slower by 2 % or more when random.";
    return fmt::format(
        "Where random is slower by 2 % or more, the copies take the greater part of it for {} of {} numbers of "
        "objects; the rest is that voxels hold unequal numbers.",
        copies, slower);
}

std::string finding_of_copies(const std::vector<Row>& rows) {
    const std::vector<double> random = ratios(rows, &Figures::overlapped_ms, kRandom, kEven),
                              within = ratios(rows, &Figures::overlapped_ms, kWithin, kEven);
    const Figures &first = rows.front().of[kRandom], &last = rows.back().of[kRandom];
    return fmt::format(
        "Is it the copies? Random objects are registered {:.2f} times each where there are {} and {:.2f} times where "
        "there are {}. Moved until none lies astride, they take {} times as long as even ones. {}",
        1 + first.copies / rows.front().objects, rows.front().objects, 1 + last.copies / rows.back().objects,
        rows.back().objects, times_text(within), copies_text(random, within));
}

std::string finding_of_growth(const std::vector<Row>& rows, int kind) {
    const Figures &first = rows.front().of[kind], &last = rows.back().of[kind];
    const double objects = double(rows.back().objects) / rows.front().objects,
                 time = last.overlapped_ms / first.overlapped_ms, tests = last.tests_per_ray / first.tests_per_ray;
    const bool linear = std::abs(time / objects - 1) < 0.1;
    return fmt::format(
        "{}: {:.0f} times the objects take {:.1f} times the time and {:.1f} times the tests a ray, so time {} as the "
        "objects. A primary ray in the box goes through {:.2f} voxels where there are {} objects and {:.2f} where "
        "there are {}; {:.0f} % and {:.0f} % end in the first one.",
        kNames[kind], objects, time, tests, linear ? "grows" : "does not grow", first.primary_steps,
        rows.front().objects, last.primary_steps, rows.back().objects, 100 * first.first_share, 100 * last.first_share);
}

std::string finding_of_root(const std::vector<Row>& rows) {
    std::vector<int> bound;
    for (const Row& row : rows)
        if (row.of[kEven].root_ms >= row.of[kEven].overlapped_ms) bound.push_back(row.objects);
    if (bound.empty()) return "In no even scene is it the root that the machine waits for.";
    return fmt::format(
        "With {} even objects the machine waits for the root, which takes in every contribution: there the time is "
        "that of the returns, not of the objects.",
        fmt::join(bound, ", "));
}

std::vector<Comparison> comparisons_of(const std::vector<Row>& rows) {
    std::vector<Comparison> all;
    for (const Row& row : rows)
        all.push_back({fmt::format("random / even, {} objects", row.objects),
                       "",
                       {},
                       row.of[kRandom].overlapped_ms / row.of[kEven].overlapped_ms,
                       "modelled, overlapped; Fig. 4 prints no numbers: \"random is slower\""});
    return all;
}

std::vector<std::string> method_of(std::uint32_t size, int seeds) {
    return {
        fmt::format("64 nodes, 4 x 4 x 4, on an 8 x 8 torus of four links a node, one voxel each; {} x {} pixels, "
                    "primary and shadow rays alone, one light, matt spheres; every node makes the primary rays that "
                    "enter at its voxel. Modelled on T805s from what is counted; measured: what this machine takes to "
                    "carry that machine out.",
                    size, size),
        "Even: every voxel holds as many spheres, each within its voxel.",
        fmt::format("Random: the even scene's spheres, their radii, surfaces, light and view, about centres drawn from "
                    "the cube and moved into it where they stick out; means of {} scenes.",
                    seeds),
        "Random, none astride: the random spheres moved, each by little more than its radius, until each lies within "
        "the voxel of its centre. As many lie in each voxel, but no sphere is in two: what tells copies from crowds.",
        "In all three the outermost spheres touch the sides of one cube, so that all have the same voxels. "
        "Registration "
        "takes each for larger by up to a 16th of a voxel's side, for the rounding of rays from afar; even spheres and "
        "those moved keep that far from the sides of their voxels where they have the room.",
        "How deep primary rays go is counted in a render without lights."};
}

}  // namespace

StudyPage objects_page(Session& session, const std::vector<int>& counts, std::uint32_t size, int seeds) {
    std::vector<Row> rows;
    for (const int count : counts) rows.push_back(row_of(session, count, size, seeds));
    StudyPage page;
    page.name = "objects";
    page.title = "Fig. 4: time against the number of objects, on 64 transputers";
    page.question = "Are random objects slower than even ones, is it for their copies, and does time grow linearly?";
    page.method = method_of(size, seeds);
    page.settings = {{"nodes", "4x4x4"}, {"voxels", "4x4x4"}, {"links", "torus2d"}, {"inject", "all"},  {"size", size},
                     {"bounces", 0},     {"format", "fp32"},  {"seeds", seeds},     {"objects", counts}};
    page.comparisons = comparisons_of(rows);
    page.tables = {main_table(rows), primary_table(rows)};
    page.plots = plots_of(rows);
    page.findings = {finding_of_random(rows), finding_of_copies(rows), finding_of_growth(rows, kEven),
                     finding_of_growth(rows, kRandom), finding_of_root(rows)};
    return page;
}

StudyPage study_objects(Laboratory& lab, const std::vector<LabelledScene>& scenes) {
    StudyPage page = objects_page(lab.session(), kCounts, lab.size(96), kSeeds);
    if (!scenes.empty())
        page.method.push_back(
            "The scenes that were named are not in it: the study makes its own, as the paper's were.");
    return page;
}

}  // namespace raya
