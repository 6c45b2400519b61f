#include "host/model/t805.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "host/model/budget.hpp"

namespace raya {
namespace {

std::uint32_t t805_cycles_of(const Budget& budget, const PacketCharge& packets) {
    // Number of operations that load an operand.
    const std::uint32_t operations = budget.additions + budget.multiplications + budget.divisions + budget.roots;
    return kT805AdditionCycles * budget.additions + kT805MultiplicationCycles * budget.multiplications +
           kT805DivisionCycles * budget.divisions + kT805SquareRootCycles * budget.roots +
           kT805OperandCycles * operations + kT805MoveCycles * budget.moves +
           kT805StoreCycles * packets.words_of(budget.creates) + kT805BranchCycles * budget.branches;
}

double milliseconds(double words, double words_per_s) { return 1e3 * words / words_per_s; }

// Returns the time of all broadcasts or all gathers, with one set-up, however many parts they have: Table 2 prints the
// same 140 ms for 256 PEs and for one PE, which sends its pixels in parts.
double host_ms(const MachineClock& clock, std::uint64_t words, double words_per_s) {
    if (words == 0 || std::isinf(words_per_s)) return 0;
    return clock.setup_ms + milliseconds(static_cast<double>(words), words_per_s);
}

}  // namespace

std::uint32_t PacketCharge::words_of(CreatedPacket packet) const {
    switch (packet) {
        case CreatedPacket::kRay:
            return ray_words;
        case CreatedPacket::kReturn:
            return return_words();
        case CreatedPacket::kContribution:
            return one_return_per_ray ? 0 : return_words();
        case CreatedPacket::kNone:
            break;
    }
    return 0;
}

std::array<std::uint32_t, RAYA_EVENTS> t805_cycles(const PacketCharge& packets) {
    std::array<std::uint32_t, RAYA_EVENTS> cycles{};
    for (std::size_t event = 0; event < cycles.size(); ++event)
        cycles[event] = t805_cycles_of(budgets()[event], packets);
    return cycles;
}

std::uint64_t t805_message_cycles(std::uint64_t messages, std::uint64_t words) {
    return kT805MessageCycles * messages + kT805MessageWordCycles * words;
}

double t805_link_ms(std::uint64_t words, std::uint64_t words_back) {
    constexpr double kMsPerS = 1e3, kBytesPerWord = 4;
    const auto [less, more] = std::minmax(words, words_back);
    return kMsPerS * kBytesPerWord *
           (2 * static_cast<double>(less) / kT805BothWaysBytesPerS +
            static_cast<double>(more - less) / kT805OneWayBytesPerS);
}

Load load_of(std::vector<std::uint64_t> per_pe) {
    Load load{.per_pe = std::move(per_pe)};
    const auto [lowest, highest] = std::minmax_element(load.per_pe.begin(), load.per_pe.end());
    load.min = *lowest;
    load.max = *highest;
    const auto pes = static_cast<double>(load.per_pe.size());
    const auto sum = static_cast<double>(std::accumulate(load.per_pe.begin(), load.per_pe.end(), std::uint64_t{0}));
    const auto max = static_cast<double>(load.max);
    load.mean = sum / pes;
    load.imbalance = sum > 0 ? (max - load.mean) / load.mean : 0;
    load.speedup = sum > 0 ? sum / max : pes;
    load.efficiency = load.speedup / pes;
    return load;
}

double compute_ms(const MachineClock& clock, double cycles) {
    return 1e-6 * clock.cycle_ns * clock.cycle_factor * cycles;
}

double exchange_ms(const MachineClock& clock, std::uint64_t rotations, double words) {
    if (rotations == 0) return 0;
    return clock.setup_ms + static_cast<double>(rotations) * clock.rotation_sync_ms +
           milliseconds(words, clock.link_words_per_s);
}

ModelledTime modelled_time(const MachineClock& clock, std::span<const Load> phases, const Communication& communication,
                           const SmoothingCycles& smoothing) {
    const auto number = [](std::uint64_t count) { return static_cast<double>(count); };
    const Communication& c = communication;
    ModelledTime time{.factor = clock.cycle_factor};
    std::uint64_t cycles = smoothing.filter + smoothing.compare + smoothing.wait;
    for (const Load& load : phases) cycles += load.max;
    time.compute_ms = compute_ms(clock, number(cycles));
    time.filter_ms = compute_ms(clock, number(smoothing.filter));
    time.compare_ms = compute_ms(clock, number(smoothing.compare));
    time.wait_ms = compute_ms(clock, number(smoothing.wait));
    time.objects_ms = host_ms(clock, c.broadcast_words, clock.broadcast_words_per_s);
    // In a rotation all P PEs send at the same time, each 1/P of the words. Transfers and broadcasts of PEs go over the
    // bus one at a time, so their words are not divided by P.
    const double link_words = number(c.rotation_words) / number(phases.front().per_pe.size()) +
                              number(c.transfer_words + c.pe_broadcast_words);
    time.communication_ms = exchange_ms(clock, c.rotations + c.transfers + c.pe_broadcasts, link_words);
    time.image_ms = host_ms(clock, c.gather_words, clock.gather_words_per_s);
    constexpr double kPixelWords = 3;
    time.display_ms = milliseconds(number(c.gather_words) / kPixelWords, clock.display_pixels_per_s);
    time.total_ms = time.objects_ms + time.compute_ms + time.communication_ms + time.image_ms + time.display_ms;
    return time;
}

}  // namespace raya
