// What a PE's memory has to hold, and what fits (promise 4 of the design: a PE touches only its own memory).
#pragma once
#include <cstdint>
#include <string>

#include "machine/machine.hpp"

namespace raya {

/// Words of 4 bytes in the memory of each PE.
struct PeMemory {
    std::uint64_t job_words = 0;     // the broadcast words
    std::uint64_t tree_words = 0;    // the walk through one ray tree: the modelled PE traces one ray at a time
    std::uint32_t block_pixels = 0;  // pixels that are kept until they are gathered, 3 words each

    std::uint64_t bytes() const { return 4 * (job_words + tree_words + 3ull * block_pixels); }
};

/// Gives each PE room for its whole share where that fits; else for as many pixels as fit, which are then gathered
/// block by block. The paper's run on one PE (256 x 256 pixels, 32 KB) needs that. UserError, with both figures and the
/// remedy, if not even one pixel fits.
PeMemory plan_pe_memory(const Machine& machine, const std::string& scene, std::uint64_t job_words,
                        std::uint32_t bounces, std::uint32_t share);

}  // namespace raya
