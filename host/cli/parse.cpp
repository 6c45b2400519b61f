#include "host/cli/parse.hpp"

#include <fmt/core.h>

#include <charconv>
#include <sstream>

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

AntialiasMethod parse_antialias(const std::string& text) {
    for (const AntialiasMethod method :
         {AntialiasMethod::kNone, AntialiasMethod::kFilter, AntialiasMethod::kSupersample})
        if (text == antialias_name(method)) return method;
    throw UserError(fmt::format("--antialias {}: must be none, filter or supersample", text));
}

ExchangeMethod parse_exchange(const std::string& text) {
    for (const ExchangeMethod method : {ExchangeMethod::kRing, ExchangeMethod::kBus, ExchangeMethod::kBroadcast})
        if (text == exchange_name(method)) return method;
    throw UserError(fmt::format("--exchange {}: must be ring, bus or bus-broadcast", text));
}

raya_u32 parse_points(const std::string& text) {
    for (const raya_u32 points : {RAYA_POINTS_AXES, RAYA_POINTS_DIAGONALS})
        if (text == points_name(points)) return points;
    throw UserError(fmt::format("--points {}: must be axes or diagonals", text));
}

Sampling parse_sampling(const std::string& text) {
    if (text == "centres") return Sampling::kCentres;
    if (text == "corners") return Sampling::kCorners;
    throw UserError(fmt::format("--sampling {}: must be centres or corners", text));
}

Links parse_links(const std::string& text) {
    for (const Links links : {Links::kTorus3d, Links::kTorus2d})
        if (text == links_name(links)) return links;
    throw UserError(fmt::format("--links {}: must be torus3d (6 links a node) or torus2d (4)", text));
}

void add_device_option(CLI::App& command, std::string& device) {
    const OptionGroup group(command, kKernels);
    offer_choices(
        add_value(command, "--device", device,
                  "OpenCL device: its number, type (gpu, cpu), or part of its name or version, as raya devices lists "
                  "them; default: RAYA_DEVICE, else the first GPU, else the first CPU")
            ->type_name("NAME"),
        {"gpu", "cpu"});
}

}  // namespace raya
