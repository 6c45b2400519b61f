// G groups of a machine's nodes share the screen, each divides space over its own nodes: which G is best, and which
// does memory forbid?
#include "host/study/hybrid.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <functional>
#include <numeric>

#include "host/machine/t805.hpp"
#include "host/study/studies.hpp"
#include "host/study/torus_runs.hpp"
#include "kernels/shared/traffic.h"

namespace raya {
namespace {

constexpr std::array<std::uint32_t, 2> kSides = {4, 8};  // voxels along each axis, of every group: the paper's, finer
constexpr std::array<std::uint64_t, 2> kMemories = {32 * 1024, 4 * 1024 * 1024};  // bytes of a node: SPA's, a board's
constexpr const char* kMemoryNames[] = {"32 KB", "4 MB"};

// The whole machine in G groups.
struct Grouped {
    std::uint32_t groups = 0, nodes = 0;        // nodes of a group
    double overlapped_ms = 0, stepwise_ms = 0;  // of the slowest group
    Load load;                                  // of the nodes of all groups
    double messages_ms = 0;                     // of the processor that has most of them
    double hops_per_packet = 0, tests_per_ray = 0;
    std::uint64_t supersteps = 0;        // of the group that takes most
    std::uint64_t words_bytes = 0;       // of the fullest node: its part of the scene
    std::uint64_t least_bytes = 0;       // ... and the shortest queue and boxes with which it can work
    std::uint64_t with_queue_bytes = 0;  // ... and those that it had here
    std::uint64_t rays = 0;

    bool fits(std::size_t memory) const { return least_bytes <= kMemories[memory]; }
};

struct SceneGroups {
    std::string label;
    std::uint32_t sides = 0;
    std::vector<Grouped> all;  // 1, 2, 4, ... groups
    double one_node_ms = 0;    // modelled: one node alone, all pixels

