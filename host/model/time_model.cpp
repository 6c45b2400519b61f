#include "host/model/time_model.hpp"

namespace raya {
namespace {

double milliseconds(std::uint64_t words, double words_per_s) { return 1e3 * static_cast<double>(words) / words_per_s; }

double milliseconds(std::uint64_t cycles, double cycle_ns, double factor) {
    return 1e-6 * cycle_ns * factor * static_cast<double>(cycles);
}

}  // namespace

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
    // On the ring all PEs send at once, each its P-th part of the words; the bus carries one transfer after another.
    const auto pes = static_cast<double>(phases.front().per_pe.size());
    const std::uint64_t moves = communication.rotations + communication.transfers + communication.pe_broadcasts;
    time.communication_ms =
        static_cast<double>(moves) * *machine.rotation_sync_ms +
        milliseconds(communication.rotation_words, *machine.link_words_per_s) / pes +
        milliseconds(communication.transfer_words + communication.pe_broadcast_words, *machine.link_words_per_s);
    time.image_ms = milliseconds(communication.gather_words, *machine.host_words_per_s);
    time.total_ms = time.objects_ms + time.compute_ms + time.communication_ms + time.image_ms;
    return time;
}

}  // namespace raya
