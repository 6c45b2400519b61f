#include "host/cli/parse.hpp"

#include <fmt/core.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <sstream>
#include <string_view>

#include "host/cli/options.hpp"
#include "host/error.hpp"

namespace raya {

std::vector<std::uint32_t> parse_sizes(const std::string& text) {
    constexpr std::uint32_t kMaxSize = 1'000'000;  // so that the product of three sizes fits in 64 bits
    std::vector<std::uint32_t> sizes;
    const char* position = text.data();
    const char* const end = position + text.size();
    for (;;) {
        std::uint32_t size = 0;
        const auto [next, error] = std::from_chars(position, end, size);
        if (error != std::errc{} || size < 1 || size > kMaxSize) return {};
        sizes.push_back(size);
        if (next == end) return sizes;
        if (*next != 'x') return {};
        position = next + 1;
    }
}

ImageSize parse_image_size(const std::string& text) {
    const std::vector<std::uint32_t> sides = parse_sizes(text);
    if (sides.empty() || sides.size() > 2)
        throw UserError(fmt::format("--size {}: must be N or WxH, 1..{} pixels a side", text, kMaxSide));
    return {sides.front(), sides.back()};
}

std::array<std::uint32_t, 3> parse_three_sides(const std::string& option, const std::string& text,
                                               const std::string& legal_values) {
    const std::vector<std::uint32_t> sides = parse_sizes(text);
    if (sides.size() != 3) throw UserError(fmt::format("{} {}: must be XxYxZ, {}", option, text, legal_values));
    return {sides[0], sides[1], sides[2]};
}

Shard parse_shard(const std::string& text) {
    const char *const end = text.data() + text.size(), *at = text.data();
    const auto reads = [&](std::uint32_t& number) {
        const auto [stop, error] = std::from_chars(at, end, number);
        at = stop;
        return error == std::errc{};
    };
    Shard shard;
    const bool is_valid = reads(shard.number) && at != end && *at++ == '/' && reads(shard.count) && at == end;
    if (!is_valid || shard.number < 1 || shard.number > shard.count)
        throw UserError(fmt::format("--shard {}: must be I/N with I 1..N, such as 2/4", text));
    return shard;
}

Accel parse_accel(const std::string& text) {
    if (text == "none") return {};
    if (text == "bvh") return {.kind = AccelKind::kBvh};
    if (text == "grid") return {.kind = AccelKind::kGrid, .divisions = {}};
    const std::vector<std::uint32_t> sides =
        text.starts_with("grid:") ? parse_sizes(text.substr(5)) : std::vector<std::uint32_t>{};
    if (sides.size() != 3)
        throw UserError(
            fmt::format("--accel {}: must be none, bvh, grid or grid:AxBxC with A, B, C voxels along x, y, z", text));
    return {.kind = AccelKind::kGrid, .divisions = Divisions{sides[0], sides[1], sides[2]}};
}

std::vector<NumberFormat> parse_formats(const std::string& list) {
    std::vector<NumberFormat> formats;
    std::istringstream names(list);
    for (std::string name; std::getline(names, name, ',');) formats.push_back(parse_format(name));
    return formats;
}

void add_device_option(CLI::App& command, std::string& device) {
    const OptionGroup group(command, kKernels);
    offer_choices(
        add_value(command, "--device", device,
                  "OpenCL device: its number, type (gpu, cpu), or part of its name or version, as raya devices lists "
                  "them; default: RAYA_DEVICE, else the first GPU, else the first CPU",
                  "OpenCL device: its number, type or part of its name")
            ->type_name("NAME"),
        {"gpu", "cpu"});
}

namespace {

/// Parses a number, independently of the locale. Returns false unless the number is the whole field.
template <typename Number>
bool read_number(std::string_view field, Number& number) {
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), number);
    return error == std::errc{} && end == field.data() + field.size();
}

// Returns the integer in `text`; empty if `text` is not an integer in min..max.
std::optional<std::uint32_t> parse_number(std::string_view text, std::uint32_t min, std::uint32_t max) {
    std::uint32_t number = 0;
    if (!read_number(text, number) || number < min || number > max) return {};
    return number;
}

// Returns raya_pair(4, 8) for "4x8"; empty if `text` is not two numbers in 1..kMaxSide.
std::optional<std::uint32_t> parse_pair(std::string_view text) {
    const std::size_t cross = text.find('x');
    if (cross == std::string_view::npos) return {};
    const auto first = parse_number(text.substr(0, cross), 1, kMaxSide);
    const auto second = parse_number(text.substr(cross + 1), 1, kMaxSide);
    if (!first || !second) return {};
    return raya_pair(*first, *second);
}

constexpr std::uint32_t kDefaultSeed = 1;
constexpr std::uint32_t kMaxSeed = std::numeric_limits<std::uint32_t>::max();

