#include "host/ring/mapping.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "host/error.hpp"

namespace raya {
namespace {

// Returns the divisor of `side` that is nearest to `wanted`; the smaller one in a tie.
std::uint32_t nearest_divisor(std::uint32_t side, std::uint32_t wanted) {
    const auto distance = [&](std::uint32_t d) { return d < wanted ? wanted - d : d - wanted; };
    std::uint32_t nearest = 1;
    for (std::uint32_t d = 2; d <= side; ++d)
        if (side % d == 0 && distance(d) < distance(nearest)) nearest = d;
    return nearest;
}

void check_tiles(const raya_mapping& m) {
    const std::uint32_t w = raya_first_of(m.parameter), h = raya_second_of(m.parameter);
    if (m.width % w == 0 && m.height % h == 0) return;
    throw UserError(
        fmt::format("--mapping {}: tiles must divide the image of {} x {} pixels; the nearest are tiles:{}x{}",
                    mapping_text(m), m.width, m.height, nearest_divisor(m.width, w), nearest_divisor(m.height, h)));
}

void check_pes(const MappingRule& rule, const raya_mapping& m) {
    const std::uint32_t pixels = m.width * m.height, required_pes = rule.pes().value_or(m.pes);
    if (required_pes > pixels && rule.pes())
        throw UserError(fmt::format("--mapping {}: {} PEs: must be 1..{}, at most one for each pixel",
                                    mapping_text(rule), required_pes, pixels));
    if (required_pes != m.pes)
        throw UserError(fmt::format("--pes {} with --mapping {}: this mapping has {} PEs; omit --pes, or use {}", m.pes,
                                    mapping_text(rule), required_pes, required_pes));
    if (m.pes < 1 || m.pes > pixels)
        throw UserError(fmt::format("--pes {}: must be 1..{}, at most one for each pixel", m.pes, pixels));
}

void check_offset(const raya_mapping& m) {
    if (m.parameter < m.width) return;
    throw UserError(fmt::format("--mapping {}: the offset must be 0..{}, less than the image's width", mapping_text(m),
                                m.width - 1));
}

}  // namespace

raya_mapping make_mapping(const MappingRule& rule, const ImageSize& image, std::uint32_t pes) {
    const auto [width, height] = image;
    if (width < 1 || width > kMaxSide || height < 1 || height > kMaxSide)
        throw UserError(fmt::format("--size {}x{}: both sides must be 1..{} pixels", width, height, kMaxSide));
    const raya_mapping mapping{width, height, pes, rule.parameter, rule.kind};
    check_pes(rule, mapping);
    if (rule.kind == RAYA_TILES) check_tiles(mapping);
    if (rule.has_slots()) check_offset(mapping);
    return mapping;
}

std::string mapping_text(const MappingRule& rule) {
    const std::uint32_t first = raya_first_of(rule.parameter), second = raya_second_of(rule.parameter);
    switch (rule.kind) {
        case RAYA_ROWS:
            return "rows";
        case RAYA_BLOCKS:
            return "blocks";
        case RAYA_GRID:
            return fmt::format("grid:{}x{}", first, second);
        case RAYA_TILES:
            return fmt::format("tiles:{}x{}", first, second);
        case RAYA_RANDOM:
            return fmt::format("random:{}", rule.parameter);
        default:
            return fmt::format("cyclic:{}", rule.parameter);
    }
}

std::string mapping_text(const raya_mapping& mapping) {
    return mapping_text(MappingRule{mapping.kind, mapping.parameter});
}

std::uint32_t largest_share(const raya_mapping& mapping) {
    std::uint32_t largest = 0;
    for (std::uint32_t pe = 0; pe < mapping.pes; ++pe)
        largest = std::max(largest, raya_share_size(raya_share_of(mapping, pe)));
    return largest;
}

}  // namespace raya
