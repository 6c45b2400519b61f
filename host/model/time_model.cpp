#include "host/model/time_model.hpp"

#include <algorithm>
#include <numeric>

namespace raya {
namespace {

double milliseconds(std::uint64_t words, double words_per_s) { return 1e3 * static_cast<double>(words) / words_per_s; }

double milliseconds(std::uint64_t cycles, double cycle_ns, double factor) {
    return 1e-6 * cycle_ns * factor * static_cast<double>(cycles);
}

}  // namespace

Load load_of(std::vector<std::uint64_t> per_pe) {
    Load load;
    load.per_pe = std::move(per_pe);
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

std::optional<ModelledTime> modelled_time(const Machine& machine, std::span<const Load> phases,
                                          const Communication& communication, double factor,
                                          const SmoothingCycles& smoothing) {
    if (!machine.cycle_ns || !machine.link_words_per_s || !machine.rotation_sync_ms || !machine.host_words_per_s)
        return {};
    ModelledTime time;
    time.factor = factor;
    std::uint64_t cycles = smoothing.filter + smoothing.compare;
    for (const Load& load : phases) cycles += load.max;
    time.objects_ms = milliseconds(communication.broadcast_words, *machine.host_words_per_s);
    time.compute_ms = milliseconds(cycles, *machine.cycle_ns, factor);
    time.filter_ms = milliseconds(smoothing.filter, *machine.cycle_ns, factor);
    time.compare_ms = milliseconds(smoothing.compare, *machine.cycle_ns, factor);
    // In a rotation all P PEs send at the same time, each 1/P of the words. Transfers and broadcasts of PEs go over the
    // bus one at a time, so their words are not divided by P.
    const auto pes = static_cast<double>(phases.front().per_pe.size());
    const std::uint64_t synchronisations =
        communication.rotations + communication.transfers + communication.pe_broadcasts;
    time.communication_ms =
        static_cast<double>(synchronisations) * *machine.rotation_sync_ms +
        milliseconds(communication.rotation_words, *machine.link_words_per_s) / pes +
        milliseconds(communication.transfer_words + communication.pe_broadcast_words, *machine.link_words_per_s);
    time.image_ms = milliseconds(communication.gather_words, *machine.host_words_per_s);
    time.total_ms = time.objects_ms + time.compute_ms + time.communication_ms + time.image_ms;
    return time;
}

}  // namespace raya
