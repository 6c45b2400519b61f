// G groups of a machine's nodes share the screen, each divides space over its own nodes: which G is best, and which
// does memory forbid? Harada et al. 1995, reference [1] of Yoshitani & Yamazaki.
#include <array>
#include <numeric>

#include "host/model/t805.hpp"
#include "host/model/unit_text.hpp"
#include "host/study/prose.hpp"
#include "host/study/rows.hpp"
#include "host/study/studies.hpp"
#include "host/study/torus_runs.hpp"
#include "kernels/shared/traffic.h"

namespace raya {
namespace {

constexpr std::array kSides = {4u, 8u};  // voxels along each axis, of every group: the paper's, finer

struct Memory {
    const char* name;
    std::uint64_t bytes;
};
constexpr Memory kMemories[] = {{"32 KB", 32 * 1024}, {"4 MB", 4 * 1024 * 1024}};  // of a node: SPA's, a board's

// The whole machine in G groups.
struct Row {
    std::string scene, voxels;
    std::uint32_t groups = 0, nodes = 0;        // nodes of a group
    double overlapped_ms = 0, stepwise_ms = 0;  // of the slowest group
    Load load = {};                             // of the nodes of all groups
    double messages_ms = 0;                     // of the processor that has most of them
    double hops_per_packet = 0, tests_per_ray = 0;
    std::uint64_t supersteps = 0;        // of the group that takes most
    std::uint64_t discarded = 0;         // primary rays that were made and thrown away, of all groups
    std::uint64_t words_bytes = 0;       // of the fullest node: its part of the scene
    std::uint64_t least_bytes = 0;       // ... and the shortest queue and boxes with which it can work
    std::uint64_t with_queue_bytes = 0;  // ... and those that it had here
    double one_node_ms = 0;              // modelled: one node alone, all pixels

