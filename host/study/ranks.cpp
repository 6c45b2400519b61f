// Renders on 1 to 65,536 ranks, predicted, and beside them those that can be measured here.
#include <algorithm>
#include <optional>

#include "host/base/temporary_folder.hpp"
#include "host/base/whole_file.hpp"
#include "host/scene/nff_writer.hpp"
#include "host/study/measured.hpp"
#include "host/study/other_load.hpp"
#include "host/study/prose.hpp"
#include "host/study/rank_networks.hpp"
#include "host/study/rank_trials.hpp"
#include "host/study/ranks_machines.hpp"
#include "host/study/rows.hpp"
#include "host/study/studies.hpp"
#include "host/study/torus_runs.hpp"

namespace raya {
namespace {

constexpr const char* kName = "ranks";

// One number of ranks by one network.
struct Row {
    std::string machine, array, network;
    std::uint32_t ranks = 1;
    RankParts parts;
    double one_s = 0;  // the render of one rank

    double speedup() const { return one_s / parts.total_s(); }
    double percent() const { return 100 * parts.share(); }
    double total_ms() const { return 1e3 * parts.total_s(); }
};
using Rows = std::vector<Row>;

// A number of ranks that was measured.
struct Check {
    std::string machine;
    std::uint32_t ranks = 1, cores = 1;
    double predicted_ms = 0;
    Measured measured;

    double ratio() const { return predicted_ms / measured.min_ms; }
    bool shared() const { return cores < ranks; }
    std::string remark() const { return shared() ? "ranks share cores" : ranks == 1 ? "the model rests on it" : ""; }
};
using Checks = std::vector<Check>;

Rows rows_of(const RankedMachine& machine, const MeasuredWork& one, const Networks& networks) {
    Rows rows;
    const double one_s = machine.predict(0, one, {}, 1).total_s();
    for (const NamedNetwork& network : networks)
        for (std::size_t i = 0; i < machine.ranks.size(); ++i)
            rows.push_back({machine.name, machine.arrays[i], network.name, machine.ranks[i],
                            machine.predict(i, one, network.network, machine.ranks[i]), one_s});
    return rows;
}

Checks checks_of(const RankedMachine& machine, const MeasuredWork& one, const RanksHere& here,
                 const std::vector<RankTrial>& trials) {
    Checks checks;
    for (std::size_t i = 0; i < trials.size(); ++i) {
        const double processors = trials[i].best.on_processors() ? here.processors[i] : here.ranks[i];
        checks.push_back({machine.name, here.ranks[i], static_cast<std::uint32_t>(processors),
                          1e3 * machine.predict(i, one, here.ping.network, processors).render_s(),
                          measured_of(trials[i].seconds)});
    }
    return checks;
}

Rows of_machine(const Rows& rows, const std::string& machine, const std::string& network) {
    return where(rows, [&](const Row& row) { return row.machine == machine && row.network == network; });
}

// What one machine comes to by one network.
struct Summary {
    Row best;  // fewest seconds
    std::uint32_t half = 0;

