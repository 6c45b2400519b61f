// 1 to 4096 transputers: how much faster, how even, how far do packets go, and what is it that stops the gain?
#include "host/study/prose.hpp"
#include "host/study/rows.hpp"
#include "host/study/studies.hpp"
#include "host/study/torus_runs.hpp"

namespace raya {
namespace {

// So short that the queues of 4096 nodes are no burden, and long enough for the project's scenes.
constexpr std::uint32_t kQueue = 256;
constexpr double kHalf = 0.5;  // an efficiency

// A machine of a series.
struct Row : TorusRun {
    std::string scene;
    bool fixed;          // the same voxels on all machines of the series, else one a node
    TorusTime one = {};  // of the series' one node

    std::string links() const { return links_name(plan.links); }
    std::string voxels() const { return fixed ? sides_text(plan.voxels) : "one a node"; }
    double overlapped() const { return one.overlapped_ms / overlapped_ms(); }  // speed-up
    double stepwise() const { return one.stepwise_ms / stepwise_ms(); }
    double efficiency() const { return overlapped() / nodes(); }
    double balance() const { return result.load.efficiency; }
    double per_pixel(std::uint64_t count) const {
        return static_cast<double>(count) / static_cast<double>(result.events[RAYA_PRIMARY]);
    }

    const char* waits_for() const {
        if (root_link_ms >= overlapped_ms()) return "the root's link";
        if (root_processor_ms >= overlapped_ms()) return nodes() > 1 ? "the root" : "its one node";
        return time.links_ms >= overlapped_ms() ? "a link" : "a node";
    }
};

// The machines of one kind on one scene, each with twice the nodes of the one before, from 1 on.
using Series = std::vector<Row>;

// Three of each scene.
struct SceneSeries {
    Series three, two, fixed;  // a voxel a node on three dimensions, on two, and the fixed voxels
};

// `known`: another series; where it has the very same machine that is not rendered again.
Series series_of(Session& session, const LabelledScene& scene, const NodesSettings& s, bool fixed, Links links,
                 const Series& known = {}) {
    Series series;
    for (std::uint32_t nodes = 1; nodes <= s.most; nodes *= 2) {
        if (!series.empty() && series.back().supersteps() * nodes > s.most_launches) break;
        const TorusPlan plan{.nodes = near_cube(nodes),
                             .voxels = fixed ? Divisions{s.sides, s.sides, s.sides} : near_cube(nodes),
                             .links = links,
                             .queue = kQueue};
        const auto same = std::ranges::find_if(known, [&](const Row& row) {
            return row.plan.nodes == plan.nodes && row.plan.voxels == plan.voxels && row.plan.links == links;
        });
        Row row{same != known.end() ? TorusRun(*same) : run_on_torus(session, scene, s.size, plan), scene.label, fixed};
        row.one = series.empty() ? row.time : series.front().one;
        series.push_back(std::move(row));
    }
    return series;
}

SceneSeries series_of(Session& session, const LabelledScene& scene, const NodesSettings& s) {
    const Series three = series_of(session, scene, s, false, Links::kTorus3d);
    return {three, series_of(session, scene, s, false, Links::kTorus2d, three),
            series_of(session, scene, s, true, Links::kTorus3d, three)};
}

StudyTable table_of_machines(const Series& all) {
    return table_of("nodes", "Every machine", all,
                    {{"scene", &Row::scene},
                     {"voxels", &Row::voxels},
                     {"links", &Row::links},
                     {"nodes", &Row::nodes},
                     {"overlapped", &Row::overlapped_ms, "ms"},
                     {"stepwise", &Row::stepwise_ms, "ms"},
                     {"speed-up, overlapped", &Row::overlapped},
                     {"speed-up, stepwise", &Row::stepwise},
                     {"efficiency, overlapped", &Row::efficiency},
                     {"u", &Row::imbalance},
                     {"hops a packet", &Row::hops_per_packet},
                     {"supersteps", &Row::supersteps},
                     {"busiest link", &Row::busiest_link_bytes, "bytes"},
                     {"tests a ray", &Row::tests_per_ray},
                     {"steps a ray", &Row::steps_per_ray},
                     {"rays thrown away", &Row::discarded},
                     {"waits for", &Row::waits_for}});
}

// Speed-up of one scene: both bounds, with the same voxels and with one a node.
StudyPlot speedup_plot(const Series& fixed, const Series& one, std::size_t number) {
    const std::string voxels = fixed.front().voxels();
    return {fmt::format("nodes-speedup-{}", number),
            fmt::format("Speed-up of {}, 3-D torus", one.front().scene),
            "nodes",
            "speed-up, modelled",
            Axes::kLogBoth,
            {line(voxels + ", overlapped", fixed, &Row::nodes, &Row::overlapped),
             line(voxels + ", stepwise", fixed, &Row::nodes, &Row::stepwise),
             line("a voxel a node, overlapped", one, &Row::nodes, &Row::overlapped),
             line("a voxel a node, stepwise", one, &Row::nodes, &Row::stepwise),
             line("as the nodes", fixed, &Row::nodes, &Row::nodes)}};
}

std::vector<StudyPlot> plots_of(const std::vector<SceneSeries>& scenes) {
    std::vector<StudyPlot> plots;
    StudyPlot hops{"nodes-hops", "Links that a packet takes, a voxel a node", "nodes", "hops a packet", Axes::kLogX};
    StudyPlot balance{"nodes-balance", "Balance of computing, 3-D torus", "nodes", "mean load / largest load",
                      Axes::kLogBoth};
    for (const auto& [three, two, fixed] : scenes) {
        plots.push_back(speedup_plot(fixed, three, plots.size() + 1));
        for (const Series& s : {three, two})
            hops.series.push_back(
                line(s.front().scene + ", " + s.front().links(), s, &Row::nodes, &Row::hops_per_packet));
        balance.series.push_back(line(three.front().scene + ", a voxel a node", three, &Row::nodes, &Row::balance));
        balance.series.push_back(
            line(fixed.front().scene + ", " + fixed.front().voxels(), fixed, &Row::nodes, &Row::balance));
    }
    plots.insert(plots.end(), {hops, balance});
    return plots;
}

std::string finding_of_speedup(const Series& s) {
    const Row& best = least(s, &Row::overlapped_ms);
    std::size_t half = 0;  // up to which machine at least half of the nodes' power is used
    while (half + 1 < s.size() && s[half + 1].efficiency() >= kHalf) ++half;
    return fmt::format(
        "{}, {} voxels on every machine: {} nodes are fastest, {:.1f} times as fast as one (overlapped; stepwise "
        "{:.1f} times), and what they wait for is {}. Half of the nodes' power or more is used up to {} nodes.",
        best.scene, best.voxels(), best.nodes(), best.overlapped(), best.stepwise(), best.waits_for(), s[half].nodes());
}

std::string finding_of_voxels(const Series& one, const Series& fixed) {
    const Row &best = least(one, &Row::overlapped_ms), &first = one.front();
    return fmt::format(
        "{}, one voxel a node: {} nodes are {:.0f} times as fast as one, but that one has no grid: {:.1f} times as "
        "many tests a ray, {:.1f} beside {:.1f}. With one node and {} voxels it is {:.0f} times as fast already.",
        first.scene, best.nodes(), best.overlapped(), first.tests_per_ray() / std::max(1e-9, best.tests_per_ray()),
        first.tests_per_ray(), best.tests_per_ray(), fixed.front().voxels(),
        first.overlapped_ms() / fixed.front().overlapped_ms());
}

std::string finding_of_links(const Series& three, const Series& two) {
    std::vector<double> ratios;
    for (std::size_t i = 0; i < std::min(three.size(), two.size()); ++i)
        ratios.push_back(two[i].overlapped_ms() / three[i].overlapped_ms());
    const Row &a = three[ratios.size() - 1], &b = two[ratios.size() - 1];
    return fmt::format(
        "{}, 2-D against 3-D torus with {} nodes: {:.2f} hops a packet for {:.2f}, {} supersteps for {}, {:.2f} times "
        "the bytes over the busiest link; overlapped it takes {:.2f} times as long, of all numbers of nodes {:.2f} to "
        "{:.2f}.",
        a.scene, a.nodes(), b.hops_per_packet(), a.hops_per_packet(), b.supersteps(), a.supersteps(),
        static_cast<double>(b.busiest_link_bytes()) / std::max(1.0, static_cast<double>(a.busiest_link_bytes())),
        ratios.back(), std::ranges::min(ratios), std::ranges::max(ratios));
}

std::string finding_of_balance(const Series& one, const Series& fixed) {
    const auto of_64 = [](const Series& s) -> const Row& {
        const auto found = std::ranges::find(s, 64, &Row::nodes);
        return found == s.end() ? s.back() : *found;
    };
    const Row &a = of_64(one), &b = of_64(fixed);
    const Divisions& voxels = b.plan.voxels;
    return fmt::format(
        "{}, balance: u of {} nodes is {:.2f} with a voxel each and {:.2f} with {} voxels laid out cyclically, {} a "
        "node; of {} nodes {:.2f}.",
        a.scene, a.nodes(), a.imbalance(), b.imbalance(), b.voxels(), voxels[0] * voxels[1] * voxels[2] / b.nodes(),
        fixed.back().nodes(), fixed.back().imbalance());
}

// The machine of each series that throws most rays away.
std::string finding_of_making(const Series& one, const Series& fixed) {
    const auto text = [](const Series& s) {
        const Row& most = *std::ranges::max_element(s, {}, [](const Row& row) { return row.discarded(); });
        return fmt::format("{:.1f} with {} ({} nodes)", 1 + most.per_pixel(most.discarded()),
                           most.fixed ? most.voxels() + " voxels laid out cyclically" : "a voxel each", most.nodes());
    };
    return fmt::format(
        "{}: nodes that make their own primary rays make up to {} for each that is kept, up to {}; what is thrown away "
        "is charged.",
        one.front().scene, text(one), text(fixed));
}

}  // namespace

StudyPage nodes_page(Session& session, const Scenes& scenes, const NodesSettings& settings) {
    const auto all = each(scenes, [&](const LabelledScene& scene) { return series_of(session, scene, settings); });
    const std::string voxels = sides_text({settings.sides, settings.sides, settings.sides});
    StudyPage page = page_about("nodes",
                                {{"scenes", each(scenes, &LabelledScene::label)},
                                 {"size", settings.size},
                                 {"nodes", settings.most},
                                 {"voxels", voxels},
                                 {"queue", kQueue},
                                 {"format", "fp32"},
                                 {"bounces", machine_named("torus").bounces}},
                                {{"launches", settings.most_launches}});
    Series machines;
    for (const auto& [three, two, fixed] : all) {
        for (const Series& s : {three, fixed}) {
            const Row& best = least(s, &Row::overlapped_ms);
            page.comparisons.push_back(
                {fmt::format("{}, {}: best speed-up", best.scene, best.voxels()), "", std::nullopt, best.overlapped(),
                 fmt::format("modelled, overlapped, {} nodes; Yoshitani & Yamazaki measured none", best.nodes())});
        }
        page.findings.insert(page.findings.end(),
                             {finding_of_speedup(fixed), finding_of_voxels(three, fixed), finding_of_links(three, two),
                              finding_of_balance(three, fixed), finding_of_making(three, fixed)});
        for (const Series& s : {three, two, fixed}) machines.insert(machines.end(), s.begin(), s.end());
    }
    page.clock = sentence("torus", "clock");
    page.news = {sentence("nodes", "news")};
    page.tables = {table_of_machines(machines)};
    page.plots = plots_of(all);
    return page;
}

StudyPage study_nodes(Laboratory& lab, const Scenes& scenes) {
    NodesSettings settings;
    settings.size = lab.size(settings.size);
    return nodes_page(lab.session(), scenes.empty() ? Scenes{even_scene(8320), balls_scene(3)} : scenes, settings);
}

}  // namespace raya
