// Parsers of structured option values.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "host/accel/partition.hpp"
#include "host/model/mapping_rule.hpp"
#include "host/model/number_format.hpp"
#include "host/ring/antialias.hpp"
#include "host/scene/packer.hpp"
#include "host/torus/topology.hpp"

namespace CLI {
class App;
}

namespace raya {

/// Parses integers from 1 to 10^6 separated by x: {512, 256} for "512x256". Returns an empty vector for other texts.
std::vector<std::uint32_t> parse_sizes(const std::string& text);

/// Parses an image size: "512" (square) or "512x256". Throws UserError with the legal values. image_size()
/// checks that no side exceeds kMaxSide.
ImageSize parse_image_size(const std::string& text);

/// Parses three numbers, along x, y and z: "4x4x4". Throws UserError with `option` and `legal_values`, such as
/// "1..256 each".
std::array<std::uint32_t, 3> parse_three_sides(const std::string& option, const std::string& text,
                                               const std::string& legal_values);

/// A part of a command's work: the I-th of N shards.
struct Shard {
    std::uint32_t number = 1, count = 1;
};

/// Parses --shard: "I/N" with I 1..N. Throws UserError.
Shard parse_shard(const std::string& text);

/// Parses --accel: "none", "bvh", "grid" or "grid:AxBxC". Throws UserError with the option and its legal values.
Accel parse_accel(const std::string& text);

/// Parses a comma-separated list of formats, each as in --format.
std::vector<NumberFormat> parse_formats(const std::string& list);

// Parsers of keywords. They throw UserError with the option and its legal values.

/// --antialias: "none", "filter", "supersample".
AntialiasMethod parse_antialias(const std::string& text);
/// --exchange: "ring", "bus", "bus-broadcast".
ExchangeMethod parse_exchange(const std::string& text);
/// --points: "axes", "diagonals".
raya_u32 parse_points(const std::string& text);
/// --sampling: "centres", "corners".
Sampling parse_sampling(const std::string& text);
/// --links: "torus3d", "torus2d".
Links parse_links(const std::string& text);

/// Adds --device, a selector for choose_device().
void add_device_option(CLI::App& command, std::string& device);

}  // namespace raya
