#include "host/ring/mapping.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <limits>

#include "host/error.hpp"

namespace raya {
namespace {

// A whole number from least to most, written in digits alone.
std::optional<std::uint32_t> parse_number(const std::string& text, std::uint32_t least, std::uint32_t most) {
    std::uint32_t number = 0;
    const char* const end = text.data() + text.size();
    const auto [next, error] = std::from_chars(text.data(), end, number);
    if (error != std::errc{} || next != end || number < least || number > most) return {};
    return number;
}

// "4x8", each 1..kLargestSide, as raya_pair.
std::optional<std::uint32_t> parse_pair(const std::string& text) {
    const std::size_t cross = text.find('x');
    if (cross == std::string::npos) return {};
    const auto first = parse_number(text.substr(0, cross), 1, kLargestSide);
    const auto second = parse_number(text.substr(cross + 1), 1, kLargestSide);
    if (!first || !second) return {};
    return raya_pair(*first, *second);
}

constexpr std::uint32_t kDefaultSeed = 1;
constexpr std::uint32_t kLargestSeed = std::numeric_limits<std::uint32_t>::max();

// What follows the colon, where there is one: the parameter, or a refusal that says what it must be.
std::uint32_t parse_parameter(const MappingText& mapping, const std::string& rest) {
    std::optional<std::uint32_t> parameter;
    std::string legal = mapping.name + " alone";  // of those that take none
    if (mapping.kind == RAYA_GRID) {
        parameter = parse_pair(rest);
        legal = fmt::format("grid:AxB, A rows of B PEs, each 1..{}", kLargestSide);
    } else if (mapping.kind == RAYA_TILES) {
        parameter = parse_pair(rest);
        legal = fmt::format("tiles:WxH, the sides of a tile in pixels, each 1..{}", kLargestSide);
    } else if (mapping.kind == RAYA_RANDOM) {
        parameter = parse_number(rest, 0, kLargestSeed);
        legal = fmt::format("random:seed with a seed 0..{}, or random", kLargestSeed);
    } else if (mapping.name == "cyclic") {
        parameter = parse_number(rest, 0, kLargestSide - 1);
        legal = "cyclic:p with an offset p 0..W-1, less than the image's width, or cyclic";
    }
    if (!parameter) throw UserError(fmt::format("--mapping {}: must be {}", mapping.text, legal));
    return *parameter;
}

// The divisor of `side` that lies nearest to `wanted`, the lesser of two.
std::uint32_t nearest_divisor(std::uint32_t side, std::uint32_t wanted) {
    const auto away = [&](std::uint32_t d) { return d < wanted ? wanted - d : d - wanted; };
    std::uint32_t nearest = 1;
    for (std::uint32_t d = 2; d <= side; ++d)
        if (side % d == 0 && away(d) < away(nearest)) nearest = d;
    return nearest;
}

void check_tiles(const MappingText& text, const raya_mapping& m) {
    const std::uint32_t w = raya_first_of(m.parameter), h = raya_second_of(m.parameter);
    if (m.width % w == 0 && m.height % h == 0) return;
    throw UserError(
        fmt::format("--mapping {}: tiles must divide the image of {} x {} pixels; the nearest that do are tiles:{}x{}",
                    text.text, m.width, m.height, nearest_divisor(m.width, w), nearest_divisor(m.height, h)));
}

void check_pes(const MappingText& text, const raya_mapping& m) {
    const std::uint32_t pixels = m.width * m.height, own = text.pes().value_or(m.pes);
    if (own > pixels && text.pes())
        throw UserError(
            fmt::format("--mapping {}: {} PEs, must be 1..{}, a PE for each pixel at most", text.text, own, pixels));
    if (own != m.pes)
        throw UserError(fmt::format("--pes {} with --mapping {}: this grid has {} PEs; leave --pes out, or give {}",
                                    m.pes, text.text, own, own));
    if (m.pes < 1 || m.pes > pixels)
        throw UserError(fmt::format("--pes {}: must be 1..{}, a PE for each pixel at most", m.pes, pixels));
}

void check_offset(const MappingText& text, const raya_mapping& m) {
    if (m.parameter < m.width) return;
    const std::string option =
        text.parameter ? fmt::format("--mapping {}: the offset", text.text) : fmt::format("--offset {}:", m.parameter);
    throw UserError(fmt::format("{} must be 0..{}, less than the image's width", option, m.width - 1));
}

}  // namespace

std::optional<std::uint32_t> MappingText::pes() const {
    if (kind != RAYA_GRID) return {};
    return raya_first_of(*parameter) * raya_second_of(*parameter);
}

const std::vector<std::string>& mapping_forms() {
    static const std::vector<std::string> forms = {"cyclic", "cyclic:p", "column",    "rows",
                                                   "blocks", "grid:AxB", "tiles:WxH", "random:seed"};
    return forms;
}

MappingText parse_mapping(const std::string& text) {
    struct Name {
        const char* name;
        std::uint32_t kind;
        std::optional<std::uint32_t> alone;  // parameter of the name alone
    };
    static const Name names[] = {
        {"cyclic", RAYA_FOLD_CYCLIC, {}},     {"column", RAYA_FOLD_CYCLIC, 0}, {"rows", RAYA_ROWS, 0},
        {"blocks", RAYA_BLOCKS, 0},           {"grid", RAYA_GRID, {}},         {"tiles", RAYA_TILES, {}},
        {"random", RAYA_RANDOM, kDefaultSeed}};
    const std::size_t colon = text.find(':');
    const std::string name = text.substr(0, colon);
    const auto* const found =
        std::find_if(std::begin(names), std::end(names), [&](const Name& n) { return n.name == name; });
    if (found == std::end(names))
        throw UserError(
            fmt::format("--mapping {}: no such mapping, there are {}", text, fmt::join(mapping_forms(), ", ")));
    MappingText mapping{text, name, found->kind, found->alone};
    const bool needs_more = mapping.kind == RAYA_GRID || mapping.kind == RAYA_TILES;
    if (colon != std::string::npos || needs_more)
        mapping.parameter = parse_parameter(mapping, colon == std::string::npos ? "" : text.substr(colon + 1));
    return mapping;
}

raya_mapping make_mapping(const std::string& text, std::uint32_t width, std::uint32_t height, std::uint32_t pes,
                          std::uint32_t offset, const std::string& fold) {
    const MappingText parsed = parse_mapping(text);
    if (fold != "cyclic" && fold != "block") throw UserError(fmt::format("--fold {}: must be cyclic or block", fold));
    if (width < 1 || width > kLargestSide || height < 1 || height > kLargestSide)
        throw UserError(fmt::format("--size {}x{}: both sides must be 1..{} pixels", width, height, kLargestSide));
    raya_mapping mapping{width, height, pes, parsed.parameter.value_or(offset), parsed.kind};
    check_pes(parsed, mapping);
    if (mapping.kind == RAYA_TILES) check_tiles(parsed, mapping);
    if (!parsed.has_slots()) return mapping;
    check_offset(parsed, mapping);
    if (fold == "block") mapping.kind = RAYA_FOLD_BLOCK;
    return mapping;
}

std::string mapping_text(const raya_mapping& mapping) {
    const std::uint32_t first = raya_first_of(mapping.parameter), second = raya_second_of(mapping.parameter);
    switch (mapping.kind) {
        case RAYA_ROWS:
            return "rows";
        case RAYA_BLOCKS:
            return "blocks";
        case RAYA_GRID:
            return fmt::format("grid:{}x{}", first, second);
        case RAYA_TILES:
            return fmt::format("tiles:{}x{}", first, second);
        case RAYA_RANDOM:
            return fmt::format("random:{}", mapping.parameter);
        default:
            return fmt::format("cyclic:{}", mapping.parameter);
    }
}

std::uint32_t largest_share(const raya_mapping& mapping) {
    std::uint32_t largest = 0;
    for (std::uint32_t pe = 0; pe < mapping.pes; ++pe)
        largest = std::max(largest, raya_share_size(raya_share_of(mapping, pe)));
    return largest;
}

}  // namespace raya
