// 1 to 4096 transputers: how much faster, how even, how far do packets go, and what is it that stops the gain?
#include "host/study/nodes.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "host/study/studies.hpp"
#include "host/study/torus_runs.hpp"

namespace raya {
namespace {

// So short that the queues of 4096 nodes are no burden, and long enough for the project's scenes.
constexpr std::uint32_t kQueue = 256;
constexpr double kHalf = 0.5;  // an efficiency

// The machines of one kind on one scene, each with twice the nodes of the one before, from 1 on.
struct Series {
    std::string scene;
    bool fixed = false;  // the same voxels on all machines, else one a node
    Links links = Links::kTorus3d;
    std::vector<TorusRun> runs;

    double speedup(std::size_t i, double TorusTime::*bound) const {
        return runs.front().time.*bound / (runs[i].time.*bound);
    }
    double overlapped(std::size_t i) const { return speedup(i, &TorusTime::overlapped_ms); }
    double stepwise(std::size_t i) const { return speedup(i, &TorusTime::stepwise_ms); }
    double efficiency(std::size_t i) const { return overlapped(i) / runs[i].nodes(); }
};

// `known`: another series; where it has the very same machine that is not rendered again.
Series series_of(Session& session, const LabelledScene& scene, const NodesSettings& s, bool fixed, Links links,
                 const Series& known) {
    Series series{scene.label, fixed, links, {}};
    for (std::uint32_t nodes = 1; nodes <= s.most; nodes *= 2) {
        if (!series.runs.empty() && series.runs.back().result.supersteps.size() * nodes > s.most_launches) break;
        TorusPlan plan;
        plan.nodes = near_cube(nodes);
        plan.voxels = fixed ? Divisions{s.sides, s.sides, s.sides} : plan.nodes;
        plan.links = links;
        plan.queue = kQueue;
        const auto same = std::find_if(known.runs.begin(), known.runs.end(), [&](const TorusRun& run) {
            return run.plan.nodes == plan.nodes && run.plan.voxels == plan.voxels && run.plan.links == links;
        });
        series.runs.push_back(same != known.runs.end() ? *same : run_on_torus(session, scene, s.size, plan));
    }
    return series;
}

// Three of each scene: a voxel a node on three dimensions, on two, and the fixed voxels.
constexpr std::size_t kThreeD = 0, kTwoD = 1, kFixed = 2, kSeries = 3;

std::vector<Series> all_series(Session& session, const std::vector<LabelledScene>& scenes, const NodesSettings& s) {
    std::vector<Series> all;
    for (const LabelledScene& scene : scenes) {
        const Series one = series_of(session, scene, s, false, Links::kTorus3d, {});
        all.push_back(one);
        all.push_back(series_of(session, scene, s, false, Links::kTorus2d, one));
        all.push_back(series_of(session, scene, s, true, Links::kTorus3d, one));
    }
    return all;
}

std::string voxels_name(const Series& series) {
    return series.fixed ? sides_text(series.runs.front().plan.voxels) : "one a node";
}

const char* waits_for(const TorusRun& run) {
    if (run.root_link_ms >= run.time.overlapped_ms) return "the root's link";
    if (run.root_processor_ms >= run.time.overlapped_ms) return run.nodes() > 1 ? "the root" : "its one node";
    return run.time.links_ms >= run.time.overlapped_ms ? "a link" : "a node";
}

StudyTable table_of(const std::vector<Series>& all) {
    StudyTable table{"nodes",
                     "Every machine",
                     {"scene", "voxels", "links", "nodes", "overlapped (ms)", "stepwise (ms)", "speed-up, overlapped",
                      "speed-up, stepwise", "efficiency, overlapped", "u", "hops a packet", "supersteps",
                      "busiest link (bytes)", "tests a ray", "steps a ray", "waits for"},
                     {},
                     true};
    const auto whole = [](std::uint64_t count) { return static_cast<std::int64_t>(count); };
    for (const Series& s : all)
        for (std::size_t i = 0; i < s.runs.size(); ++i) {
            const TorusRun& run = s.runs[i];
            table.rows.push_back({s.scene, voxels_name(s), links_name(s.links), std::int64_t{run.nodes()},
                                  run.time.overlapped_ms, run.time.stepwise_ms, s.overlapped(i), s.stepwise(i),
                                  s.efficiency(i), run.result.load.imbalance, run.hops_per_packet(),
                                  whole(run.result.supersteps.size()), whole(run.busiest_link_bytes()),
                                  run.tests_per_ray(), run.steps_per_ray(), waits_for(run)});
        }
    return table;
}

template <typename Figure>
PlotSeries line_of(const Series& series, const std::string& label, Figure figure) {
    PlotSeries line{label, {}, {}, PlotStyle::kLine};
    for (std::size_t i = 0; i < series.runs.size(); ++i) {
        line.x.push_back(series.runs[i].nodes());
        line.y.push_back(figure(i));
    }
    return line;
}

// Speed-up of one scene: both bounds, with the same voxels and with one a node.
StudyPlot speedup_plot(const std::vector<Series>& all, std::size_t scene) {
    const Series &fixed = all[scene * kSeries + kFixed], &one = all[scene * kSeries + kThreeD];
    StudyPlot plot{fmt::format("nodes-speedup-{}", scene + 1),
                   fmt::format("Speed-up of {}, 3-D torus", one.scene),
                   "nodes",
                   "speed-up, modelled",
                   true,
                   true,
                   {}};
    plot.series = {
        line_of(fixed, voxels_name(fixed) + ", overlapped", [&](std::size_t i) { return fixed.overlapped(i); }),
        line_of(fixed, voxels_name(fixed) + ", stepwise", [&](std::size_t i) { return fixed.stepwise(i); }),
        line_of(one, "a voxel a node, overlapped", [&](std::size_t i) { return one.overlapped(i); }),
        line_of(one, "a voxel a node, stepwise", [&](std::size_t i) { return one.stepwise(i); }),
        line_of(fixed, "as the nodes", [&](std::size_t i) { return static_cast<double>(fixed.runs[i].nodes()); })};
    return plot;
}

std::vector<StudyPlot> plots_of(const std::vector<Series>& all) {
    std::vector<StudyPlot> plots;
    for (std::size_t scene = 0; scene < all.size() / kSeries; ++scene) plots.push_back(speedup_plot(all, scene));
    StudyPlot hops{
        "nodes-hops", "Links that a packet takes, a voxel a node", "nodes", "hops a packet", true, false, {}};
    StudyPlot balance{
        "nodes-balance", "Balance of computing, 3-D torus", "nodes", "mean load / largest load", true, true, {}};
    for (const Series& s : all) {
        if (!s.fixed)
            hops.series.push_back(line_of(s, fmt::format("{}, {}", s.scene, links_name(s.links)),
                                          [&](std::size_t i) { return s.runs[i].hops_per_packet(); }));
        if (s.links == Links::kTorus3d)
            balance.series.push_back(
                line_of(s, fmt::format("{}, {}", s.scene, s.fixed ? voxels_name(s) : "a voxel a node"),
                        [&](std::size_t i) { return s.runs[i].result.load.efficiency; }));
    }
    plots.push_back(hops);
    plots.push_back(balance);
    return plots;
}

std::size_t fastest(const Series& s) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < s.runs.size(); ++i)
        if (s.runs[i].time.overlapped_ms < s.runs[best].time.overlapped_ms) best = i;
    return best;
}

