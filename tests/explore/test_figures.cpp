// What the explorer says of a setting, beside other ways to say it.
#include <catch2/catch.hpp>
#include <map>

#include "host/explore/figures.hpp"
#include "host/ring/route.hpp"
#include "host/ring/schedule.hpp"
#include "tests/explore/random_settings.hpp"

namespace raya {
namespace {

// Square of the least distance between two pixels of one PE, by looking at all pairs; 0 where no PE has two.
std::uint64_t nearest_pair(const raya_mapping& m) {
    std::map<std::uint32_t, std::vector<raya_pixel>> pixels;
    for (std::uint32_t row = 0; row < m.height; ++row)
        for (std::uint32_t column = 0; column < m.width; ++column)
            pixels[raya_owner(m, row, column)].push_back({row, column});
    std::uint64_t least = 0;
    for (const auto& [pe, own] : pixels)
        for (std::size_t i = 0; i < own.size(); ++i)
            for (std::size_t j = 0; j < i; ++j) {
                const std::int64_t rows = std::int64_t{own[i].row} - own[j].row,
                                   columns = std::int64_t{own[i].column} - own[j].column;
                const auto square = static_cast<std::uint64_t>(rows * rows + columns * columns);
                if (least == 0 || square < least) least = square;
            }
    return least;
}

TEST_CASE("the shortest vector is the least distance between two pixels of a PE", "[explore]") {
    // Of images in which the lattice has room: twice as many rows and columns as it repeats after.
    for (const std::uint32_t pes : {4u, 8u, 12u, 24u})
        for (std::uint32_t p = 0; p < 24; ++p)
            for (const std::uint32_t width : {24u, 48u}) {
                if (width / pes < 2) continue;
                const raya_mapping m = make_mapping(cyclic_mapping(p), {width, 48}, pes);
                INFO(pes << " PEs, p = " << p << ", width " << width);
                REQUIRE(shortest_vector_of(m));
                CHECK(shortest_vector_of(m)->square() == nearest_pair(m));
            }
    for (const auto& [a, b] : {std::pair{3u, 5u}, {5u, 3u}, {4u, 4u}, {1u, 6u}}) {
        const raya_mapping m = make_mapping(grid_mapping(a, b), {30, 30}, a * b);
        CHECK(shortest_vector_of(m).value().square() == nearest_pair(m));
    }
    CHECK(shortest_vector_of(make_mapping(rows_mapping(), {30, 30}, 7)).value() == LatticeVector{0, 1});
}

TEST_CASE("what is no lattice is told so", "[explore]") {
    CHECK_FALSE(shortest_vector_of(make_mapping(cyclic_mapping(3), {24, 24}, 7)));   // 7 does not divide 24
    CHECK_FALSE(shortest_vector_of(make_mapping(cyclic_mapping(3), {24, 24}, 48)));  // more PEs than columns
    CHECK_FALSE(shortest_vector_of(make_mapping(cyclic_mapping(3, Fold::kBlock), {24, 24}, 12)));
    CHECK(shortest_vector_of(make_mapping(cyclic_mapping(3, Fold::kBlock), {24, 24}, 24)));  // a PE for each column
    for (const MappingRule& rule : {blocks_mapping(), tiles_mapping(4, 4), random_mapping(1)})
        CHECK_FALSE(shortest_vector_of(make_mapping(rule, {24, 24}, 6)));
}

TEST_CASE("loads, moves and words are those of mapping, schedule and exchange plan", "[explore]") {
    const std::uint64_t seed = 20;
    INFO("seed " << seed);
    RandomSettings random(seed);
    for (int i = 0; i < 60; ++i) {
        const std::uint32_t width = random.from(1, 40), height = random.from(1, 30);
        const CostImage cost = random.costs(width, height, 20);
        const raya_mapping m = random.mapping(width, height);
        const ExplorerFigures f = figures_of(cost, m, machine_named("spa"));
        CHECK(f.load.per_pe == static_load(cost, m).per_pe);
        CHECK(f.load.per_pe[f.busiest] == f.load.max);
        CHECK(f.load.per_pe[f.idlest] == f.load.min);
        CHECK(f.share == largest_share(m));
        CHECK(f.rotations == sum_of(exchange_moves(m, ExchangeWay::kRing, false)));
        REQUIRE(f.time);
        CHECK(f.time->compute_ms == Approx(1e-4 * static_cast<double>(f.load.max)));  // 100 ns a cycle
    }
}

TEST_CASE("Kohata & Ito's rotations, on their array", "[explore]") {
    const CostImage cost{256, 256, std::vector<std::uint64_t>(65536, 1)};
    for (const auto& [p, rotations] : {std::pair{0u, 2u}, {8u, 18u}, {16u, 34u}}) {
        const ExplorerFigures f =
            figures_of(cost, make_mapping(cyclic_mapping(p), {256, 256}, 256), machine_named("spa"));
        CHECK(f.rotations == rotations);
        CHECK(f.share == 256);
        CHECK(f.load.imbalance == 0);
    }
}

TEST_CASE("figures as they are printed", "[explore]") {
    const CostImage cost{4, 2, {1000, 2, 3, 4, 5, 6, 7, 1234567}};
    const auto texts = figure_texts(figures_of(cost, make_mapping(cyclic_mapping(1), {4, 2}, 4), machine_named("spa")));
    const std::map<std::string, std::string> of(texts.begin(), texts.end());
    CHECK(of.size() == texts.size());
    CHECK(of.at("u") == "2.997");  // PE 2: 1,234,570 of 1,235,594
    CHECK(of.at("speedup") == "1.0 of 4");
    CHECK(of.at("efficiency") == "25.0 %");
    CHECK(of.at("busiest") == "1\u202f234\u202f570 cycles (PE 2)");
    CHECK(of.at("mean") == "308\u202f898.5 cycles");
    CHECK(of.at("vector") == "1.41 pixels (1 down, 1 right)");
    CHECK(grouped_text(999) == "999");
    CHECK(grouped_text(std::string("1000.25")) == "1\u202f000.25");
}

}  // namespace
}  // namespace raya
