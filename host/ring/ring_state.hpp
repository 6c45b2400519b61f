// A render that stands still between two bands of its pixels: all that another run needs to go on, as bytes for a file.
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

/// What lies on the device is as the renderer's buffers have it, [PE][window] and so on; of each pass there is one in
/// `passes`.
struct RingState {
    struct Pass {
        std::vector<std::uint64_t> cycles, events;  // as PassCounters
        std::vector<std::uint64_t> costs;           // of the image's pixels, where they are kept
    };

    std::uint32_t pass = 0;    // that stands still: 0 trace, 1 supersample
    std::uint32_t window = 0;  // first pixel of PEs' shares that lies on the device
    std::uint32_t next = 0;    // first pixel of PEs' shares that the pass has not traced
    double share = 0;          // of all that is to be done, 0..1
    double seconds = 0;        // measured: what was done took, in all runs
    Communication communication;
    std::vector<float> image;   // placed so far
    std::vector<float> pixels;  // on the device
    std::vector<std::uint8_t> marks;
    std::vector<Pass> passes;
    std::vector<std::uint64_t> all_costs;
};

/// Name and value of whatever a checkpoint's buffers and their values follow from, so that no other render resumes it.
/// The name is an option, or words that read well after "was rendered with"; of a flag the value is "yes" or "no".
using StateSettings = std::vector<std::pair<std::string, std::string>>;

/// How its bytes begin.
inline constexpr std::string_view kStateMagic = "raya state 2\n";

std::string state_bytes(const RingState& state, const StateSettings& settings);

/// Reads a state into `like`, which has the sizes of the render's vectors. Throws UserError without the file's name:
/// not a checkpoint, damaged, or of another render, and in what it differs.
RingState read_state(std::string_view bytes, const StateSettings& settings, RingState like);

/// How a render keeps its state.
struct RingKeeping {
    /// A band is to take about so many seconds.
    double band_s = 2;
    /// Asked after each band; what is due is given to `keep`.
    std::function<bool()> due;
    std::function<void(const RingState&, const StateSettings&)> keep;
    /// Where to go on, by the renderer's settings and a state of its sizes; none: at the beginning.
    std::function<std::optional<RingState>(const StateSettings&, const RingState& like)> resume;
};

}  // namespace raya
