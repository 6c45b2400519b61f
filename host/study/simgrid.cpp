// The asynchronous torus by raya's simulator and by SimGrid, one effect after another.
#include <algorithm>
#include <cmath>

#include "host/base/program.hpp"
#include "host/study/peer.hpp"
#include "host/study/prose.hpp"
#include "host/study/rows.hpp"
#include "host/study/simgrid_peer.hpp"
#include "host/study/studies.hpp"
#include "host/study/torus_runs.hpp"

namespace raya {
namespace {

constexpr const char* kProgram = "simgrid_replay";
constexpr double kGoal = 10;               // %: how near the two are to be
constexpr std::uint32_t kRoomy = 1 << 20;  // messages in a port: none ever waits for room

// One machine on one history.
struct Row {
    std::string shape, inject, effects;
    std::uint64_t messages = 0;
    double ours_ms = 0, simgrid_ms = 0;
    double ours_more_ms = 0, simgrid_more_ms = 0;  // than the machine with one effect less
    double overlapped_ms = 0, stepwise_ms = 0;     // of the whole machine

    double difference() const { return 100 * (ours_ms / simgrid_ms - 1); }
};
using Rows = std::vector<Row>;

struct Effect {
    std::string name;
    AsyncMachine machine;
};

// Each machine has all that the one before it has, and one thing more; the last is the machine as it is.
std::vector<Effect> effects() {
    const AsyncMachine whole;
    AsyncMachine alone = whole;
    alone.message_cycles = alone.word_cycles = 0;
    alone.one_way = alone.both_ways = 0;
    alone.buffer = kRoomy;
    AsyncMachine handled = whole;
    handled.one_way = handled.both_ways = 0;
    handled.buffer = kRoomy;
    AsyncMachine carried = whole;
    carried.both_ways = 2 * whole.one_way;
    carried.buffer = kRoomy;
    AsyncMachine shared = whole;
    shared.buffer = kRoomy;
    return {{"computing alone", alone},
            {"+ processors handle messages", handled},
            {"+ links take time", carried},
            {"+ both ways share a link", shared},
            {"+ finite buffers", whole}};
}

Rows rows_of(Session& session, const LabelledScene& scene, std::uint32_t size, Links links, Injection inject,
             const std::filesystem::path& program) {
    TorusPlan plan;
    plan.nodes = plan.voxels = {4, 4, 4};
    plan.links = links;
    plan.inject = inject;
    plan.packets = kProtocolOfPaper.packets;
    plan.asynchronous = true;
    History history;
    const TorusRun run = run_on_torus(session, scene, size, plan, {}, &history);
    Rows rows;
    for (const Effect& effect : effects()) {
        const SimgridAnswer theirs = ask_simgrid(program, run.torus, history, effect.machine);
        if (theirs.delivered != history.messages.size())
            throw PeerFailure(
                fmt::format("{}: {} of {} messages delivered", kProgram, theirs.delivered, history.messages.size()));
        Row row{.shape = links == Links::kTorus3d ? "4 x 4 x 4" : "8 x 8",
                .inject = inject == Injection::kRoot ? "root" : "all",
                .effects = effect.name,
                .messages = history.messages.size(),
                .ours_ms = simulate(run.torus, history, effect.machine).finish_ms,
                .simgrid_ms = theirs.finish_ms,
                .overlapped_ms = run.overlapped_ms(),
                .stepwise_ms = run.stepwise_ms()};
        row.ours_more_ms = row.ours_ms - (rows.empty() ? 0 : rows.back().ours_ms);
        row.simgrid_more_ms = row.simgrid_ms - (rows.empty() ? 0 : rows.back().simgrid_ms);
        rows.push_back(row);
    }
    return rows;
}

double far_off(const Row& row) { return std::abs(row.difference()); }

std::string finding_of_goal(const Rows& rows) {
    const Row& worst = *std::ranges::max_element(rows, {}, far_off);
    return finding("simgrid", far_off(worst) <= kGoal ? "near" : "far", "machines"_a = rows.size(), "goal"_a = kGoal,
                   "most"_a = far_off(worst), "effects"_a = worst.effects, "shape"_a = worst.shape,
                   "inject"_a = worst.inject);
}

// The effect, other than computing itself, that takes most, and how far the two are apart in it.
std::string finding_of_effects(const Rows& rows) {
    const Rows more = where(rows, [](const Row& row) { return row.effects.starts_with('+'); });
    const Row& most = *std::ranges::max_element(more, {}, &Row::ours_more_ms);
    const double apart =
        std::ranges::max(each(more, [](const Row& row) { return std::abs(row.ours_more_ms - row.simgrid_more_ms); }));
    return finding("simgrid", "effects", "effect"_a = most.effects.substr(2), "shape"_a = most.shape,
                   "inject"_a = most.inject, "ours"_a = most.ours_more_ms, "theirs"_a = most.simgrid_more_ms,
                   "apart"_a = apart);
}

std::string finding_of_bounds(const Row& row) {
    return finding("simgrid", "bounds", "shape"_a = row.shape, "inject"_a = row.inject, "ours"_a = row.ours_ms,
                   "overlapped"_a = row.overlapped_ms, "stepwise"_a = row.stepwise_ms);
}

// A line of each machine, by raya and by SimGrid, over its effects.
StudyPlot plot_of(const Rows& rows) {
    StudyPlot plot{"simgrid", "Time of the machine, one effect after another", "effects", "modelled ms", Axes::kLinear};
    for (std::size_t first = 0; first < rows.size(); first += effects().size()) {
        const std::string name = fmt::format("{}, {}, ", rows[first].shape, rows[first].inject);
        PlotSeries ours{name + "raya", {}, {}}, theirs{name + "SimGrid", {}, {}, PlotStyle::kPoints};
        for (std::size_t i = 0; i < effects().size(); ++i) {
            for (PlotSeries* series : {&ours, &theirs}) series->x.push_back(static_cast<double>(i));
            ours.y.push_back(rows[first + i].ours_ms);
            theirs.y.push_back(rows[first + i].simgrid_ms);
        }
        plot.series.push_back(ours);
        plot.series.push_back(theirs);
    }
    return plot;
}

}  // namespace

std::string lack_of_simgrid() { return program_beside_this(kProgram) ? "" : sentence("simgrid", "no simgrid"); }

StudyPage simgrid_page(Session& session, const LabelledScene& scene, std::uint32_t size,
                       const std::filesystem::path& program) {
    Rows rows;
    for (const Links links : {Links::kTorus3d, Links::kTorus2d})
        for (const Injection inject : {Injection::kRoot, Injection::kAll})
            for (Row& row : rows_of(session, scene, size, links, inject, program)) rows.push_back(std::move(row));
    const AsyncMachine whole;
    StudyPage page = page_about(
        "simgrid",
        {{"scene", scene.label}, {"size", size}, {"nodes", "4x4x4"}, {"buffer", whole.buffer}, {"goal", kGoal}});
    for (const Row& row : rows)
        if (row.effects == effects().back().name)
            page.comparisons.push_back({fmt::format("{}, {}, the whole machine, ours / SimGrid", row.shape, row.inject),
                                        "", std::nullopt, row.ours_ms / row.simgrid_ms, "modelled, asynchronous"});
    page.clock = sentence("simgrid", "clock");
    page.findings = {finding_of_goal(rows), finding_of_effects(rows)};
    for (const Row& row : rows)
        if (row.effects == effects().back().name) page.findings.push_back(finding_of_bounds(row));
    page.tables = {table_of("simgrid", "Time of one history, by raya and by SimGrid", rows,
                            {{"torus", &Row::shape},
                             {"inject", &Row::inject},
                             {"machine", &Row::effects},
                             {"messages", &Row::messages},
                             {"raya", &Row::ours_ms, "ms"},
                             {"SimGrid", &Row::simgrid_ms, "ms"},
                             {"difference", &Row::difference, "%"},
                             {"raya, the effect", &Row::ours_more_ms, "ms"},
                             {"SimGrid, the effect", &Row::simgrid_more_ms, "ms"}})};
    page.plots = {plot_of(rows)};
    page.news = {sentence("simgrid", "news")};
    return page;
}

StudyPage study_simgrid(Laboratory& lab, const Scenes& scenes) {
    const auto program = program_beside_this(kProgram);
    if (!program) throw UserError(lack_of_simgrid());
    return simgrid_page(lab.session(), scenes.empty() ? even_scene(512) : scenes.front(), lab.size(48), *program);
}

}  // namespace raya
