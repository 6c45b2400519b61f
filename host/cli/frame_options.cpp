#include "host/cli/frame_options.hpp"

#include <fmt/core.h>

#include <charconv>
#include <cmath>
#include <filesystem>
#include <string_view>

#include "host/cli/camera_path.hpp"
#include "host/cli/file_options.hpp"
#include "host/cli/options.hpp"
#include "host/error.hpp"
#include "host/model/unit_text.hpp"
#include "host/scene/view.hpp"

namespace raya {
namespace {

constexpr std::uint32_t kMaxFrames = 999'999;
constexpr double kMaxTurnDegrees = 360'000;

[[noreturn]] void refuse_frames(const std::string& text) {
    throw UserError(
        fmt::format("--frames {}: must be A:B (frames A to B) or A:B/N (frames A to B of 1 to N), with numbers 0..{}",
                    text, kMaxFrames));
}

std::uint32_t parse_frame_number(const std::string& frames, std::string_view text) {
    std::uint32_t number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc{} || end != text.data() + text.size() || number > kMaxFrames) refuse_frames(frames);
    return number;
}

std::vector<Frame> frames_on_path(const FrameOptions& o, const View& view) {
    const std::vector<View> cameras = read_camera_path(o.camera_path, view);
    FrameRange range{1, static_cast<std::uint32_t>(cameras.size())};
    if (!o.frames.empty()) range = parse_frames(o.frames);
    if (range.first < 1 || range.last > cameras.size())
        throw UserError(fmt::format("--frames {}: {} has {}; choose frames from 1 to {}", o.frames, o.camera_path,
                                    counted(cameras.size(), "camera"), cameras.size()));
    std::vector<Frame> frames;
    for (std::uint32_t n = range.first; n <= range.last; ++n) frames.push_back({n, cameras[n - 1]});
    return frames;
}

}  // namespace

void add_frame_options(CLI::App& command, FrameOptions& o) {
    const OptionGroup group(command, "Frames");
    add_value(command, "--frames", o.frames,
              "Render frames A to B to numbered files IMAGE-0001.png, ..., also for --cost, --mask and --report; "
              "A:B/N: frames A to B of a sequence from 1 to N. IMAGE-frames.json records the frames; a frame with "
              "unchanged settings and files is not rendered again")
        ->type_name("A:B[/N]");
    add_value(command, "--turn", o.turn,
              "With --frames: turn the eye by this angle about the axis through --at along --up, anticlockwise seen "
              "from above, in equal steps from frame to frame; -360000..360000")
        ->type_name("DEGREES");
    add_file(command, FileUse::kRead, "--camera-path", o.camera_path, "FILE",
             "Cameras of the frames: each line of FILE has any of from, at, up and angle with their values, such as: "
             "from 1,2,3 angle 40. Empty lines and comments after # are ignored");
}

FrameRange parse_frames(const std::string& text) {
    const std::size_t colon = text.find(':'), slash = text.find('/');
    if (colon == std::string::npos || (slash != std::string::npos && slash < colon)) refuse_frames(text);
    const std::string_view view = text;
    FrameRange range;
    range.first = range.begin = parse_frame_number(text, view.substr(0, colon));
    range.last = range.end = parse_frame_number(text, view.substr(colon + 1, slash - colon - 1));
    if (slash != std::string::npos) {
        range.begin = 1;
        range.end = parse_frame_number(text, view.substr(slash + 1));
    }
    if (range.first > range.last || range.first < range.begin || range.last > range.end) refuse_frames(text);
    return range;
}

std::vector<Frame> frames_of(const FrameOptions& o, const View& view) {
    if (o.turn && !o.camera_path.empty())
        throw UserError("--turn and --camera-path both set the camera: leave out one of them");
    if (!o.camera_path.empty()) return frames_on_path(o, view);
    if (!o.turn)
        throw UserError(
            fmt::format("--frames {}: all frames would be equal; add --turn DEGREES or --camera-path FILE", o.frames));
    if (o.frames.empty()) throw UserError(fmt::format("--turn {} requires frames: add --frames A:B", *o.turn));
    if (!(std::abs(*o.turn) <= kMaxTurnDegrees))
        throw UserError(fmt::format("--turn {}: must be -{}..{} degrees", *o.turn, kMaxTurnDegrees, kMaxTurnDegrees));
    const FrameRange range = parse_frames(o.frames);
    const double frame_count = range.end - range.begin + 1.0;
    std::vector<Frame> frames;
    for (std::uint32_t n = range.first; n <= range.last; ++n)
        frames.push_back({n, turned(view, *o.turn * (n - range.begin) / frame_count)});
    return frames;
}

std::string numbered(const std::string& file, std::uint32_t frame) {
    if (file.empty()) return file;
    const std::filesystem::path path = file;
    const std::string extension = path.extension().string();
    return fmt::format("{}-{:04}{}", file.substr(0, file.size() - extension.size()), frame, extension);
}

}  // namespace raya
