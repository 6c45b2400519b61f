// Fig. 4: 64 transputers, 64 to 8320 objects. Is random slower than even, is it for the copies, and does time grow as
// the objects do?
#include <cmath>
#include <set>

#include "host/scene/spread.hpp"
#include "host/study/prose.hpp"
#include "host/study/rows.hpp"
#include "host/study/studies.hpp"
#include "host/study/torus_runs.hpp"

namespace raya {
namespace {

constexpr std::uint32_t kSides = kObjectSides;  // nodes along each axis too
constexpr double kNoticed = 1.02;               // times as long: slower
constexpr const char *kEven = "even", *kRandom = "random", *kWithin = "random, none astride";

// Means over the scenes of one kind and number of objects.
struct Row {
    int objects = 0;
    std::string kind;
    double copies = 0, tests = 0, tests_per_ray = 0, steps_per_ray = 0, imbalance = 0;
    double overlapped_ms = 0, stepwise_ms = 0, compute_ms = 0, root_ms = 0, measured_ms = 0;
    // Of primary rays alone: how many hit; of those that meet the box, how many end in the first voxel, hit or out of
    // the box, and through how many voxels they go. Even and random alone.
    double hit_share = 0, first_share = 0, primary_steps = 0;

    double objects_per_voxel() const { return objects / std::pow(kSides, 3); }
};
using Rows = std::vector<Row>;

TorusPlan plan_of_paper() {
    TorusPlan plan;
    plan.nodes = plan.voxels = {kSides, kSides, kSides};
    plan.links = Links::kTorus2d;
    plan.bounces = 0;
    return plan;
}

// Without lights there are no shadow rays, and every event is a primary ray's.
void add_primary_rays(Row& f, Session& session, Scene scene, std::uint32_t size, double weight) {
    scene.lights.clear();
    std::set<std::uint32_t> gone_on;  // pixels whose rays left the voxel by which they came in
    const TorusRun run =
        run_on_torus(session, {scene.name, scene}, size, plan_of_paper(), [&](const PacketRecord& record) {
            if (raya_state_kind(record.head.state) == RAYA_KIND_PRIMARY) gone_on.insert(record.head.pixel);
        });
    const EventCounts& e = run.result.events;
    const double walks = std::max(1.0, static_cast<double>(e[RAYA_WALKS]));
    f.hit_share += weight * static_cast<double>(e[RAYA_PRIMARY_HITS]) / static_cast<double>(e[RAYA_PRIMARY]);
    f.first_share += weight * (1 - static_cast<double>(gone_on.size()) / walks);
    f.primary_steps += weight * static_cast<double>(e[RAYA_STEPS]) / walks;
}

void add_run(Row& f, Session& session, const Scene& scene, std::uint32_t size, double weight) {
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

// All kinds of one number of objects.
Rows rows_of(Session& session, int objects, std::uint32_t size, int seeds) {
    Row even{objects, kEven}, random{objects, kRandom}, within{objects, kWithin};
    const Scene scene = moved_within(even_scene(objects).scene);
    add_run(even, session, touching_walls(scene), size, 1);
    add_primary_rays(even, session, touching_walls(scene), size, 1);
    for (int seed = 1; seed <= seeds; ++seed) {
        const Scene drawn = scattered(scene, static_cast<std::uint64_t>(seed));
        add_run(random, session, touching_walls(drawn), size, 1.0 / seeds);
        add_primary_rays(random, session, touching_walls(drawn), size, 1.0 / seeds);
        add_run(within, session, touching_walls(moved_within(drawn)), size, 1.0 / seeds);
    }
    return {even, random, within};
}

Rows of_kind(const Rows& rows, const std::string& kind) {
    return where(rows, [&](const Row& row) { return row.kind == kind; });
}

bool has_primary_rays(const Row& row) { return row.kind != kWithin; }

std::vector<StudyTable> tables_of(const Rows& rows) {
    return {table_of("objects", "Time and work for each number of objects", rows,
                     {{"objects", &Row::objects},
                      {"kind", &Row::kind},
                      {"objects a voxel", &Row::objects_per_voxel},
                      {"copies", &Row::copies},
                      {"tests", &Row::tests},
                      {"tests a ray", &Row::tests_per_ray},
                      {"steps a ray", &Row::steps_per_ray},
                      {"u", &Row::imbalance},
                      {"overlapped", &Row::overlapped_ms, "ms"},
                      {"stepwise", &Row::stepwise_ms, "ms"},
                      {"busiest node computes", &Row::compute_ms, "ms"},
                      {"the root alone", &Row::root_ms, "ms"},
                      {"measured", &Row::measured_ms, "ms"}}),
            table_of("objects-primary", "How deep primary rays go", where(rows, has_primary_rays),
                     {{"objects", &Row::objects},
                      {"kind", &Row::kind},
                      {"hit", [](const Row& row) { return 100 * row.hit_share; }, "% of primary rays"},
                      {"end in the first voxel", [](const Row& row) { return 100 * row.first_share; },
                       "% of those in the box"},
                      {"voxels a ray in the box", &Row::primary_steps}})};
}

std::vector<StudyPlot> plots_of(const Rows& rows) {
    const auto plot = [](const char* name, const char* title, const char* y, Axes axes, const Rows& some,
                         double Row::*figure) {
        return StudyPlot{name, title, "objects", y, axes, lines(some, &Row::kind, &Row::objects, figure)};
    };
    StudyPlot time = plot("objects", "Time against the number of objects, overlapped", "modelled ms", Axes::kLogBoth,
                          rows, &Row::overlapped_ms);
    time.series.push_back(line("as the objects, from the even scene's first", of_kind(rows, kEven), &Row::objects,
                               [&](const Row& row) { return rows[0].overlapped_ms * row.objects / rows[0].objects; }));
    return {time,
            plot("objects-tests", "Tests a ray against the number of objects", "tests a ray", Axes::kLogBoth, rows,
                 &Row::tests_per_ray),
            plot("objects-depth", "How deep primary rays go", "voxels a ray in the box", Axes::kLogX,
                 where(rows, has_primary_rays), &Row::primary_steps)};
}

// Time of one kind over that of even objects, of every number of objects.
std::vector<double> ratios(const Rows& rows, const std::string& kind) {
    const Rows even = of_kind(rows, kEven);
    auto times = each(of_kind(rows, kind), &Row::overlapped_ms);
    for (std::size_t i = 0; i < times.size(); ++i) times[i] /= even[i].overlapped_ms;
    return times;
}

std::string times_text(const std::vector<double>& all) {
    return joined(all, ", ", [](double one) { return fmt::format("{:.2f}", one); });
}

std::string finding_of_random(const Rows& rows) {
    const std::vector<double> all = ratios(rows, kRandom);
    return fmt::format(
        "Random objects are slower than even ones for {} of {} numbers of objects: they take {} times as long "
        "(overlapped; {} objects).",
        std::ranges::count_if(all, [](double ratio) { return ratio > 1; }), all.size(), times_text(all),
        joined(of_kind(rows, kEven), ", ", &Row::objects));
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

std::string finding_of_copies(const Rows& rows) {
    const Rows random = of_kind(rows, kRandom);
    const Row &first = random.front(), &last = random.back();
    const std::vector<double> within = ratios(rows, kWithin);
    return fmt::format(
        "Is it the copies? Random objects are registered {:.2f} times each where there are {} and {:.2f} times where "
        "there are {}. Moved until none lies astride, they take {} times as long as even ones. {}",
        1 + first.copies / first.objects, first.objects, 1 + last.copies / last.objects, last.objects,
        times_text(within), copies_text(ratios(rows, kRandom), within));
}

std::string finding_of_growth(const Rows& rows) {
    const Row &first = rows.front(), &last = rows.back();
    const double objects = double(last.objects) / first.objects, time = last.overlapped_ms / first.overlapped_ms;
    return fmt::format(
        "{}: {:.0f} times the objects take {:.1f} times the time and {:.1f} times the tests a ray, so time {} as the "
        "objects. A primary ray in the box goes through {:.2f} voxels where there are {} objects and {:.2f} where "
        "there are {}; {:.0f} % and {:.0f} % end in the first one.",
        first.kind, objects, time, last.tests_per_ray / first.tests_per_ray,
        std::abs(time / objects - 1) < 0.1 ? "grows" : "does not grow", first.primary_steps, first.objects,
        last.primary_steps, last.objects, 100 * first.first_share, 100 * last.first_share);
}

std::string finding_of_root(const Rows& even) {
    const Rows bound = where(even, [](const Row& row) { return row.root_ms >= row.overlapped_ms; });
    if (bound.empty()) return "In no even scene is it the root that the machine waits for.";
    return fmt::format(
        "With {} even objects the machine waits for the root, which takes in every contribution: there the time is "
        "that of the returns, not of the objects.",
        joined(bound, ", ", &Row::objects));
}

}  // namespace

StudyPage objects_page(Session& session, const std::vector<int>& counts, std::uint32_t size, int seeds) {
    Rows rows;
    for (const int count : counts)
        for (Row& row : rows_of(session, count, size, seeds)) rows.push_back(std::move(row));
    const Rows even = of_kind(rows, kEven), random = of_kind(rows, kRandom);
    StudyPage page = page_about("objects", {{"nodes", "4x4x4"},
                                            {"voxels", "4x4x4"},
                                            {"links", "torus2d"},
                                            {"inject", "all"},
                                            {"size", size},
                                            {"bounces", 0},
                                            {"format", "fp32"},
                                            {"seeds", seeds},
                                            {"objects", counts}});
    for (std::size_t i = 0; i < even.size(); ++i)
        page.comparisons.push_back({fmt::format("random / even, {} objects", even[i].objects), "", std::nullopt,
                                    random[i].overlapped_ms / even[i].overlapped_ms,
                                    "modelled, overlapped; Fig. 4 prints no numbers: \"random is slower\""});
    page.findings = {finding_of_random(rows), finding_of_copies(rows), finding_of_growth(even),
                     finding_of_growth(random), finding_of_root(even)};
    page.tables = tables_of(rows);
    page.plots = plots_of(rows);
    return page;
}

StudyPage study_objects(Laboratory& lab, const Scenes& scenes) {
    StudyPage page = objects_page(lab.session(), {64, 192, 256, 512, 1024, 8320}, lab.size(96), 3);
    if (!scenes.empty())
        page.method.push_back(
            "The scenes that were named are not in it: the study makes its own, as the paper's were.");
    return page;
}

}  // namespace raya