std::string chief_finding(const Series& s) {
    const std::size_t best = fastest(s);
    std::size_t half = 0;  // up to which machine at least half of the nodes' power is used
    while (half + 1 < s.runs.size() && s.efficiency(half + 1) >= kHalf) ++half;
    return fmt::format(
        "{}, {} voxels on every machine: {} nodes are fastest, {:.1f} times as fast as one (overlapped; stepwise "
        "{:.1f} "
        "times), and what they wait for is {}. Half of the nodes' power or more is used up to {} nodes.",
        s.scene, voxels_name(s), s.runs[best].nodes(), s.overlapped(best), s.stepwise(best), waits_for(s.runs[best]),
        s.runs[half].nodes());
}

std::string finding_of_voxels(const Series& one, const Series& fixed) {
    const std::size_t best = fastest(one);
    const TorusRun& run = one.runs[best];
    const double tests = one.runs.front().tests_per_ray() / std::max(1e-9, run.tests_per_ray());
    return fmt::format(
        "{}, one voxel a node: {} nodes are {:.0f} times as fast as one, but that one has no grid: {:.1f} times as "
        "many "
        "tests a ray, {:.1f} beside {:.1f}. With one node and {} voxels it is {:.0f} times as fast already.",
        one.scene, run.nodes(), one.overlapped(best), tests, one.runs.front().tests_per_ray(), run.tests_per_ray(),
        voxels_name(fixed), one.runs.front().time.overlapped_ms / fixed.runs.front().time.overlapped_ms);
}

std::string finding_of_links(const Series& three, const Series& two) {
    const std::size_t last = std::min(three.runs.size(), two.runs.size()) - 1;
    const TorusRun &a = three.runs[last], &b = two.runs[last];
    std::vector<double> ratios;
    for (std::size_t i = 0; i <= last; ++i)
        ratios.push_back(two.runs[i].time.overlapped_ms / three.runs[i].time.overlapped_ms);
    const auto [least, most] = std::minmax_element(ratios.begin(), ratios.end());
    return fmt::format(
        "{}, 2-D against 3-D torus with {} nodes: {:.2f} hops a packet for {:.2f}, {} supersteps for {}, {:.2f} times "
        "the bytes over the busiest link; overlapped it takes {:.2f} times as long, of all numbers of nodes {:.2f} to "
        "{:.2f}.",
        three.scene, a.nodes(), b.hops_per_packet(), a.hops_per_packet(), b.result.supersteps.size(),
        a.result.supersteps.size(),
        static_cast<double>(b.busiest_link_bytes()) / std::max(1.0, static_cast<double>(a.busiest_link_bytes())),
        ratios.back(), *least, *most);
}

