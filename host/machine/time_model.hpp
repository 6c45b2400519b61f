// Modelled time of a machine: counted cycles and words, times what a cycle and a word take on it.
#pragma once
#include <cstdint>
#include <optional>
#include <span>

#include "machine/communication.hpp"
#include "machine/load.hpp"
#include "machine/machine.hpp"

namespace raya {

/// Cycles that the busiest PE spends on the arithmetic between neighbours (machine/budget.hpp); 0 without
/// anti-aliasing.
struct SmoothingCycles {
    std::uint64_t filter = 0, compare = 0;
};

/// In milliseconds. Display is not in it.
struct ModelledTime {
    double objects_ms = 0;        // broadcast of the scene
    double compute_ms = 0;        // all that the PEs compute: tracing, filter_ms and compare_ms
    double filter_ms = 0;         // of compute_ms: means of neighbouring pixels
    double compare_ms = 0;        // of compute_ms: comparisons with neighbouring pixels
    double communication_ms = 0;  // rotations of the ring
    double image_ms = 0;          // the image to the host
    double total_ms = 0;          // objects, compute, communication, image
    double factor = 1;            // that compute_ms was multiplied by
};

/// Empty where the machine's rates are not known. The phases' loads, one at least, are those of all PEs; the machine
/// waits for the busiest PE of each phase. `factor` > 0 is for cycles that the budget does not see; who fits it has to
/// report it.
std::optional<ModelledTime> modelled_time(const Machine& machine, std::span<const Load> phases,
                                          const Communication& communication, double factor = 1,
                                          const SmoothingCycles& smoothing = {});

}  // namespace raya
