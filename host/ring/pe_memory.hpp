// What a PE's memory has to hold, and what fits (promise 4 of the design: a PE touches only its own memory).
#pragma once
#include <cstdint>
#include <string>

#include "host/model/machine.hpp"
#include "host/ring/antialias.hpp"

namespace raya {

/// What the memory of each PE holds, in words of 4 bytes, marks as bytes.
struct PeMemory {
    std::uint64_t job_words = 0;     // the broadcast words
    std::uint64_t tree_words = 0;    // the walk through one ray tree: the modelled PE traces one ray at a time
    std::uint32_t block_pixels = 0;  // pixels that are kept until they are gathered, 3 words each
    std::uint32_t sum_pixels = 0;    // sums of the filter, 3 words each
    std::uint32_t band_pixels = 0;   // pixels on their way round the ring, 3 words each
    std::uint32_t marks = 0;         // bytes: which pixels are supersampled

    std::uint64_t bytes() const {
        return 4 * (job_words + tree_words + 3ull * (block_pixels + sum_pixels + band_pixels)) + marks;
    }
};

/// What has to fit beside the machine itself.
struct PeDemand {
    std::string scene;            // its name, for messages
    std::uint64_t job_words = 0;  // see PeMemory
    std::uint32_t bounces = 0;
    std::uint32_t share = 0;  // pixels of the PE that owns most
    AntialiasMethod antialias = AntialiasMethod::kNone;
};

/// Without anti-aliasing: each PE gets room for its whole share where that fits; else for as many pixels as fit, which
/// are then gathered block by block. The paper's run on one PE (256 x 256 pixels, 32 KB) needs that.
/// With it: room for the whole share and its sums or marks, and for as long a band of pixels on their way round the
/// ring as fits, all bands alike. DoesNotFit, with both figures and the remedy, if not even one pixel, or one of a
/// band, fits.
PeMemory plan_pe_memory(const Machine& machine, const PeDemand& demand);

}  // namespace raya
