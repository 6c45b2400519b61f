#include "host/cli/parse.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>

#include "host/error.hpp"
#include "host/ring/mapping.hpp"

namespace raya {

std::vector<std::uint32_t> parse_sizes(const std::string& text) {
    constexpr std::uint32_t kMost = 1'000'000;
    std::vector<std::uint32_t> sizes;
    const char* at = text.data();
    const char* const end = at + text.size();
    for (;;) {
        std::uint32_t size = 0;
        const auto [next, error] = std::from_chars(at, end, size);
        if (error != std::errc{} || size < 1 || size > kMost) return {};
        sizes.push_back(size);
        if (next == end) return sizes;
        if (*next != 'x') return {};
        at = next + 1;
    }
}

std::vector<std::uint32_t> parse_image_size(const std::string& text) {
    std::vector<std::uint32_t> sides = parse_sizes(text);
    if (sides.size() == 1) sides.push_back(sides[0]);
    if (sides.size() != 2)
        throw UserError(fmt::format("--size {}: must be N or WxH, 1..{} pixels a side", text, kLargestSide));
    return sides;
}

std::array<std::uint32_t, 3> parse_three_sides(const std::string& option, const std::string& text,
                                               const std::string& legal) {
    const std::vector<std::uint32_t> sides = parse_sizes(text);
    if (sides.size() != 3) throw UserError(fmt::format("{} {}: must be XxYxZ, {}", option, text, legal));
    return {sides[0], sides[1], sides[2]};
}

Accel parse_accel(const std::string& text) {
    if (text == "none") return {};
    if (text == "grid") return {.grid = true, .divisions = {}};
    const std::vector<std::uint32_t> sides =
        text.starts_with("grid:") ? parse_sizes(text.substr(5)) : std::vector<std::uint32_t>{};
    if (sides.size() != 3)
        throw UserError(
            fmt::format("--accel {}: must be none, grid or grid:AxBxC, A B C voxels along x, y and z", text));
    return {.grid = true, .divisions = Divisions{sides[0], sides[1], sides[2]}};
}

void add_device_option(CLI::App& command, std::string& device) {
    command
        .add_option("--device", device,
                    "OpenCL device: number or part of a name, see raya devices; default: RAYA_DEVICE, else the first "
                    "GPU, else the first CPU")
        ->type_name("NAME");
}

void refuse_odd_values(CLI::App& command) {
    for (CLI::Option* option : command.get_options()) {
        const std::string type = option->get_type_name();
        if (option->get_type_size() == 0) continue;  // a flag
        const bool whole = type == "N" || type == "P" || type == "p" || type == "V" || type == "L" || type == "BYTES";
        option->check([whole](const std::string& value) -> std::string {
            if (value.empty()) return "must not be empty";
            const bool digits = value.find_first_not_of("0123456789") == std::string::npos;
            return whole && !digits ? "'" + value + "' is not a whole number" : "";
        });
    }
}

}  // namespace raya
