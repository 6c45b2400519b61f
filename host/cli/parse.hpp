// Option values that are more than one number.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace raya {

/// "512x256" as {512, 256}: `count` whole numbers from 1 to 10^6 with x between them. UserError names the option.
std::vector<std::uint32_t> parse_sizes(const std::string& option, const std::string& text, std::size_t count);

/// An image size: "512" (square) or "512x256".
std::vector<std::uint32_t> parse_image_size(const std::string& text);

}  // namespace raya