    std::string half_text() const { return half > 0 ? std::to_string(half) : "-"; }
};

std::vector<Summary> summaries_of(const Rows& rows) {
    std::vector<Summary> all;
    for (const std::string& machine : distinct(rows, &Row::machine))
        for (const std::string& network : distinct(rows, &Row::network)) {
            const Rows some = of_machine(rows, machine, network);
            all.push_back({least(some, &Row::total_ms), half_at(each(some, &Row::ranks), each(some, &Row::parts))});
        }
    return all;
}

std::string finding_of_machine(const std::vector<Summary>& summaries, const std::string& machine) {
    const auto some = where(summaries, [&](const Summary& s) { return s.best.machine == machine; });
    const std::string halves = joined(some, ", ", [](const Summary& s) {
        return fmt::format("{} ({})", s.half > 0 ? fmt::format("{} ranks", s.half) : "no number of ranks",
                           s.best.network);
    });
    const std::string fastest = joined(some, ", ", [](const Summary& s) {
        return fmt::format("{} ({}, {:.3g} times as fast as one)", s.best.ranks, s.best.network, s.best.speedup());
    });
    return finding(kName, "half", "machine"_a = machine, "halves"_a = halves, "fastest"_a = fastest);
}

std::string finding_of_checks(const Checks& checks) {
    const Checks more = where(checks, [](const Check& check) { return check.ranks > 1; });
    const auto ratios = [](const Checks& some) {
        const auto all = each(some, &Check::ratio);
        return some.empty() ? std::string("(none)")
                            : fmt::format("{:.2f} to {:.2f}", std::ranges::min(all), std::ranges::max(all));
    };
    return finding(kName, "checks", "own"_a = ratios(where(more, [](const Check& c) { return !c.shared(); })),
                   "shared"_a = ratios(where(more, &Check::shared)), "turns"_a = kRankTurns);
}

// Supersteps wait for the slowest rank, so that what takes a processor from one of them holds up all.
std::string finding_of_others(double share) {
    return finding(kName, share <= kQuiet ? "quiet" : "disturbed", "others"_a = 100 * share);
}

std::string finding_of_network(const PingReport& ping) {
    const MessageTime& longest = ping.messages.back();
    return finding(kName, "network", "alpha"_a = 1e6 * ping.network.alpha_s, "beta"_a = 1e9 * ping.network.beta_s,
                   "short"_a = 1e6 * ping.messages.front().seconds,
                   "rate"_a = 1e-9 * static_cast<double>(longest.bytes) / longest.seconds, "library"_a = ping.library);
}

auto ms_of(double RankParts::*part) {
    return [part](const Row& row) { return 1e3 * (row.parts.*part); };
}

// Each part of the time by one network; on logarithmic axes nothing is drawn of what takes nothing.
StudyPlot plot_of_parts(const Rows& rows, const std::string& machine, const std::string& network) {
    StudyPlot plot{fmt::format("{}-{}", kName, machine), fmt::format("{} on ranks, by {}", machine, network), "ranks",
                   "time (ms)", Axes::kLogBoth};
    const Rows some = of_machine(rows, machine, network);
    plot.series.push_back(line("in all", some, &Row::ranks, &Row::total_ms));
    const auto add = [&](const char* label, double RankParts::*part) {
        plot.series.push_back(
            line(label, where(some, [=](const Row& row) { return row.parts.*part > 0; }), &Row::ranks, ms_of(part)));
    };
    add("compute", &RankParts::compute_s);
    add("host", &RankParts::host_s);
    add("exchange", &RankParts::exchange_s);
    add(machine == "ring" ? "pixels to rank 0" : "status to all", &RankParts::collect_s);
    add("scene", &RankParts::broadcast_s);
    return plot;
}

StudyPlot plot_of_networks(const Rows& rows, const Checks& checks, const std::string& machine) {
    StudyPlot plot{fmt::format("{}-{}-networks", kName, machine),
                   fmt::format("{}: time against ranks, by network", machine), "ranks", "time (ms)", Axes::kLogBoth};
    plot.series = lines(where(rows, [&](const Row& row) { return row.machine == machine; }), &Row::network, &Row::ranks,
                        &Row::total_ms);
    const Checks some = where(checks, [&](const Check& check) { return check.machine == machine; });
    plot.series.push_back(line(
        "measured", some, &Check::ranks, [](const Check& c) { return c.measured.min_ms; }, PlotStyle::kPoints));
    return plot;
}

std::vector<StudyTable> tables_of(const Rows& rows, const Checks& checks, const Networks& networks,
                                  const PingReport& ping, const std::vector<Summary>& summaries) {
    const auto best = [](auto figure) { return [=](const Summary& s) { return std::invoke(figure, s.best); }; };
    const auto ms = [](double Measured::*figure) { return [=](const Check& c) { return c.measured.*figure; }; };
    return {
        table_of(kName, "Where communication takes half, and the fewest seconds", summaries,
                 {{"machine", best(&Row::machine)},
                  {"network", best(&Row::network)},
                  {"half at", &Summary::half_text, "ranks"},
                  {"fastest", best(&Row::ranks), "ranks"},
                  {"array", best(&Row::array)},
                  {"time", best(&Row::total_ms), "ms"},
                  {"speed-up", best(&Row::speedup)}}),
        table_of("ranks-here", "Predicted and measured on one core a rank", checks,
                 {{"machine", &Check::machine},
                  {"ranks", &Check::ranks},
                  {"cores", &Check::cores},
                  {"predicted", &Check::predicted_ms, "ms"},
                  {"measured, best", ms(&Measured::min_ms), "ms"},
                  {"median", ms(&Measured::median_ms), "ms"},
                  {"largest", ms(&Measured::max_ms), "ms"},
                  {"predicted / measured", &Check::ratio},
                  {"remark", &Check::remark}}),
        table_of("ranks-networks", "The networks", networks,
                 {{"network", &NamedNetwork::name},
                  {"alpha", &NamedNetwork::alpha_us, "us"},
                  {"beta", &NamedNetwork::beta_ns, "ns a byte"},
                  {"source", &NamedNetwork::source}}),
        table_of("ranks-messages", "Messages between two ranks here", ping.messages,
                 {{"bytes", &MessageTime::bytes},
                  {"measured", [](const MessageTime& m) { return 1e6 * m.seconds; }, "us"},
                  {"fitted",
                   [&ping](const MessageTime& m) { return 1e6 * ping.network.seconds(static_cast<double>(m.bytes)); },
                   "us"}}),
        table_of("ranks-all", "Parts of the time on each number of ranks", rows,
                 {{"machine", &Row::machine},
                  {"network", &Row::network},
                  {"ranks", &Row::ranks},
                  {"array", &Row::array},
                  {"compute", ms_of(&RankParts::compute_s), "ms"},
                  {"host", ms_of(&RankParts::host_s), "ms"},
                  {"exchange", ms_of(&RankParts::exchange_s), "ms"},
                  {"collect", ms_of(&RankParts::collect_s), "ms"},
                  {"broadcast", ms_of(&RankParts::broadcast_s), "ms"},
                  {"time", &Row::total_ms, "ms"},
                  {"speed-up", &Row::speedup},
                  {"communication", &Row::percent, "%"}},
                 false)};
}

struct Found {
    Rows rows;
    Checks checks;
    PingReport ping;
    Networks networks;
    std::optional<double> others;  // share of the processors that other programs had meanwhile
};

Found find(Laboratory& lab, const LabelledScene& on_ring, const LabelledScene& on_torus, const RanksSizes& sizes,
           const Mpirun& mpirun) {
    const TemporaryFolder folder("raya-study");
    const std::string ring_file = folder / "ring.nff", torus_file = folder / "torus.nff";
    write_whole_file(ring_file, write_nff(on_ring.scene));
    write_whole_file(torus_file, write_nff(on_torus.scene));
    const OtherLoad load;
    const RanksHere here = look_around(mpirun);
    Found found{{}, {}, here.ping, networks_of(here.ping, lab.network()), {}};
    for (const RankedMachine& machine : {ring_on_ranks(lab, on_ring, ring_file, sizes.ring),
                                         torus_on_ranks(lab.session(), on_torus, torus_file, sizes.torus)}) {
        const std::vector<RankTrial> trials = measure(mpirun, machine, here, lab.session().device());
        const MeasuredWork one = work_of(machine, trials.front().best);
        std::ranges::move(rows_of(machine, one, found.networks), std::back_inserter(found.rows));
        std::ranges::move(checks_of(machine, one, here, trials), std::back_inserter(found.checks));
    }
    found.others = load.share();
    return found;
}

std::vector<Comparison> comparisons_of(const Checks& checks) {
    return each(where(checks, [](const Check& check) { return check.ranks > 1; }), [](const Check& check) {
        return Comparison{fmt::format("{}, {} ranks: predicted / measured", check.machine, check.ranks), "",
                          std::nullopt, check.ratio(), check.remark()};
    });
}

}  // namespace

std::string lack_of_ranks() { return Mpirun::of_this_program().lack(); }

StudyPage ranks_page(Laboratory& lab, const LabelledScene& on_ring, const LabelledScene& on_torus,
                     const RanksSizes& sizes, const Mpirun& mpirun) {
    const auto [rows, checks, ping, networks, others] = find(lab, on_ring, on_torus, sizes, mpirun);
    const std::vector<Summary> summaries = summaries_of(rows);
    StudyPage page = page_about(kName, {{"scene", on_ring.label},
                                        {"torus_scene", on_torus.label},
                                        {"size", sizes.ring},
                                        {"torus_size", sizes.torus},
                                        {"ranks", rows.back().ranks},
                                        {"turns", kRankTurns},
                                        {"enough", kEnoughRankS},
                                        {"alpha_s", ping.network.alpha_s},
                                        {"beta_s_per_byte", ping.network.beta_s}});
    page.clock = sentence(kName, "clock");
    page.findings = {finding_of_machine(summaries, "ring"), finding_of_machine(summaries, "torus"),
                     finding_of_checks(checks), finding_of_network(ping)};
    if (others) page.findings.insert(page.findings.begin() + 3, finding_of_others(*others));
    page.comparisons = comparisons_of(checks);
    page.tables = tables_of(rows, checks, networks, ping, summaries);
    for (const std::string machine : {"ring", "torus"}) {
        page.plots.push_back(plot_of_networks(rows, checks, machine));
        page.plots.push_back(plot_of_parts(rows, machine, networks[1].name));
    }
    page.news = {sentence(kName, "news")};
    return page;
}

StudyPage study_ranks(Laboratory& lab, const Scenes& scenes) {
    const LabelledScene on_torus = scenes.empty() ? even_scene(8320) : scenes.front();
    return ranks_page(lab, one_of(scenes), on_torus, {lab.size(512), lab.size(512)}, Mpirun::of_this_program());
}

}  // namespace raya
