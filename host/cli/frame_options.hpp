// A sequence of images of one scene, from the command line: which frames there are and where the camera is in each.
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

/// Adds --frames, --turn and --camera-path with their help texts.
void add_frame_options(CLI::App& command, FrameOptions& options);

/// "A:B", frames A to B, which are the whole sequence, or "A:B/N", of one from 1 to N. UserError.
FrameRange parse_frames(const std::string& text);

/// Each with its camera: that of `view` and what the options make of it. UserError where they do not go together, or a
/// camera sees nothing.
std::vector<Frame> frames_of(const FrameOptions& options, const View& view);

/// "turn.png" of frame 7: "turn-0007.png". Empty as it is.
std::string numbered(const std::string& file, std::uint32_t frame);

}  // namespace raya
