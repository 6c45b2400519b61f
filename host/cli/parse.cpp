#include "cli/parse.hpp"

#include <fmt/format.h>

#include <charconv>

#include "error.hpp"

namespace raya {

std::vector<std::uint32_t> parse_sizes(const std::string& option, const std::string& text, std::size_t count) {
    constexpr std::uint32_t kMost = 1'000'000;
    std::vector<std::uint32_t> sizes;
    const char* at = text.data();
    const char* const end = at + text.size();
    for (;;) {
        std::uint32_t size = 0;
        const auto [next, error] = std::from_chars(at, end, size);
        if (error != std::errc{} || size < 1 || size > kMost) break;
        sizes.push_back(size);
        at = next;
        if (at == end || *at != 'x') break;
        ++at;
    }
    if (at != end || sizes.size() != count) {
        throw UserError(fmt::format("{} {}: must be {} whole numbers from 1 to {} with x between them", option, text, count, kMost));
    }
    return sizes;
}

std::vector<std::uint32_t> parse_image_size(const std::string& text) {
    if (text.find('x') != std::string::npos) return parse_sizes("--size", text, 2);
    const std::uint32_t side = parse_sizes("--size", text, 1)[0];
    return {side, side};
}

}  // namespace raya