    double speedup(std::size_t i) const { return one_node_ms / all[i].overlapped_ms; }
    double stepwise(std::size_t i) const { return one_node_ms / all[i].stepwise_ms; }
};

std::uint64_t least_bytes(const TorusRun& run, const LabelledScene& scene) {
    const std::uint32_t queue =
        raya_shortest_queue(static_cast<std::uint32_t>(scene.scene.lights.size()), machine_named("torus").bounces);
    return run.bytes_without_buffers() + node_bytes(0, buffers_for(queue), links_of_node(run.torus));
}

Grouped grouped_of(const std::vector<TorusRun>& runs, const LabelledScene& scene) {
    Grouped g;
    g.groups = static_cast<std::uint32_t>(runs.size());
    g.nodes = runs.front().nodes();
    g.words_bytes = runs.front().bytes_without_buffers();
    g.least_bytes = least_bytes(runs.front(), scene);
    g.with_queue_bytes = runs.front().result.node_bytes;
    std::vector<std::uint64_t> loads;
    std::uint64_t hops = 0, packets = 0, tests = 0;
    for (const TorusRun& run : runs) {
        g.overlapped_ms = std::max(g.overlapped_ms, run.time.overlapped_ms);
        g.stepwise_ms = std::max(g.stepwise_ms, run.time.stepwise_ms);
        g.messages_ms = std::max(g.messages_ms, run.time.messages_ms);
        g.supersteps = std::max<std::uint64_t>(g.supersteps, run.result.supersteps.size());
        loads.insert(loads.end(), run.result.load.per_pe.begin(), run.result.load.per_pe.end());
        hops += run.result.hops;
        packets += run.packets();
        tests += run.tests();
        g.rays += run.rays();
    }
    g.load = load_of(std::move(loads));
    g.hops_per_packet = static_cast<double>(hops) / static_cast<double>(std::max<std::uint64_t>(1, packets));
    g.tests_per_ray = static_cast<double>(tests) / static_cast<double>(std::max<std::uint64_t>(1, g.rays));
    return g;
}

SceneGroups groups_of(Session& session, const LabelledScene& scene, std::uint32_t size, std::uint32_t nodes,
                      std::uint32_t sides) {
    SceneGroups all{scene.label, sides, {}, 0};
    for (std::uint32_t groups = 1; groups <= nodes; groups *= 2) {
        TorusPlan plan;
        plan.nodes = near_cube(nodes / groups);
        plan.voxels = {sides, sides, sides};
        all.all.push_back(grouped_of(run_groups(session, scene, size, plan, groups), scene));
    }
    // With a node a group none sends a message, and what they compute together is what one node alone would compute.
    const std::vector<std::uint64_t>& alone = all.all.back().load.per_pe;
    all.one_node_ms =
        1e-6 * kT805CycleNs * static_cast<double>(std::accumulate(alone.begin(), alone.end(), std::uint64_t{0}));
    return all;
}

StudyTable time_table(const std::vector<SceneGroups>& scenes) {
    StudyTable table{
        "hybrid",
        "Time of the whole machine",
        {"scene", "voxels", "groups", "nodes a group", "overlapped (ms)", "stepwise (ms)", "speed-up, overlapped",
         "speed-up, stepwise", "u over all nodes", "most messages (ms)", "hops a packet", "supersteps", "tests a ray"},
        {},
        true};
    for (const SceneGroups& s : scenes)
        for (std::size_t i = 0; i < s.all.size(); ++i) {
            const Grouped& g = s.all[i];
            table.rows.push_back({s.label, sides_text({s.sides, s.sides, s.sides}), std::int64_t{g.groups},
                                  std::int64_t{g.nodes}, g.overlapped_ms, g.stepwise_ms, s.speedup(i), s.stepwise(i),
                                  g.load.imbalance, g.messages_ms, g.hops_per_packet,
                                  static_cast<std::int64_t>(g.supersteps), g.tests_per_ray});
        }
    return table;
}

StudyTable memory_table(const std::vector<SceneGroups>& scenes) {
    StudyTable table{"hybrid-memory",
                     "Memory of the fullest node",
                     {"scene", "voxels", "groups", "its part of the scene (bytes)", "with the shortest buffers (bytes)",
                      "with the study's (bytes)", "fits 32 KB", "fits 4 MB"},
                     {},
                     true};
    const auto whole = [](std::uint64_t count) { return static_cast<std::int64_t>(count); };
    for (const SceneGroups& s : scenes)
        for (const Grouped& g : s.all)
            table.rows.push_back({s.label, sides_text({s.sides, s.sides, s.sides}), std::int64_t{g.groups},
                                  whole(g.words_bytes), whole(g.least_bytes), whole(g.with_queue_bytes),
                                  g.fits(0) ? "yes" : "no", g.fits(1) ? "yes" : "no"});
    return table;
}

using Figure = std::function<double(const SceneGroups&, std::size_t)>;

StudyPlot plot_of(const std::vector<SceneGroups>& scenes, const std::string& name, const std::string& title,
                  const std::string& y_label, bool log_y, const Figure& figure) {
    StudyPlot plot{name, title, "groups G", y_label, true, log_y, {}};
    for (const SceneGroups& s : scenes) {
        plot.series.push_back(
            {fmt::format("{}, {} voxels", s.label, sides_text({s.sides, s.sides, s.sides})), {}, {}, PlotStyle::kLine});
        for (std::size_t i = 0; i < s.all.size(); ++i) {
            plot.series.back().x.push_back(s.all[i].groups);
            plot.series.back().y.push_back(figure(s, i));
        }
    }
    return plot;
}

std::vector<StudyPlot> plots_of(const std::vector<SceneGroups>& scenes) {
    StudyPlot memory = plot_of(scenes, "hybrid-memory", "The fullest node, with the shortest buffers", "bytes", true,
                               [](const auto& s, std::size_t i) { return static_cast<double>(s.all[i].least_bytes); });
    const double last = scenes.front().all.back().groups;
    for (std::size_t m = 0; m < kMemories.size(); ++m) {
        const auto bytes = static_cast<double>(kMemories[m]);
        memory.series.push_back({kMemoryNames[m], {1, last}, {bytes, bytes}, PlotStyle::kLine});
    }
    return {plot_of(scenes, "hybrid", "Speed-up against the number of groups, overlapped", "speed-up, modelled", false,
                    [](const auto& s, std::size_t i) { return s.speedup(i); }),
            plot_of(scenes, "hybrid-stepwise", "Speed-up against the number of groups, stepwise", "speed-up, modelled",
                    false, [](const auto& s, std::size_t i) { return s.stepwise(i); }),
            plot_of(scenes, "hybrid-balance", "Imbalance over the nodes of all groups", "u", false,
                    [](const auto& s, std::size_t i) { return s.all[i].load.imbalance; }),
            memory};
}

bool fits_any(const Grouped&) { return true; }

// Index of the fastest number of groups among those that `allowed` lets through; of none, as many as there are.
std::size_t best_of(const SceneGroups& s, double Grouped::*time, const std::function<bool(const Grouped&)>& allowed) {
    std::size_t best = s.all.size();
    for (std::size_t i = 0; i < s.all.size(); ++i)
        if (allowed(s.all[i]) && (best == s.all.size() || s.all[i].*time < s.all[best].*time)) best = i;
    return best;
}

std::string chief_finding(const std::vector<SceneGroups>& scenes) {
    std::vector<std::string> words;
    for (const SceneGroups& s : scenes) {
        const std::size_t best = best_of(s, &Grouped::overlapped_ms, fits_any);
        words.push_back(fmt::format("{} with {} voxels: G = {}, speed-up {:.1f} ({:.1f} with one group)", s.label,
                                    sides_text({s.sides, s.sides, s.sides}), s.all[best].groups, s.speedup(best),
                                    s.speedup(0)));
    }
    return fmt::format("The best number of groups on {} nodes where memory is no matter, overlapped: {}.",
                       scenes.front().all.back().groups, fmt::join(words, "; "));
}

std::string finding_of_bounds(const std::vector<SceneGroups>& scenes) {
    std::vector<std::string> words;
    for (const SceneGroups& s : scenes) {
        const std::size_t best = best_of(s, &Grouped::stepwise_ms, fits_any);
        words.push_back(fmt::format("{}, {}: G = {}, speed-up {:.1f} ({:.1f} with one group)", s.label,
                                    sides_text({s.sides, s.sides, s.sides}), s.all[best].groups, s.stepwise(best),
                                    s.stepwise(0)));
    }
    return fmt::format("Where every superstep waits for its busiest node and link: {}.", fmt::join(words, "; "));
}

std::string finding_of_memory(const std::vector<SceneGroups>& scenes, std::size_t memory) {
    std::vector<std::string> words;
    for (const SceneGroups& s : scenes) {
        std::vector<std::uint32_t> fit;
        for (const Grouped& g : s.all)
            if (g.fits(memory)) fit.push_back(g.groups);
        const std::size_t best = best_of(s, &Grouped::overlapped_ms, [&](const Grouped& g) { return g.fits(memory); });
        const std::string label = fmt::format("{}, {}", s.label, sides_text({s.sides, s.sides, s.sides}));
        if (fit.empty())
            words.push_back(fmt::format("{}: no G, one group needs {:.1f} KB a node", label,
                                        static_cast<double>(s.all.front().least_bytes) / 1024));
        else if (fit.size() == s.all.size())
            words.push_back(fmt::format("{}: any G", label));
        else
            words.push_back(fmt::format("{}: G = {}, the best of them {}, speed-up {:.1f}", label, fmt::join(fit, ", "),
                                        s.all[best].groups, s.speedup(best)));
    }
    return fmt::format("Nodes of {}, with the shortest buffers that work, can hold: {}.", kMemoryNames[memory],
                       fmt::join(words, "; "));
}

std::string finding_of_balance(const std::vector<SceneGroups>& scenes) {
    std::vector<std::string> words;
    for (const SceneGroups& s : scenes)
        words.push_back(fmt::format("{}, {}: {:.2f} to {:.2f}", s.label, sides_text({s.sides, s.sides, s.sides}),
                                    s.all.front().load.imbalance, s.all.back().load.imbalance));
    return fmt::format("u over all nodes, from one group to a group for each node: {}.", fmt::join(words, "; "));
}

std::vector<Comparison> comparisons_of(const std::vector<SceneGroups>& scenes) {
    std::vector<Comparison> all;
    for (const SceneGroups& s : scenes)
        all.push_back({fmt::format("best G, {}, {} voxels", s.label, sides_text({s.sides, s.sides, s.sides})),
                       "groups",
                       {},
                       double(s.all[best_of(s, &Grouped::overlapped_ms, fits_any)].groups),
                       "modelled, overlapped, whatever the memory"});
    return all;
}

std::vector<std::string> method_of(std::uint32_t size, std::uint32_t nodes) {
    return {
        fmt::format("{} nodes in G groups, each a 3-D torus of {} / G nodes that holds the whole scene and renders the "
                    "pixels p with p mod G = g at {} x {}, p counted row by row: each row is shifted by {} mod G "
                    "against the one above it, as in a cyclic mapping. fp32; all nodes make primary rays.",
                    nodes, nodes, size, size, size),
        "Each group cuts the scene into the same voxels, laid out cyclically on its nodes, so that all G do the same "
        "work. G = 1 divides space alone, G as many as nodes divides the screen alone.",
        "The machine's time is that of its slowest group, modelled on T805s from what is counted; speed-up is against "
        "one node that has all pixels and the same voxels. Overlapped: the busiest processor or link of a group, no "
        "one "
        "ever waiting for another; stepwise: every superstep waits for its busiest node, then for its busiest link. "
        "How the groups' roots hand their pixels to the host is not modelled.",
        "Memory: the part of the scene that the fullest node holds; with it the shortest queue and boxes that a hit "
        "can "
        "ask for; with it those that the study has."};
}

}  // namespace

StudyPage hybrid_page(Session& session, const std::vector<LabelledScene>& scenes, std::uint32_t size,
                      std::uint32_t nodes) {
    std::vector<SceneGroups> all;
    for (const LabelledScene& scene : scenes)
        for (const std::uint32_t sides : kSides) all.push_back(groups_of(session, scene, size, nodes, sides));
    StudyPage page;
    page.name = "hybrid";
    page.title = "Screen and space divided together: groups of nodes";
    page.question = "In how many groups should the nodes share the screen, and what does memory allow?";
    page.method = method_of(size, nodes);
    for (const LabelledScene& scene : scenes) page.settings["scenes"].push_back(scene.label);
    page.settings["size"] = size;
    page.settings["nodes"] = nodes;
    page.settings["voxels"] = kSides;
    page.settings["links"] = "torus3d";
    page.settings["format"] = "fp32";
    page.settings["bounces"] = machine_named("torus").bounces;
    page.comparisons = comparisons_of(all);
    page.tables = {time_table(all), memory_table(all)};
    page.plots = plots_of(all);
    page.findings = {chief_finding(all), finding_of_bounds(all), finding_of_memory(all, 0), finding_of_memory(all, 1),
                     finding_of_balance(all)};
    return page;
}

// 72 = 64 + 8: on 64 groups each row is shifted by the root of their number, the best of the cyclic mapping.
StudyPage study_hybrid(Laboratory& lab, const std::vector<LabelledScene>& scenes) {
    const std::vector<LabelledScene> own = {even_scene(8320), embedded_scene("centre"), balls_scene(3)};
    return hybrid_page(lab.session(), scenes.empty() ? own : scenes, lab.size(72), 64);
}

}  // namespace raya
