// The root makes all primary rays, as Yoshitani & Yamazaki have it, or all nodes do: from how many nodes on does the
// root hold them up?
#include "host/study/prose.hpp"
#include "host/study/rows.hpp"
#include "host/study/studies.hpp"
#include "host/study/torus_runs.hpp"

namespace raya {
namespace {

constexpr double kPart = 1.1;  // times as long: more than this and the two ways have parted

// One machine, with one way of making primary rays.
struct Row : TorusRun {
    std::string way;  // "root" or "all"

    std::uint64_t queue_max() const { return result.queue_max; }
    double root_share() const { return 100 * (root_ms() / overlapped_ms()); }  // %
    bool waits_for_root() const { return root_ms() >= overlapped_ms(); }
};
using Rows = std::vector<Row>;

Rows rows_of(Session& session, const LabelledScene& scene, std::uint32_t size, std::uint32_t most) {
    Rows rows;
    for (std::uint32_t nodes = 1; nodes <= most; nodes *= 2)
        for (const Injection way : {Injection::kRoot, Injection::kAll}) {
            TorusPlan plan{.nodes = near_cube(nodes), .voxels = near_cube(nodes), .inject = way};
            rows.push_back({run_on_torus(session, scene, size, plan), way == Injection::kRoot ? "root" : "all"});
        }
    return rows;
}

Rows of_way(const Rows& rows, const std::string& way) {
    return where(rows, [&](const Row& row) { return row.way == way; });
}

StudyTable table_of_rows(const Rows& rows) {
    return table_of("inject", "The root or all nodes make the primary rays", rows,
                    {{"nodes", &Row::nodes},
                     {"inject", &Row::way},
                     {"supersteps", &Row::supersteps},
                     {"overlapped", &Row::overlapped_ms, "ms"},
                     {"stepwise", &Row::stepwise_ms, "ms"},
                     {"the root's processor", &Row::root_processor_ms, "ms"},
                     {"the root's busiest link", &Row::root_link_ms, "ms"},
                     {"root / overlapped", &Row::root_share, "%"},
                     {"busiest link", &Row::busiest_link_bytes, "bytes"},
                     {"packets", &Row::packets},
                     {"rays thrown away", &Row::discarded},
                     {"hops a packet", &Row::hops_per_packet},
                     {"most packets in a queue", &Row::queue_max}});
}

std::vector<StudyPlot> plots_of(const Rows& rows) {
    StudyPlot time{"inject", "Time against the number of nodes", "nodes", "modelled ms", Axes::kLogBoth};
    for (const char* way : {"root", "all"}) {
        const Rows own = of_way(rows, way);
        time.series.push_back(line(std::string(way) + ", overlapped", own, &Row::nodes, &Row::overlapped_ms));
        time.series.push_back(line(std::string(way) + ", stepwise", own, &Row::nodes, &Row::stepwise_ms));
    }
    return {time,
            {"inject-root", "The root's share of the time", "nodes", "root / overlapped (%)", Axes::kLogX,
             lines(rows, &Row::way, &Row::nodes, &Row::root_share)},
            {"inject-supersteps", "Supersteps", "nodes", "supersteps", Axes::kLogBoth,
             lines(rows, &Row::way, &Row::nodes, &Row::supersteps)}};
}

// The fewest nodes, two or more, from which on the machine waits for its root with every number of nodes.
std::string bound_text(const Rows& rows) {
    std::uint32_t from = 0;
    for (const Row& row : rows)
        if (row.nodes() > 1) from = !row.waits_for_root() ? 0 : from > 0 ? from : row.nodes();
    return from > 0 ? fmt::format("from {} nodes on", from) : "not with the most nodes";
}

std::string finding_of_root(const Rows& root, const Rows& all) {
    return fmt::format(
        "The whole machine waits for its root, overlapped: where the root makes all primary rays {}, where all nodes "
        "do {}.",
        bound_text(root), bound_text(all));
}

std::string finding_of_limit(const Rows& root, const Rows& all) {
    const Row &by_root = least(root, &Row::overlapped_ms), &by_all = least(all, &Row::overlapped_ms);
    const double one = all.front().overlapped_ms();
    return fmt::format(
        "Injection by the root ends at {:.0f} ms on {} nodes, {:.1f} times as fast as one node; by all nodes at {:.0f} "
        "ms on {}, {:.1f} times.",
        by_root.overlapped_ms(), by_root.nodes(), one / by_root.overlapped_ms(), by_all.overlapped_ms(), by_all.nodes(),
        one / by_all.overlapped_ms());
}

std::string finding_of_parting(const Rows& root, const Rows& all) {
    std::size_t parted = 0;
    const auto ratio = [&](std::size_t i) { return root[i].overlapped_ms() / all[i].overlapped_ms(); };
    while (parted < all.size() && ratio(parted) <= kPart) ++parted;
    const std::string last = fmt::format("with {} nodes the root's way takes {:.2f} times as long", all.back().nodes(),
                                         ratio(all.size() - 1));
    if (parted == all.size()) return fmt::format("The two ways never part by more than 10 %: {}.", last);
    return fmt::format("The two ways part by more than 10 % at {} nodes: {:.2f} times as long; {}.",
                       all[parted].nodes(), ratio(parted), last);
}

std::string finding_of_making(const Row& all) {
    const auto rays = static_cast<double>(all.result.events[RAYA_PRIMARY]);
    return fmt::format(
        "{} nodes that make their own primary rays make {:.1f} for each that they keep, all of which they are charged "
        "for: the other rays of their windows enter elsewhere.",
        all.nodes(), 1 + static_cast<double>(all.discarded()) / rays);
}

std::string finding_of_supersteps(const Row& root, const Row& all) {
    return fmt::format(
        "Stepwise the root's way takes {:.2f} times as long with {} nodes, in {} supersteps against {}: the root makes "
        "no more rays at a time than an eighth of its queue holds.",
        root.stepwise_ms() / all.stepwise_ms(), root.nodes(), root.supersteps(), all.supersteps());
}

}  // namespace

StudyPage inject_page(Session& session, const LabelledScene& scene, std::uint32_t size, std::uint32_t most) {
    const Rows rows = rows_of(session, scene, size, most), root = of_way(rows, "root"), all = of_way(rows, "all");
    StudyPage page = page_about("inject", {{"scene", scene.label},
                                           {"size", size},
                                           {"nodes", most},
                                           {"links", "torus3d"},
                                           {"format", "fp32"},
                                           {"bounces", machine_named("torus").bounces}});
    for (const Row& row : rows)
        if (row.nodes() == 64 || row.nodes() == rows.back().nodes())
            page.comparisons.push_back({fmt::format("root's share of the time, {} nodes, {}", row.nodes(), row.way),
                                        "%", std::nullopt, row.root_share(), "modelled, overlapped"});
    page.findings = {finding_of_root(root, all), finding_of_limit(root, all), finding_of_parting(root, all),
                     finding_of_supersteps(root.back(), all.back()), finding_of_making(all.back())};
    page.clock = sentence("torus", "clock");
    page.news = {sentence("inject", "news")};
    page.tables = {table_of_rows(rows)};
    page.plots = plots_of(rows);
    return page;
}

StudyPage study_inject(Laboratory& lab, const Scenes& scenes) {
    return inject_page(lab.session(), scenes.empty() ? even_scene(8320) : scenes.front(), lab.size(64), 512);
}

}  // namespace raya