    double overlapped() const { return one_node_ms / overlapped_ms; }  // speed-up
    double stepwise() const { return one_node_ms / stepwise_ms; }
    double imbalance() const { return load.imbalance; }
    bool fits(const Memory& memory) const { return least_bytes <= memory.bytes; }
    const char* fits_spa() const { return fits(kMemories[0]) ? "yes" : "no"; }
    const char* fits_board() const { return fits(kMemories[1]) ? "yes" : "no"; }
};

// One scene, one number of voxels: 1, 2, 4, ... groups.
using Rows = std::vector<Row>;

std::uint64_t least_bytes(const TorusRun& run, const LabelledScene& scene) {
    const std::uint32_t queue =
        raya_shortest_queue(static_cast<std::uint32_t>(scene.scene.lights.size()), machine_named("torus").bounces);
    return run.bytes_without_buffers() + node_bytes(0, buffers_for(queue), links_of_node(run.torus));
}

Row row_of(const std::vector<TorusRun>& runs, const LabelledScene& scene, std::uint32_t sides) {
    const TorusRun& first = runs.front();
    Row row{.scene = scene.label,
            .voxels = sides_text({sides, sides, sides}),
            .groups = static_cast<std::uint32_t>(runs.size()),
            .nodes = first.nodes(),
            .words_bytes = first.bytes_without_buffers(),
            .least_bytes = least_bytes(first, scene),
            .with_queue_bytes = first.result.node_bytes};
    std::vector<std::uint64_t> loads;
    std::uint64_t hops = 0, packets = 0, tests = 0, rays = 0;
    for (const TorusRun& run : runs) {
        row.overlapped_ms = std::max(row.overlapped_ms, run.time.overlapped_ms);
        row.stepwise_ms = std::max(row.stepwise_ms, run.time.stepwise_ms);
        row.messages_ms = std::max(row.messages_ms, run.time.messages_ms);
        row.supersteps = std::max<std::uint64_t>(row.supersteps, run.result.supersteps.size());
        loads.insert(loads.end(), run.result.load.per_pe.begin(), run.result.load.per_pe.end());
        row.discarded += run.discarded();
        hops += run.result.hops;
        packets += run.packets();
        tests += run.tests();
        rays += run.rays();
    }
    row.load = load_of(std::move(loads));
    row.hops_per_packet = static_cast<double>(hops) / static_cast<double>(std::max<std::uint64_t>(1, packets));
    row.tests_per_ray = static_cast<double>(tests) / static_cast<double>(std::max<std::uint64_t>(1, rays));
    return row;
}

Rows rows_of(Session& session, const LabelledScene& scene, std::uint32_t size, std::uint32_t nodes,
             std::uint32_t sides) {
    Rows rows;
    for (std::uint32_t groups = 1; groups <= nodes; groups *= 2) {
        const TorusPlan plan{.nodes = near_cube(nodes / groups), .voxels = {sides, sides, sides}};
        rows.push_back(row_of(run_groups(session, scene, size, plan, groups), scene, sides));
    }
    // With a node a group none sends a message or throws a ray away, and what they compute together is what one node
    // alone would compute.
    const std::vector<std::uint64_t>& alone = rows.back().load.per_pe;
    const auto cycles = std::accumulate(alone.begin(), alone.end(), std::uint64_t{0});
    for (Row& row : rows) row.one_node_ms = 1e-6 * kT805CycleNs * static_cast<double>(cycles);
    return rows;
}

std::vector<StudyTable> tables_of(const Rows& rows) {
    return {table_of("hybrid", "Time of the whole machine", rows,
                     {{"scene", &Row::scene},
                      {"voxels", &Row::voxels},
                      {"groups", &Row::groups},
                      {"nodes a group", &Row::nodes},
                      {"overlapped", &Row::overlapped_ms, "ms"},
                      {"stepwise", &Row::stepwise_ms, "ms"},
                      {"speed-up, overlapped", &Row::overlapped},
                      {"speed-up, stepwise", &Row::stepwise},
                      {"u over all nodes", &Row::imbalance},
                      {"most messages", &Row::messages_ms, "ms"},
                      {"hops a packet", &Row::hops_per_packet},
                      {"supersteps", &Row::supersteps},
                      {"tests a ray", &Row::tests_per_ray},
                      {"rays thrown away", &Row::discarded}}),
            table_of("hybrid-memory", "Memory of the fullest node", rows,
                     {{"scene", &Row::scene},
                      {"voxels", &Row::voxels},
                      {"groups", &Row::groups},
                      {"its part of the scene", &Row::words_bytes, "bytes"},
                      {"with the shortest buffers", &Row::least_bytes, "bytes"},
                      {"with the study's", &Row::with_queue_bytes, "bytes"},
                      {"fits 32 KB", &Row::fits_spa},
                      {"fits 4 MB", &Row::fits_board}})};
}

std::vector<StudyPlot> plots_of(const Rows& rows) {
    const auto plot = [&](const char* name, const char* title, const char* y_label, Axes axes, auto figure) {
        const auto label = [](const Row& row) { return row.scene + ", " + row.voxels + " voxels"; };
        return StudyPlot{name, title, "groups G", y_label, axes, lines(rows, label, &Row::groups, figure)};
    };
    StudyPlot memory = plot("hybrid-memory", "The fullest node, with the shortest buffers", "bytes", Axes::kLogBoth,
                            &Row::least_bytes);
    for (const Memory& one : kMemories) {
        const auto bytes = static_cast<double>(one.bytes);
        memory.series.push_back({one.name, {1, double(rows.back().groups)}, {bytes, bytes}});
    }
    return {plot("hybrid", "Speed-up against the number of groups, overlapped", "speed-up, modelled", Axes::kLogX,
                 &Row::overlapped),
            plot("hybrid-stepwise", "Speed-up against the number of groups, stepwise", "speed-up, modelled",
                 Axes::kLogX, &Row::stepwise),
            plot("hybrid-balance", "Imbalance over the nodes of all groups", "u", Axes::kLogX, &Row::imbalance),
            memory};
}

// "G = 4, speed-up 3.1 (2.0 with one group)", of the fastest number of groups.
std::string best_text(const Rows& rows, double Row::*time, double (Row::*speedup)() const) {
    const Row& best = least(rows, time);
    return fmt::format("G = {}, speed-up {:.1f} ({:.1f} with one group)", best.groups, (best.*speedup)(),
                       (rows[0].*speedup)());
}

std::string memory_text(const Rows& rows, const Memory& memory) {
    const Rows fit = where(rows, [&](const Row& row) { return row.fits(memory); });
    if (fit.empty()) return fmt::format("no G, one group needs {} a node", needed_text(rows[0].least_bytes));
    if (fit.size() == rows.size()) return "any G";
    const Row& best = least(fit, &Row::overlapped_ms);
    return fmt::format("G = {}, the best of them {}, speed-up {:.1f}", joined(fit, ", ", &Row::groups), best.groups,
                       best.overlapped());
}

std::vector<std::string> findings_of(const std::vector<Rows>& all) {
    // Of each scene, under its name.
    const auto said = [&](const char* with, auto text) {
        return joined(all, "; ", [&](const Rows& rows) {
            return fmt::format("{}{}: {}", rows[0].scene, fmt::format(fmt::runtime(with), rows[0].voxels), text(rows));
        });
    };
    std::vector<std::string> findings = {
        fmt::format("The best number of groups on {} nodes where memory is no matter, overlapped: {}.",
                    all[0].back().groups,
                    said(" with {} voxels",
                         [](const Rows& rows) { return best_text(rows, &Row::overlapped_ms, &Row::overlapped); })),
        fmt::format("Where every superstep waits for its busiest node and link: {}.",
                    said(", {}", [](const Rows& rows) { return best_text(rows, &Row::stepwise_ms, &Row::stepwise); }))};
    for (const Memory& memory : kMemories)
        findings.push_back(fmt::format("Nodes of {}, with the shortest buffers that work, can hold: {}.", memory.name,
                                       said(", {}", [&](const Rows& rows) { return memory_text(rows, memory); })));
    findings.push_back(fmt::format(
        "u over all nodes, from one group to a group for each node: {}.", said(", {}", [](const Rows& rows) {
            return fmt::format("{:.2f} to {:.2f}", rows.front().imbalance(), rows.back().imbalance());
        })));
    return findings;
}

}  // namespace

StudyPage hybrid_page(Session& session, const Scenes& scenes, std::uint32_t size, std::uint32_t nodes) {
    std::vector<Rows> all;
    for (const LabelledScene& scene : scenes)
        for (const std::uint32_t sides : kSides) all.push_back(rows_of(session, scene, size, nodes, sides));
    Rows rows;
    for (const Rows& some : all) rows.insert(rows.end(), some.begin(), some.end());
    StudyPage page = page_about("hybrid", {{"scenes", each(scenes, &LabelledScene::label)},
                                           {"size", size},
                                           {"nodes", nodes},
                                           {"voxels", kSides},
                                           {"links", "torus3d"},
                                           {"format", "fp32"},
                                           {"bounces", machine_named("torus").bounces}});
    for (const Rows& some : all)
        page.comparisons.push_back({fmt::format("best G, {}, {} voxels", some[0].scene, some[0].voxels), "groups",
                                    std::nullopt, double(least(some, &Row::overlapped_ms).groups),
                                    "modelled, overlapped, whatever the memory"});
    page.clock = sentence("torus", "clock");
    page.news = {sentence("hybrid", "news")};
    page.findings = findings_of(all);
    page.tables = tables_of(rows);
    page.plots = plots_of(rows);
    return page;
}

// 72 = 64 + 8: on 64 groups each row is shifted by the root of their number, the best of the cyclic mapping.
StudyPage study_hybrid(Laboratory& lab, const Scenes& scenes) {
    const Scenes own = {even_scene(8320), embedded_scene("centre"), balls_scene(3)};
    return hybrid_page(lab.session(), scenes.empty() ? own : scenes, lab.size(72), 64);
}

}  // namespace raya
