#include "cli/parse.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>

#include "error.hpp"
#include "ring/mapping.hpp"
#include "scene/generate.hpp"

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

std::vector<std::uint32_t> parse_voxels(const std::string& text) {
    std::vector<std::uint32_t> sides = parse_sizes(text);
    if (sides.size() != 3)
        throw UserError(fmt::format("--voxels {}: must be XxYxZ, 1..{} each", text, kMostVoxelsAlongAxis));
    return sides;
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
        const bool whole = type == "N" || type == "P" || type == "p" || type == "V" || type == "L";
        option->check([whole](const std::string& value) -> std::string {
            if (value.empty()) return "must not be empty";
            const bool digits = value.find_first_not_of("0123456789") == std::string::npos;
            return whole && !digits ? "'" + value + "' is not a whole number" : "";
        });
    }
}

}  // namespace raya
