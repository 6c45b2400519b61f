#include "host/explore/figures.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "host/model/unit_text.hpp"
#include "host/ring/mapping.hpp"
#include "host/ring/route.hpp"
#include "host/ring/schedule.hpp"

namespace raya {
namespace {

constexpr std::uint64_t kPixelWords = 3;

// Of the filter, whose sides come one after another.
std::uint64_t moves_of(const raya_mapping& mapping, ExchangeWay way) {
    return sum_of(exchange_moves(mapping, way, false));
}

std::string vector_text(const std::optional<LatticeVector>& vector) {
    if (!vector) return "no lattice";
    std::string way = fmt::format("{} down", vector->rows);
    if (vector->columns != 0)
        way += fmt::format(", {} {}", std::abs(vector->columns), vector->columns > 0 ? "right" : "left");
    return fmt::format("{:.2f} pixels ({})", std::sqrt(static_cast<double>(vector->square())), way);
}

std::string time_text_of(const std::optional<ModelledTime>& time) {
    if (!time) return "not known of this machine";
    return fmt::format("{} to trace, {} to rotate", time_text(time->compute_ms), time_text(time->communication_ms));
}

std::uint32_t first_with(const Load& load, std::uint64_t cycles) {
    return static_cast<std::uint32_t>(std::ranges::find(load.per_pe, cycles) - load.per_pe.begin());
}

}  // namespace

std::optional<LatticeVector> shortest_vector_of(const raya_mapping& m) {
    const bool repeats =
        m.kind == RAYA_FOLD_CYCLIC ? m.width % m.pes == 0 : m.width == m.pes;  // P < W, or one for each
    if (raya_has_slots(m) && repeats) return shortest_vector(m.parameter % m.pes, m.pes);
    if (m.kind == RAYA_ROWS) return LatticeVector{0, 1};
    if (m.kind != RAYA_GRID) return {};
    const LatticeVector down{raya_first_of(m.parameter), 0}, across{0, raya_second_of(m.parameter)};
    return across.square() <= down.square() ? across : down;
}

ExplorerFigures figures_of(const CostImage& cost, const raya_mapping& mapping, const Machine& machine) {
    ExplorerFigures f;
    f.load = static_load(cost, mapping);
    f.busiest = first_with(f.load, f.load.max);
    f.idlest = first_with(f.load, f.load.min);
    f.share = largest_share(mapping);
    f.vector = shortest_vector_of(mapping);
    f.rotations = moves_of(mapping, ExchangeWay::kRing);
    f.transfers = moves_of(mapping, ExchangeWay::kBus);
    f.pe_broadcasts = moves_of(mapping, ExchangeWay::kBroadcast);
    Communication communication;
    communication.rotations = f.rotations;
    communication.rotation_words = f.rotations * mapping.pes * kPixelWords * f.share;
    f.time = modelled_time(machine, {&f.load, 1}, communication);
    return f;
}

std::string grouped_text(std::string number) {
    for (std::size_t at = std::min(number.find('.'), number.size()); at > 3; at -= 3) number.insert(at - 3, "\u202f");
    return number;
}

std::string grouped_text(std::uint64_t number) { return grouped_text(fmt::format("{}", number)); }

FigureTexts figure_texts(const ExplorerFigures& f) {
    const auto of_pe = [](std::uint64_t cycles, std::uint32_t pe) {
        return fmt::format("{} cycles (PE {})", grouped_text(cycles), pe);
    };
    return {
        {"u", fmt::format("{:.3f}", f.load.imbalance)},
        {"speedup", fmt::format("{:.1f} of {}", f.load.speedup, f.load.per_pe.size())},
        {"efficiency", fmt::format("{:.1f} %", 100 * f.load.efficiency)},
        {"busiest", of_pe(f.load.max, f.busiest)},
        {"mean", grouped_text(fmt::format("{:.1f}", f.load.mean)) + " cycles"},
        {"idlest", of_pe(f.load.min, f.idlest)},
        {"vector", vector_text(f.vector)},
        {"rotations",
         fmt::format("{} rotations of {} words", grouped_text(f.rotations), grouped_text(kPixelWords * f.share))},
        {"bus", fmt::format("{} transfers or {} broadcasts", grouped_text(f.transfers), grouped_text(f.pe_broadcasts))},
        {"time", time_text_of(f.time)}};
}

}  // namespace raya
