// Checkpoint of a ring render, taken between two bands of pixels: the state that another run needs to resume the
// render, and the file format.
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
        std::vector<std::uint64_t> cycles, events;  // contents of PassCounters
        std::vector<std::uint64_t> costs;           // cost of each pixel of the image, if recorded
    };

    std::uint32_t pass = 0;    // current pass: 0 trace, 1 supersample
    std::uint32_t window = 0;  // index, in each PE's share, of the first pixel that is on the device
    std::uint32_t next = 0;    // index, in each PE's share, of the first pixel that this pass has not traced
    double fraction = 0;       // completed fraction of the render, 0..1
    double seconds = 0;        // measured time of all runs so far, seconds
    Communication communication;
    std::vector<float> image;              // colours of the pixels gathered so far, [H][W][3]
    std::vector<float> pixels;             // pixels on the device
    std::vector<std::uint8_t> marks;       // marks on the device; empty without supersampling
    std::vector<Pass> passes;              // [0] trace, [1] supersample
    std::vector<std::uint64_t> all_costs;  // cost of each pixel of the image, summed over the passes, if recorded
};

/// Names and values of all settings that determine the state. read_state() compares them, so that it rejects the
/// checkpoint of a different render. A name is an option, or a text that can follow "was rendered with". The value of a
/// flag is "yes" or "no".
using StateSettings = std::vector<std::pair<std::string, std::string>>;

/// First bytes of a checkpoint.
inline constexpr std::string_view kStateMagic = "raya state 2\n";

/// Returns the bytes of a checkpoint file.
std::string state_bytes(const RingState& state, const StateSettings& settings);

/// Reads a checkpoint. The vectors of `expected_sizes` must have the sizes of this render; their contents are not used.
/// Throws UserError, whose text does not contain the file's name, if the bytes are not a checkpoint, are damaged, or
/// belong to a different render. In the last case the text contains the first setting that differs.
RingState read_state(std::string_view bytes, const StateSettings& settings, RingState expected_sizes);

/// Callbacks for the checkpoints of a render.
struct RingCheckpointing {
    /// Target duration of a band, seconds.
    double band_s = 2;
    /// `due` is called after each band. If it returns true, `save` is called with the state.
    std::function<bool()> due;
    std::function<void(const RingState&, const StateSettings&)> save;
    /// Returns the checkpoint to resume, or empty to start from the beginning. Arguments: the renderer's settings, and
    /// the state for read_state().
    std::function<std::optional<RingState>(const StateSettings&, const RingState& expected_sizes)> resume;
};

}  // namespace raya
