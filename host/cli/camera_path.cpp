#include "host/cli/camera_path.hpp"

#include <fmt/core.h>

#include <charconv>
#include <map>
#include <sstream>

#include "host/base/standard_streams.hpp"
#include "host/base/whole_file.hpp"
#include "host/cli/view_options.hpp"
#include "host/error.hpp"
#include "host/scene/nff_tokens.hpp"

namespace raya {
namespace {

constexpr std::uint64_t kMaxPathFileBytes = 1 << 28;

std::string read_path_file(const std::string& file) try {
    std::string text = read_file(file, Pipes::kRead, kMaxPathFileBytes);
    if (text.starts_with(kByteOrderMark)) text.erase(0, kByteOrderMark.size());
    return text;
} catch (const UnreadableFile& why) {
    throw UserError(fmt::format("--camera-path {}: {}", file, why.what()));
}

double parse_angle(const std::string& text) {
    double angle = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), angle);
    if (error != std::errc{} || end != text.data() + text.size())
        throw UserError(fmt::format("angle {}: must be a number of degrees", in_quotes(text)));
    return angle;
}

// Parses the parameters of one camera. `tokens`: alternating names and values.
ViewOptions parse_camera(std::istringstream& tokens) {
    std::map<std::string, std::string> values = {{"from", ""}, {"at", ""}, {"up", ""}, {"angle", ""}};
    for (std::string name, value; tokens >> name;) {
        const auto entry = values.find(name);
        if (entry == values.end())
            throw UserError(
                fmt::format("{}: must be from, at, up or angle, each followed by its value", in_quotes(name)));
        if (!(tokens >> value)) throw UserError(fmt::format("{} has no value", name));
        if (!entry->second.empty()) throw UserError(fmt::format("'{}' is given twice", name));
        entry->second = value;
    }
    ViewOptions camera{.from = values["from"], .at = values["at"], .up = values["up"]};
    if (!values["angle"].empty()) camera.angle = parse_angle(values["angle"]);
    return camera;
}

}  // namespace

std::vector<View> read_camera_path(const std::string& file, const View& view) {
    std::istringstream lines(read_path_file(file));
    std::vector<View> cameras;
    std::size_t line_number = 0;
    for (std::string line; std::getline(lines, line);) {
        ++line_number;
        std::istringstream tokens(line.substr(0, line.find('#')));
        if ((tokens >> std::ws).eof()) continue;
        try {
            cameras.push_back(view);
            change_viewpoint(parse_camera(tokens), cameras.back());
        } catch (const UserError& why) {
            throw UserError(fmt::format("{}, line {}: {}", input_name(file), line_number, why.what()));
        }
    }
    if (cameras.empty()) throw UserError(fmt::format("{}: no camera; write one camera per line", input_name(file)));
    return cameras;
}

}  // namespace raya
