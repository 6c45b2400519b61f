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

/// The options as given on the command line. If none is given, the command renders one image.
struct FrameOptions {
    std::string frames, camera_path;
    std::optional<double> turn;  // degrees by which the eye turns about --at during the sequence

    bool given() const { return !frames.empty() || !camera_path.empty() || turn.has_value(); }
};

/// The frames to render, `first` to `last`, of a sequence whose frames are numbered `begin` to `end`.
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

/// Parses "A:B" (frames A to B are the whole sequence) or "A:B/N" (frames A to B of the sequence 1 to N). Throws
/// UserError for other texts.
FrameRange parse_frames(const std::string& text);

/// Returns the frames to render with their cameras. With --turn, a camera is `view` with a turned eye; with
/// --camera-path, it is `view` with the parameters of a line of the file. Throws UserError for incompatible options or
/// an invalid camera.
std::vector<Frame> frames_of(const FrameOptions& options, const View& view);

/// Inserts the frame's number before the extension: "turn.png" for frame 7 becomes "turn-0007.png". Returns "" for "".
std::string numbered(const std::string& file, std::uint32_t frame);

}  // namespace raya
