// State of a ring render between two bands of pixels, for checkpoints.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "host/base/checkpoint.hpp"
#include "host/model/time_model.hpp"

namespace raya {

/// State of a render. Device data are those of all PEs, in the layout of the renderer's buffers ([PE][window], ...),
/// except that the events of a PE's work-items are summed.
struct RingState {
    struct Pass {
        std::vector<std::uint64_t> cycles, events;  // [PE][window], [PE][RAYA_EVENTS]
        std::vector<std::uint64_t> costs;           // cost of each pixel of the image, if recorded
    };

    std::uint32_t pass = 0;    // current pass: 0 trace, 1 supersample
    std::uint32_t window = 0;  // index, in each PE's share, of the first pixel that is on the device
    std::uint32_t next = 0;    // index, in each PE's share, of the first pixel that this pass has not traced
    RenderedPart part{};
    Communication communication;
    std::vector<float> image;              // colours of the pixels gathered so far, [H][W][3]
    std::vector<float> pixels;             // pixels on the device
    std::vector<std::uint8_t> marks;       // marks on the device; empty without supersampling
    std::vector<Pass> passes;              // [0] trace, [1] supersample
    std::vector<std::uint64_t> all_costs;  // cost of each pixel of the image, summed over the passes, if recorded
};

/// Returns the bytes of a checkpoint file.
std::string state_bytes(const RingState& state, const StateSettings& settings);

/// Reads a checkpoint. The vectors of `expected_sizes` must have the sizes of this render; their contents are not used.
/// Throws UserError as CheckpointReader does.
RingState read_state(std::string_view bytes, const StateSettings& settings, RingState expected_sizes);

}  // namespace raya