// Returns the mapping's parameter. `text`: the part of mapping.text after the colon. Throws UserError with the legal
// form.
std::uint32_t parse_parameter(const MappingText& mapping, std::string_view text) {
    std::optional<std::uint32_t> parameter;
    std::string legal_form = mapping.name() + ", without a parameter";
    if (mapping.rule.kind == RAYA_GRID) {
        parameter = parse_pair(text);
        legal_form = fmt::format("grid:AxB with A rows of B PEs, A and B 1..{}", kMaxSide);
    } else if (mapping.rule.kind == RAYA_TILES) {
        parameter = parse_pair(text);
        legal_form = fmt::format("tiles:WxH with the sides of a tile in pixels, each 1..{}", kMaxSide);
    } else if (mapping.rule.kind == RAYA_RANDOM) {
        parameter = parse_number(text, 0, kMaxSeed);
        legal_form = fmt::format("random:seed with a seed 0..{}, or random", kMaxSeed);
    } else if (mapping.takes_offset_option) {
        parameter = parse_number(text, 0, kMaxSide - 1);
        legal_form = "cyclic:p with an offset p 0..W-1, less than the image's width, or cyclic";
    }
    if (!parameter) throw UserError(fmt::format("--mapping {}: must be {}", mapping.text, legal_form));
    return *parameter;
}

[[noreturn]] void refuse_dynamic_mapping(const std::string& text) {
    throw UserError(
        fmt::format("--mapping {}: must be dynamic:CHUNK[,OVERHEAD[,ROOT]] or hybrid:CHUNK[,OVERHEAD[,SHARE[,ROOT]]] "
                    "with CHUNK 1..{} pixels per request, OVERHEAD 0..{} cycles of the PE per request, ROOT 0..{} "
                    "cycles of the root per request, SHARE 0..1 of the pixels assigned statically",
                    text, kMaxChunk, kMaxOverhead, kMaxOverhead));
}

std::vector<std::string_view> split_at_commas(std::string_view text) {
    std::vector<std::string_view> fields;
    for (std::size_t at = 0; at != std::string_view::npos;) {
        const std::size_t comma = text.find(',', at);
        fields.push_back(text.substr(at, comma - at));
        at = comma == std::string_view::npos ? comma : comma + 1;
    }
    return fields;
}

}  // namespace

const std::vector<std::string>& mapping_forms() {
    static const std::vector<std::string> forms = {"cyclic", "cyclic:p", "column",    "rows",
                                                   "blocks", "grid:AxB", "tiles:WxH", "random:seed"};
    return forms;
}

MappingText parse_mapping(const std::string& text) {
    struct KnownMapping {
        const char* name;
        MappingRule rule;  // rule of the mapping without a parameter
        bool needs_parameter = false, takes_offset_option = false;
    };
    static const KnownMapping known_mappings[] = {{"cyclic", cyclic_mapping(0), false, true},
                                                  {"column", column_mapping()},
                                                  {"rows", rows_mapping()},
                                                  {"blocks", blocks_mapping()},
                                                  {"grid", grid_mapping(1, 1), true},
                                                  {"tiles", tiles_mapping(1, 1), true},
                                                  {"random", random_mapping(kDefaultSeed)}};
    const std::size_t colon = text.find(':');
    const auto* const found = std::find_if(std::begin(known_mappings), std::end(known_mappings),
                                           [&](const KnownMapping& n) { return n.name == text.substr(0, colon); });
    if (found == std::end(known_mappings))
        throw UserError(fmt::format("--mapping {}: no such mapping; mappings: {}, dynamic:CHUNK, hybrid:CHUNK", text,
                                    fmt::join(mapping_forms(), ", ")));
    MappingText mapping{text, found->rule, found->takes_offset_option};
    if (colon == std::string::npos && !found->needs_parameter) return mapping;
    mapping.rule.parameter = parse_parameter(mapping, colon == std::string::npos ? "" : text.substr(colon + 1));
    mapping.takes_offset_option = false;
    return mapping;
}

bool is_dynamic(const std::string& text) { return text.starts_with("dynamic") || text.starts_with("hybrid"); }

DynamicPlan parse_dynamic(const std::string& text, const DynamicPlan& defaults) {
    const std::string_view view = text;
    const bool hybrid = view.starts_with("hybrid:");
    if (!hybrid && !view.starts_with("dynamic:")) refuse_dynamic_mapping(text);
    const auto fields = split_at_commas(view.substr(view.find(':') + 1));
    DynamicPlan plan = defaults;
    if (hybrid) plan.static_fraction = 0.5;
    const std::size_t root_index = hybrid ? 3 : 2;  // index of the field ROOT
    const bool is_valid = fields.size() <= root_index + 1 && read_number(fields[0], plan.chunk) &&
                          (fields.size() < 2 || read_number(fields[1], plan.overhead)) &&
                          (fields.size() < 3 || !hybrid || read_number(fields[2], plan.static_fraction)) &&
                          (fields.size() <= root_index || read_number(fields[root_index], plan.root_cycles));
    if (!is_valid || !is_valid_plan(plan)) refuse_dynamic_mapping(text);
    return plan;
}

}  // namespace raya
