// Option values that are more than one number.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "host/grid/accel.hpp"

namespace CLI {
class App;
}

namespace raya {

/// "512x256" as {512, 256}: whole numbers from 1 to 10^6 with x between them; empty for anything else.
std::vector<std::uint32_t> parse_sizes(const std::string& text);

/// An image size: "512" (square) or "512x256". UserError names the option and its legal values; the range is checked
/// later.
std::vector<std::uint32_t> parse_image_size(const std::string& text);

/// Three numbers, along x, y and z: "4x4x4". UserError names the option and its legal values, "1..256 each".
std::array<std::uint32_t, 3> parse_three_sides(const std::string& option, const std::string& text,
                                               const std::string& legal);

/// --accel: "none", "grid" or "grid:AxBxC". UserError as above.
Accel parse_accel(const std::string& text);

/// Adds --device: which one, see choose_device().
void add_device_option(CLI::App& command, std::string& device);

/// Makes every option of `command` refuse an empty value, and those that take whole numbers anything but digits: the
/// parser would take the first as not given and wrap negative numbers round.
void refuse_odd_values(CLI::App& command);

}  // namespace raya
