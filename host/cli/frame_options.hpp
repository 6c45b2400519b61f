// Options of image sequences: frame numbers and cameras.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/scene/scene.hpp"

namespace CLI {
class App;
}

namespace raya {

/// As given on the command line; empty: one image.
struct FrameOptions {
    std::string frames, camera_path;
    std::optional<double> turn;  // degrees

    bool given() const { return !frames.empty() || !camera_path.empty() || turn.has_value(); }
};

/// Frames `first` to `last` of a sequence from `begin` to `end`.
struct FrameRange {
    std::uint32_t first = 1, last = 1, begin = 1, end = 1;
    bool operator==(const FrameRange&) const = default;
};

struct Frame {
    std::uint32_t number = 1;
    View view;
};

/// Adds --frames, --turn and --camera-path.
void add_frame_options(CLI::App& command, FrameOptions& options);

/// "A:B": the sequence of frames A to B; "A:B/N": frames A to B of a sequence from 1 to N. UserError.
FrameRange parse_frames(const std::string& text);

/// The frames with their cameras, derived from `view`. UserError for incompatible options or an invalid camera.
std::vector<Frame> frames_of(const FrameOptions& options, const View& view);

/// Inserts the frame's number: "turn.png" for frame 7 is "turn-0007.png". "" stays "".
std::string numbered(const std::string& file, std::uint32_t frame);

}  // namespace raya
