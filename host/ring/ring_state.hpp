// Checkpoint of a ring render between two bands of its pixels: all state that another run needs to resume it, and its
// file format.
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/base/json.hpp"
#include "host/model/time_model.hpp"

namespace raya {

/// State of a render. Device data have the layout of the renderer's buffers ([PE][window], ...).
struct RingState {
    struct Pass {
        std::vector<std::uint64_t> cycles, events;  // as PassCounters
        std::vector<std::uint64_t> costs;           // of the image's pixels, if they are recorded
    };

    std::uint32_t pass = 0;    // that was interrupted: 0 trace, 1 supersample
    std::uint32_t window = 0;  // first pixel of PEs' shares on the device
    std::uint32_t next = 0;    // first pixel of PEs' shares that the pass has not traced
    double share = 0;          // of the render that is complete, 0..1
    double seconds = 0;        // measured time of all runs so far
    Communication communication;
    std::vector<float> image;   // complete pixels
    std::vector<float> pixels;  // on the device
    std::vector<std::uint8_t> marks;
    std::vector<Pass> passes;  // one for each pass of the render
    std::vector<std::uint64_t> all_costs;
};

/// Names and values of all settings that determine the state, to reject the checkpoint of a different render. A name is
/// an option, or a text that can follow "was rendered with"; the value of a flag is "yes" or "no".
using StateSettings = std::vector<std::pair<std::string, std::string>>;

/// First bytes of a checkpoint.
inline constexpr std::string_view kStateMagic = "raya state 2\n";

std::string state_bytes(const RingState& state, const StateSettings& settings);

/// Reads a checkpoint into `like`, whose vectors must have the sizes of the render's. Throws UserError, without the
/// name of the file: not a checkpoint, damaged, or of a different render, with the first setting that differs.
RingState read_state(std::string_view bytes, const StateSettings& settings, RingState like);

/// Callbacks for the checkpoints of a render.
struct RingCheckpointing {
    /// Target time of a band, seconds.
    double band_s = 2;
    /// Called after each band; if it returns true, `keep` gets the state to save.
    std::function<bool()> due;
    std::function<void(const RingState&, const StateSettings&)> keep;
    /// Returns the checkpoint to resume, given the renderer's settings and a state of the right sizes; empty: none.
    std::function<std::optional<RingState>(const StateSettings&, const RingState& like)> resume;
};

}  // namespace raya
