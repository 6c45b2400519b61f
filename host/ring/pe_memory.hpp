// Memory that a PE needs, and how much of its share fits. A PE of the machine accesses only its own memory.
#pragma once
#include <cstdint>
#include <string>

#include "host/model/machine.hpp"
#include "host/ring/antialias.hpp"

namespace raya {

/// Contents of the memory of each PE. A word has 4 bytes.
struct PeMemory {
    std::uint64_t job_words = 0;     // the broadcast words
    std::uint64_t tree_words = 0;    // traversal of one ray tree: the modelled PE traces one ray at a time
    std::uint32_t block_pixels = 0;  // traced pixels until they are gathered, 3 words each
    std::uint32_t sum_pixels = 0;    // sums of the filter, 3 words each
    std::uint32_t band_pixels = 0;   // pixels that are being exchanged, 3 words each
    std::uint32_t marks = 0;         // pixels to be supersampled, one byte each

    std::uint64_t bytes() const {
        return 4 * (job_words + tree_words + 3ull * (block_pixels + sum_pixels + band_pixels)) + marks;
    }
};

/// Memory demand of a render.
struct PeDemand {
    std::string scene;            // its name, for messages
    std::uint64_t job_words = 0;  // see PeMemory
    std::uint32_t bounces = 0;
    std::uint32_t share = 0;  // maximum number of pixels of a PE
    AntialiasMethod antialias = AntialiasMethod::kNone;
};

/// Without anti-aliasing, each PE gets space for its whole share if that fits, else for as many pixels as fit; the
/// image is then gathered block by block, as the paper's run on one PE (256 x 256 pixels, 32 KB) requires. With
/// anti-aliasing, each PE gets space for its whole share with sums or marks, and for a band of exchanged pixels, as
/// long as fits; all bands have about the same length. Throws DoesNotFit, with both figures and the remedy, if not even
/// a block or band of one pixel fits.
PeMemory plan_pe_memory(const Machine& machine, const PeDemand& demand);

}  // namespace raya
