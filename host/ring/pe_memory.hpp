// Plan of a PE's memory: the contents, and the number of the PE's pixels that fit at a time. A PE of the ring machine
// can access only its own memory.
#pragma once
#include <cstdint>
#include <string>

#include "host/model/machine.hpp"
#include "host/ring/antialias.hpp"

namespace raya {

/// Contents of the memory of each PE. A word has 4 bytes.
struct PeMemory {
    std::uint64_t job_words = 0;   // number of words of the job, which are broadcast to all PEs
    std::uint64_t tree_words = 0;  // number of words of one ray tree's state: the modelled PE traces one ray at a time
    std::uint32_t block_pixels = 0;  // number of traced pixels that are not gathered yet, 3 words each
    std::uint32_t sum_pixels = 0;    // number of filter sums, 3 words each
    std::uint32_t band_pixels = 0;   // number of pixels received from another PE, 3 words each
    std::uint32_t marks = 0;         // number of marks for supersampling, one byte each

    std::uint64_t bytes() const {
        return 4 * (job_words + tree_words + 3ull * (block_pixels + sum_pixels + band_pixels)) + marks;
    }
};

/// Properties of a render that determine a PE's memory.
struct PeDemand {
    std::string scene;               // name of the scene, for messages
    std::uint64_t job_words = 0;     // see PeMemory
    std::uint32_t bounces = 0;       // maximum number of reflections and refractions after the primary ray
    std::uint32_t share_pixels = 0;  // maximum number of pixels that a PE owns
    AntialiasMethod antialias = AntialiasMethod::kNone;
};

/// Plans the memory of each PE. Without anti-aliasing, block_pixels is the whole share if the share fits. Otherwise it
/// is the number of pixels that fit, and the image is gathered block by block. (The paper's run on one PE, 256 x 256
/// pixels with 32 KB, requires this.) With anti-aliasing, each PE holds its whole share with sums or marks, and
/// band_pixels is the number of pixels that fit, reduced so that all bands have about the same length. Throws
/// DoesNotFit, with the required and available bytes and a remedy, if not even one pixel of the block or band fits.
PeMemory plan_pe_memory(const Machine& machine, const PeDemand& demand);

}  // namespace raya
