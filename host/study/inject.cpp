// The root makes all primary rays, as in the paper, or all nodes do: from how many nodes on does the root hold them up?
#include "host/study/inject.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "host/study/studies.hpp"
#include "host/study/torus_runs.hpp"

namespace raya {
namespace {

constexpr double kPart = 1.1;  // times as long: more than this and the two ways have parted

enum { kRoot, kAll, kWays };
constexpr const char* kNames[kWays] = {"root", "all"};

struct Row {
    std::uint32_t nodes = 0;
    std::array<TorusRun, kWays> of;
};

std::vector<Row> rows_of(Session& session, const LabelledScene& scene, std::uint32_t size, std::uint32_t most) {
    std::vector<Row> rows;
    for (std::uint32_t nodes = 1; nodes <= most; nodes *= 2) {
        TorusPlan plan;
        plan.nodes = plan.voxels = near_cube(nodes);
        rows.push_back({nodes, {}});
        plan.inject = Injection::kRoot;
        rows.back().of[kRoot] = run_on_torus(session, scene, size, plan);
        plan.inject = Injection::kAll;
        rows.back().of[kAll] = run_on_torus(session, scene, size, plan);
    }
    return rows;
}

// 100 where they are one.
double root_share(const TorusRun& run) { return 100 * (run.root_ms() / run.time.overlapped_ms); }

bool waits_for_root(const TorusRun& run) { return run.root_ms() >= run.time.overlapped_ms; }

// The fewest nodes, two or more, from which on the machine waits for its root with every number of nodes; 0: none.
std::uint32_t bound_from(const std::vector<Row>& rows, int way) {
    std::uint32_t from = 0;
    for (const Row& row : rows)
        if (row.nodes > 1) from = !waits_for_root(row.of[way]) ? 0 : from > 0 ? from : row.nodes;
    return from;
}

StudyTable table_of(const std::vector<Row>& rows) {
    StudyTable table{"inject",
                     "The root or all nodes make the primary rays",
                     {"nodes", "inject", "supersteps", "overlapped (ms)", "stepwise (ms)", "the root's processor (ms)",
                      "the root's busiest link (ms)", "root / overlapped (%)", "busiest link (bytes)", "packets",
                      "hops a packet", "most packets in a queue"},
                     {},
                     true};
    for (const Row& row : rows)
        for (int way = 0; way < kWays; ++way) {
            const TorusRun& run = row.of[way];
            const auto whole = [](std::uint64_t count) { return static_cast<std::int64_t>(count); };
            table.rows.push_back({std::int64_t{row.nodes}, kNames[way], whole(run.result.supersteps.size()),
                                  run.time.overlapped_ms, run.time.stepwise_ms, run.root_processor_ms, run.root_link_ms,
                                  root_share(run), whole(run.busiest_link_bytes()), whole(run.packets()),
                                  run.hops_per_packet(), whole(run.result.queue_max)});
        }
    return table;
}

PlotSeries series_of(const std::vector<Row>& rows, int way, const std::string& label,
                     double (*figure)(const TorusRun&)) {
    PlotSeries series{label, {}, {}, PlotStyle::kLine};
    for (const Row& row : rows) {
        series.x.push_back(row.nodes);
        series.y.push_back(figure(row.of[way]));
    }
    return series;
}

double overlapped(const TorusRun& run) { return run.time.overlapped_ms; }
double stepwise(const TorusRun& run) { return run.time.stepwise_ms; }
double supersteps(const TorusRun& run) { return static_cast<double>(run.result.supersteps.size()); }

std::vector<StudyPlot> plots_of(const std::vector<Row>& rows) {
    StudyPlot time{"inject", "Time against the number of nodes", "nodes", "modelled ms", true, true, {}};
    StudyPlot share{"inject-root", "The root's share of the time", "nodes", "root / overlapped (%)", true, false, {}};
    StudyPlot steps{"inject-supersteps", "Supersteps", "nodes", "supersteps", true, true, {}};
    for (int way = 0; way < kWays; ++way) {
        const std::string name = kNames[way];
        time.series.push_back(series_of(rows, way, name + ", overlapped", overlapped));
        time.series.push_back(series_of(rows, way, name + ", stepwise", stepwise));
        share.series.push_back(series_of(rows, way, name, root_share));
        steps.series.push_back(series_of(rows, way, name, supersteps));
    }
    return {time, share, steps};
}

std::string bound_text(const std::vector<Row>& rows, int way) {
    const std::uint32_t from = bound_from(rows, way);
    return from > 0 ? fmt::format("from {} nodes on", from) : "not with the most nodes";
}

std::string finding_of_root(const std::vector<Row>& rows) {
    return fmt::format(
        "The whole machine waits for its root, overlapped: where the root makes all primary rays {}, where all "
        "nodes "
        "do {}.",
        bound_text(rows, kRoot), bound_text(rows, kAll));
}

// The fastest machine of each way.
const Row& fastest(const std::vector<Row>& rows, int way) {
    return *std::min_element(rows.begin(), rows.end(), [&](const Row& a, const Row& b) {
        return a.of[way].time.overlapped_ms < b.of[way].time.overlapped_ms;
    });
}

std::string finding_of_limit(const std::vector<Row>& rows) {
    const Row &root = fastest(rows, kRoot), &all = fastest(rows, kAll);
    const double one = rows.front().of[kAll].time.overlapped_ms;
    return fmt::format(
        "Injection by the root ends at {:.0f} ms on {} nodes, {:.1f} times as fast as one node; by all nodes at "
        "{:.0f} "
        "ms on {}, {:.1f} times.",
        root.of[kRoot].time.overlapped_ms, root.nodes, one / root.of[kRoot].time.overlapped_ms,
        all.of[kAll].time.overlapped_ms, all.nodes, one / all.of[kAll].time.overlapped_ms);
}

std::string finding_of_parting(const std::vector<Row>& rows) {
    const auto ratio = [](const Row& row) { return overlapped(row.of[kRoot]) / overlapped(row.of[kAll]); };
    const auto parted = std::find_if(rows.begin(), rows.end(), [&](const Row& row) { return ratio(row) > kPart; });
    const std::string last =
        fmt::format("with {} nodes the root's way takes {:.2f} times as long", rows.back().nodes, ratio(rows.back()));
    if (parted == rows.end()) return fmt::format("The two ways never part by more than 10 %: {}.", last);
    return fmt::format("The two ways part by more than 10 % at {} nodes: {:.2f} times as long; {}.", parted->nodes,
                       ratio(*parted), last);
}

std::string finding_of_supersteps(const std::vector<Row>& rows) {
    const Row& last = rows.back();
    return fmt::format(
        "Stepwise the root's way takes {:.2f} times as long with {} nodes, in {} supersteps against {}: the root "
        "makes no more rays at a time than an eighth of its queue holds.",
        stepwise(last.of[kRoot]) / stepwise(last.of[kAll]), last.nodes, supersteps(last.of[kRoot]),
        supersteps(last.of[kAll]));
}

std::vector<Comparison> comparisons_of(const std::vector<Row>& rows) {
    std::vector<Comparison> all;
    for (const Row& row : rows)
        if (row.nodes == 64 || row.nodes == rows.back().nodes)
            for (int way = 0; way < kWays; ++way)
                all.push_back({fmt::format("root's share of the time, {} nodes, {}", row.nodes, kNames[way]),
                               "%",
                               {},
                               root_share(row.of[way]),
                               "modelled, overlapped"});
    return all;
}

}  // namespace

StudyPage inject_page(Session& session, const LabelledScene& scene, std::uint32_t size, std::uint32_t most) {
    const std::vector<Row> rows = rows_of(session, scene, size, most);
    StudyPage page;
    page.name = "inject";
    page.title = "Who makes the primary rays: the root or all nodes";
    page.question = "From how many nodes on does the root hold the machine up?";
    page.method = {
        fmt::format("{} at {} x {} on 1 to {} nodes of a 3-D torus, doubling, one voxel a node, fp32. Root: it makes "
                    "all primary rays, one after another, and sends each to where it enters the box, as the paper has "
                    "it. All: every node makes those that enter at its voxel.",
                    scene.label, size, size, most),
        "Modelled on T805s from what is counted. Overlapped: the busiest processor or link, no one ever waiting for "
        "another; stepwise: every superstep waits for its busiest node, then for its busiest link.",
        "The root's time is the greater of its processor's, computing and messages, and its busiest link's. "
        "Contributions "
        "to pixels come home to the root either way.",
        "One node has the whole scene in one voxel, and is its own root: where more nodes are more than so many times "
        "as "
        "fast, it is the grid's doing."};
    page.settings = {{"scene", scene.label}, {"size", size},     {"nodes", most},
                     {"links", "torus3d"},   {"format", "fp32"}, {"bounces", machine_named("torus").bounces}};
    page.comparisons = comparisons_of(rows);
    page.tables = {table_of(rows)};
    page.plots = plots_of(rows);
    page.findings = {finding_of_root(rows), finding_of_limit(rows), finding_of_parting(rows),
                     finding_of_supersteps(rows)};
    return page;
}

StudyPage study_inject(Laboratory& lab, const std::vector<LabelledScene>& scenes) {
    return inject_page(lab.session(), scenes.empty() ? even_scene(8320) : scenes.front(), lab.size(64), 512);
}

}  // namespace raya