std::string finding_of_balance(const Series& one, const Series& fixed) {
    const auto at = [](const Series& s, std::uint32_t nodes) -> const TorusRun& {
        for (const TorusRun& run : s.runs)
            if (run.nodes() == nodes) return run;
        return s.runs.back();
    };
    const TorusRun &a = at(one, 64), &b = at(fixed, 64);
    return fmt::format(
        "{}, balance: u of {} nodes is {:.2f} with a voxel each and {:.2f} with {} voxels laid out cyclically, {} a "
        "node; of {} nodes {:.2f}.",
        one.scene, a.nodes(), a.result.load.imbalance, b.result.load.imbalance, voxels_name(fixed),
        b.plan.voxels[0] * b.plan.voxels[1] * b.plan.voxels[2] / b.nodes(), fixed.runs.back().nodes(),
        fixed.runs.back().result.load.imbalance);
}

std::vector<std::string> findings_of(const std::vector<Series>& all) {
    std::vector<std::string> findings;
    for (std::size_t at = 0; at < all.size(); at += kSeries) {
        findings.push_back(chief_finding(all[at + kFixed]));
        findings.push_back(finding_of_voxels(all[at + kThreeD], all[at + kFixed]));
        findings.push_back(finding_of_links(all[at + kThreeD], all[at + kTwoD]));
        findings.push_back(finding_of_balance(all[at + kThreeD], all[at + kFixed]));
    }
    return findings;
}

std::vector<Comparison> comparisons_of(const std::vector<Series>& all) {
    std::vector<Comparison> comparisons;
    for (const Series& s : all)
        if (s.links == Links::kTorus3d)
            comparisons.push_back(
                {fmt::format("{}, {}: best speed-up", s.scene, voxels_name(s)),
                 "",
                 {},
                 s.overlapped(fastest(s)),
                 fmt::format("modelled, overlapped, {} nodes; the paper measured none", s.runs[fastest(s)].nodes())});
    return comparisons;
}

std::vector<std::string> method_of(const NodesSettings& settings, const std::string& voxels) {
    return {
        fmt::format("{} x {} pixels on 1, 2, 4, ... nodes, their sides as alike as powers of two allow; fp32, all "
                    "nodes make primary rays, queues of {} packets. The paper "
                    "measured no speed-up.",
                    settings.size, settings.size, kQueue),
        fmt::format("Two ways to cut the scene: one voxel a node, as the paper does, and {} voxels laid out cyclically "
                    "on any number of nodes. With the latter all machines do the same work, so their speed-up is that "
                    "of the nodes alone; with the former it is that of a finer grid as well.",
                    voxels),
        "Modelled on T805s from what is counted. Overlapped: the busiest processor or link, no one ever waiting for "
        "another; stepwise: every superstep waits for its busiest node, then for its busiest link. The truth lies "
        "between. A processor has its part in each message at either end; u and tests are of computing alone.",
        "2-D: slabs of nodes beside one another, four links a node as a T805 has them; 3-D: six.",
        fmt::format(
            "A series ends where supersteps times nodes would come to more than {}: rays that have to visit all "
            "voxels, such as those from far away on a plane, make very many supersteps.",
            settings.most_launches)};
}

}  // namespace

StudyPage nodes_page(Session& session, const std::vector<LabelledScene>& scenes, const NodesSettings& settings) {
    const std::vector<Series> all = all_series(session, scenes, settings);
    const std::string voxels = sides_text({settings.sides, settings.sides, settings.sides});
    StudyPage page;
    page.name = "nodes";
    page.title = fmt::format("The torus machine from one node to {}", settings.most);
    page.question = "How many transputers are worth having, and what is it that they wait for?";
    page.method = method_of(settings, voxels);
    for (const LabelledScene& scene : scenes) page.settings["scenes"].push_back(scene.label);
    page.settings["size"] = settings.size;
    page.settings["nodes"] = settings.most;
    page.settings["voxels"] = voxels;
    page.settings["queue"] = kQueue;
    page.settings["format"] = "fp32";
    page.settings["bounces"] = machine_named("torus").bounces;
    page.comparisons = comparisons_of(all);
    page.tables = {table_of(all)};
    page.plots = plots_of(all);
    page.findings = findings_of(all);
    return page;
}

StudyPage study_nodes(Laboratory& lab, const std::vector<LabelledScene>& scenes) {
    const std::vector<LabelledScene> own = {even_scene(8320), balls_scene(3)};
    NodesSettings settings;
    settings.size = lab.size(settings.size);
    return nodes_page(lab.session(), scenes.empty() ? own : scenes, settings);
}

}  // namespace raya
