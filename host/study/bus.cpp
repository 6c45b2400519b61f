// Neighbours over the ring, over the bus from PE to PE, and by each PE's broadcast: the same image, counted and
// modelled.
#include <cmath>

#include "host/ring/ring_renderer.hpp"
#include "host/study/arrays.hpp"
#include "host/study/laboratory.hpp"
#include "host/study/paper.hpp"
#include "host/study/prose.hpp"
#include "host/study/rows.hpp"
#include "host/study/studies.hpp"

namespace raya {
namespace {

constexpr const char* kName = "bus";
constexpr std::uint32_t kFewest = 4, kMost = 256;  // PEs

// What one way moved, and what that takes. The exchange's set-up, the same for every way, is left out.
struct Way {
    std::uint64_t moves = 0, words = 0;
    double ms = 0;
    double least_ms = 0;  // were nothing but words to be waited for on the bus
    std::string image;    // hash
};

// One number of PEs and one way of anti-aliasing.
struct Exchanges {
    std::uint32_t pes = 0, offset = 0;
    std::string antialias;
    Way ring, bus, broadcast;

    double bus_over_ring() const { return bus.ms / ring.ms; }
    double broadcast_over_ring() const { return broadcast.ms / ring.ms; }
    bool same_image() const { return bus.image == ring.image && broadcast.image == ring.image; }
    // The sooner of the bus's two, by the model and at the least.
    double best_ms() const { return std::min(bus.ms, broadcast.ms); }
    double best_least_ms() const { return std::min(bus.least_ms, broadcast.least_ms); }
};
using Rows = std::vector<Exchanges>;

Way way_of(Laboratory& lab, const LabelledScene& scene, const raya_mapping& mapping, const Antialias& antialias) {
    RingSettings settings;
    settings.machine = machine_named("grande");  // the SPA's rates, and room for whole shares
    settings.format = format_for(scene.scene);
    settings.bounces = machine_named("spa").bounces;
    settings.mapping = mapping;
    settings.antialias = antialias;
    settings.keep_costs = false;
    const RingResult result = RingRenderer(lab.session(), scene.scene, settings).render();
    const Communication& c = result.communication;
    const std::uint64_t on_bus = c.transfer_words + c.pe_broadcast_words;
    const double ms = modelled_time(settings.machine, std::span(&result.all.load, 1), c).value().communication_ms;
    const double words_ms = 1e3 * static_cast<double>(on_bus) / settings.machine.link_words_per_s.value();
    return {c.rotations + c.transfers + c.pe_broadcasts, c.rotation_words + on_bus, ms, on_bus > 0 ? words_ms : ms,
            pixel_hash(result.image)};
}

Exchanges exchanges_of(Laboratory& lab, const LabelledScene& scene, std::uint32_t size, std::uint32_t pes,
                       AntialiasMethod method) {
    const raya_mapping mapping = cyclic(size, size, pes, root_offset(pes) % size);
    const auto by = [&](ExchangeWay way) { return way_of(lab, scene, mapping, {.method = method, .exchange = way}); };
    return {pes,
            mapping.parameter,
            antialias_name(method),
            by(ExchangeWay::kRing),
            by(ExchangeWay::kBus),
            by(ExchangeWay::kBroadcast)};
}

// The first P from which on the ring takes less than the best of the bus; 0: not even on the most PEs.
std::uint32_t ring_wins_from(const Rows& rows, double (Exchanges::*bus)() const) {
    std::uint32_t from = 0;
    for (const Exchanges& row : rows) {
        const bool wins = row.ring.ms < (row.*bus)();
        if (!wins) from = 0;
        if (wins && from == 0) from = row.pes;
    }
    return from;
}

std::string from_text(std::uint32_t pes) {
    return pes > 0 ? fmt::format("from {} PEs on", pes) : "nowhere up to there";
}

std::string finding_of_ring(const Rows& rows) {
    const Exchanges& last = rows.back();
    return finding(
        kName, "ring", "antialias"_a = last.antialias, "from"_a = from_text(ring_wins_from(rows, &Exchanges::best_ms)),
        "least"_a = from_text(ring_wins_from(rows, &Exchanges::best_least_ms)), "pes"_a = last.pes,
        "ring"_a = last.ring.ms, "rotations"_a = last.ring.moves, "bus"_a = last.bus.ms, "transfers"_a = last.bus.moves,
        "broadcast"_a = last.broadcast.ms, "broadcasts"_a = last.broadcast.moves,
        "times"_a = last.best_ms() / last.ring.ms, "least_times"_a = last.best_least_ms() / last.ring.ms);
}

StudyTable table_of_ways(const Rows& rows) {
    const auto of = [](Way Exchanges::*way, auto Way::*figure) {
        return [=](const Exchanges& row) { return (row.*way).*figure; };
    };
    return table_of(kName, "The exchange of neighbours by each way", rows,
                    {{"anti-aliasing", &Exchanges::antialias},
                     {"P", &Exchanges::pes},
                     {"p", &Exchanges::offset},
                     {"rotations", of(&Exchanges::ring, &Way::moves)},
                     {"ring", of(&Exchanges::ring, &Way::ms), "ms"},
                     {"transfers", of(&Exchanges::bus, &Way::moves)},
                     {"bus", of(&Exchanges::bus, &Way::ms), "ms"},
                     {"bus, words alone", of(&Exchanges::bus, &Way::least_ms), "ms"},
                     {"broadcasts", of(&Exchanges::broadcast, &Way::moves)},
                     {"broadcasts, time", of(&Exchanges::broadcast, &Way::ms), "ms"},
                     {"broadcasts, words alone", of(&Exchanges::broadcast, &Way::least_ms), "ms"},
                     {"bus / ring", &Exchanges::bus_over_ring},
                     {"broadcasts / ring", &Exchanges::broadcast_over_ring}});
}

StudyPlot plot_of(const Rows& rows) {
    const std::string& method = rows.front().antialias;
    StudyPlot plot{fmt::format("{}-{}", kName, method),
                   fmt::format("Time of the exchange against the number of PEs, {}", method), "PEs",
                   "exchange (modelled ms)", Axes::kLogBoth};
    const auto add = [&](const char* label, Way Exchanges::*way, double Way::*figure) {
        plot.series.push_back(
            line(label, rows, &Exchanges::pes, [=](const Exchanges& row) { return (row.*way).*figure; }));
    };
    add("ring", &Exchanges::ring, &Way::ms);
    add("bus, PE to PE", &Exchanges::bus, &Way::ms);
    add("broadcasts by PEs", &Exchanges::broadcast, &Way::ms);
    add("bus, PE to PE, words alone", &Exchanges::bus, &Way::least_ms);
    add("broadcasts by PEs, words alone", &Exchanges::broadcast, &Way::least_ms);
    return plot;
}

}  // namespace

StudyPage study_bus(Laboratory& lab, const Scenes& scenes) {
    const LabelledScene scene = one_of(scenes);
    const std::uint32_t size = lab.size(256);
    std::vector<std::uint32_t> pes;
    for (std::uint32_t p = kFewest; p <= std::min(kMost, size * size); p *= 2) pes.push_back(p);
    const auto rows_by = [&](AntialiasMethod method) {
        return each(pes, [&](std::uint32_t p) { return exchanges_of(lab, scene, size, p, method); });
    };
    const Rows filtered = rows_by(AntialiasMethod::kFilter), compared = rows_by(AntialiasMethod::kSupersample);
    Rows all = filtered;
    all.insert(all.end(), compared.begin(), compared.end());
    StudyPage page = page_about(
        kName,
        {{"scene", scene.label}, {"size", size}, {"pes", pes}, {"format", format_name(format_for(scene.scene))}});
    page.clock = sentence(kName, "clock");
    page.findings = {
        finding_of_ring(filtered), finding_of_ring(compared),
        finding(kName, "images", "same"_a = std::ranges::count_if(all, &Exchanges::same_image), "cases"_a = all.size()),
        sentence(kName, "why")};
    page.tables = {table_of_ways(all)};
    page.plots = {plot_of(filtered), plot_of(compared)};
    page.news = {sentence(kName, "news")};
    return page;
}

}  // namespace raya
