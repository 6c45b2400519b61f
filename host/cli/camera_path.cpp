#include "host/cli/camera_path.hpp"

#include <fmt/core.h>

#include <charconv>
#include <sstream>

#include "host/cli/view_options.hpp"
#include "host/error.hpp"
#include "host/files/read_file.hpp"
#include "host/files/standard_streams.hpp"

namespace raya {
namespace {

constexpr std::uint64_t kMostBytes = 1 << 28;

std::string text_of(const std::string& file) try {
    return read_file(file, Pipes::kRead, kMostBytes);
} catch (const UnreadableFile& why) {
    throw UserError(fmt::format("--camera-path {}: {}", file, why.what()));
}

double angle_of(const std::string& text) {
    double angle = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), angle);
    if (error != std::errc{} || end != text.data() + text.size())
        throw UserError(fmt::format("angle {}: must be a number of degrees", text));
    return angle;
}

// `words`: a name and its value, and so on.
ViewOptions camera_of(std::istringstream& words) {
    ViewOptions camera;
    for (std::string name, value; words >> name;) {
        if (!(words >> value)) throw UserError(fmt::format("{} has no value", name));
        if (name == "from")
            camera.from = value;
        else if (name == "at")
            camera.at = value;
        else if (name == "up")
            camera.up = value;
        else if (name == "angle")
            camera.angle = angle_of(value);
        else
            throw UserError(fmt::format("{}: must be from, at, up or angle, each with its value behind it", name));
    }
    return camera;
}

}  // namespace

std::vector<View> read_camera_path(const std::string& file, const View& view) {
    std::istringstream lines(text_of(file));
    std::vector<View> cameras;
    std::size_t number = 0;
    for (std::string line; std::getline(lines, line);) {
        ++number;
        std::istringstream words(line.substr(0, line.find('#')));
        if ((words >> std::ws).eof()) continue;
        try {
            cameras.push_back(view);
            change_viewpoint(camera_of(words), cameras.back());
        } catch (const UserError& why) {
            throw UserError(fmt::format("{}, line {}: {}", input_name(file), number, why.what()));
        }
    }
    if (cameras.empty()) throw UserError(fmt::format("{}: no camera; each line is one", input_name(file)));
    return cameras;
}

}  // namespace raya
