// Maps of owners, loads and nodes: which pixels are alike is what mapping and topology say.
#include <array>
#include <catch2/catch.hpp>
#include <map>
#include <random>
#include <set>

#include "host/report_page/maps.hpp"
#include "host/ring/mapping.hpp"
#include "host/torus/topology.hpp"

namespace raya {
namespace {

using Colour3 = std::array<float, 3>;

Colour3 colour(const Image& image, std::uint32_t row, std::uint32_t column) {
    const std::size_t at = 3 * (std::size_t{row} * static_cast<std::size_t>(image.width) + column);
    return {image.rgb.at(at), image.rgb.at(at + 1), image.rgb.at(at + 2)};
}

std::vector<double> different(std::uint32_t count) {
    std::vector<double> values;
    for (std::uint32_t i = 0; i < count; ++i) values.push_back(1000 + 7.0 * i);
    return values;
}

TEST_CASE("pixels have one colour exactly where they have one owner", "[report_page]") {
    for (const MappingRule& rule : {cyclic_mapping(3), cyclic_mapping(5, Fold::kBlock), rows_mapping(),
                                    blocks_mapping(), tiles_mapping(4, 2), random_mapping(9)}) {
        const raya_mapping m = make_mapping(rule, {32, 24}, 12);
        for (const Image& map : {load_map(m, different(12)), owner_close_up(m)}) {
            REQUIRE(map.width == 32);
            REQUIRE(map.height == 24);
            std::map<Colour3, std::set<std::uint32_t>> owners;
            for (std::uint32_t row = 0; row < 24; ++row)
                for (std::uint32_t column = 0; column < 32; ++column)
                    owners[colour(map, row, column)].insert(raya_owner(m, row, column));
            CHECK(owners.size() == 12);
            for (const auto& [_, pes] : owners) CHECK(pes.size() == 1);
        }
    }
}

TEST_CASE("more than the mean is red, less blue, as much grey", "[report_page]") {
    const raya_mapping m = make_mapping(rows_mapping(), {8, 3}, 3);
    const Image map = load_map(m, {5, 10, 15});
    const Colour3 less = colour(map, 0, 0), mean = colour(map, 1, 0), more = colour(map, 2, 0);
    CHECK(less[2] > 2 * less[0]);
    CHECK(more[0] > 2 * more[2]);
    CHECK(mean[0] == Approx(mean[1]).epsilon(0.01));
    CHECK(mean[2] == Approx(mean[1]).epsilon(0.01));
    for (const float value : load_map(m, {0, 0, 0}).rgb) CHECK(value == Approx(mean[0]).epsilon(0.01));
}

TEST_CASE("a large map holds means, a close-up its begin", "[report_page]") {
    const raya_mapping m = make_mapping(rows_mapping(), {1024, 512}, 2);
    const Image map = load_map(m, {1, 3});
    CHECK(map.width == 256);
    CHECK(map.height == 128);
    const Colour3 grey = colour(map, 0, 0);  // as many rows of the one as of the other
    CHECK(grey[0] == Approx(grey[2]).epsilon(0.01));
    CHECK(owner_close_up(m).width == static_cast<int>(kCloseUpSide));
}

TEST_CASE("each node has its cell, in slices", "[report_page]") {
    for (const Links links : {Links::kTorus3d, Links::kTorus2d})
        for (const auto& nodes : {std::array{4u, 4u, 4u}, {2u, 3u, 5u}, {1u, 1u, 1u}, {8u, 8u, 1u}}) {
            const raya_torus t = make_torus(nodes, links);
            const std::uint32_t count = raya_nodes(t);
            const Image map = node_map(t, different(count));
            std::map<Colour3, int> cells;
            for (std::uint32_t row = 0; row < static_cast<std::uint32_t>(map.height); ++row)
                for (std::uint32_t column = 0; column < static_cast<std::uint32_t>(map.width); ++column)
                    ++cells[colour(map, row, column)];
            std::uint32_t alone = 0;
            for (const auto& [_, times] : cells) alone += times == 1;
            CAPTURE(nodes, map.width, map.height);
            CHECK((count == 1 || alone >= count));
            CHECK(static_cast<std::uint32_t>(map.width * map.height) >= count);
        }
    CHECK_THROWS_AS(node_map(make_torus({2, 2, 2}, Links::kTorus3d), {1, 2}), std::out_of_range);
}

}  // namespace
}  // namespace raya
