// Distribution of PEs and nodes over ranks.
#include <algorithm>
#include <catch2/catch.hpp>

#include "tests/ranks/thread_ranks.hpp"
#include "tests/torus/random_torus.hpp"

namespace raya {

TEST_CASE("every PE belongs to one rank, and the ranks' numbers of PEs differ by at most one", "[ranks]") {
    for (const std::uint32_t pes : {1u, 2u, 5u, 8u, 256u, 1000u, 65'536u})
        for (std::uint32_t count = 1; count <= std::min(pes, 9u); ++count) {
            CAPTURE(pes, count);
            const std::vector<std::uint32_t> rank_of = ranks_of_pes(pes, count);
            CHECK(rank_of.size() == pes);
            CHECK(std::is_sorted(rank_of.begin(), rank_of.end()));
            for (std::uint32_t rank = 0; rank < count; ++rank) {
                const auto own = std::count(rank_of.begin(), rank_of.end(), rank);
                CHECK((own == pes / count || own == pes / count + 1));
            }
        }
    CHECK_THROWS_WITH(ranks_of_pes(3, 4),
                      Catch::Contains("4 ranks for 3 PEs") && Catch::Contains("start 3 ranks or fewer"));
}

TEST_CASE("elements of PEs are gathered in the order of the PEs, and scattered back", "[ranks]") {
    on_ranks(3, [](Ranks& ranks) {
        const Distribution pes({2, 0, 1, 0, 2, 2}, ranks);
        const auto count = [](std::uint32_t pe) { return std::size_t{pe} % 3; };  // PE n has n % 3 elements: 10 n + i
        std::vector<std::uint32_t> own, all;
        for (std::uint32_t pe = 0; pe < pes.all(); ++pe)
            for (std::uint32_t i = 0; i < count(pe); ++i) {
                all.push_back(10 * pe + i);
                if (pes.has(pe)) own.push_back(10 * pe + i);
            }
        CHECK(pes.total(count) == all.size());
        CHECK(pes.gather(own, count) == (ranks.is_first() ? all : std::vector<std::uint32_t>{}));
        CHECK(pes.scatter(ranks.is_first() ? all : std::vector<std::uint32_t>{}, count) == own);
        CHECK(pes.all_gather(pes.own(), 1) == std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5});
    });
}

TEST_CASE("each rank has a cuboid of nodes and one inbox for each link that ends there; rank 0 has the root",
          "[ranks]") {
    constexpr std::uint64_t kSeed = 99;
    SplitMix random(kSeed);
    for (int i = 0; i < 300; ++i) {
        const raya_torus torus = random_torus(random, 6);
        const std::uint32_t ranks = 1 + random_below(random, std::min(raya_nodes(torus), 12u));
        CAPTURE(kSeed, i, torus_text(torus), ranks);
        CHECK(ranks_of_nodes(torus, ranks)[RAYA_ROOT] == 0);
        for (std::uint32_t rank = 0; rank < ranks; ++rank) {
            Ranks this_rank = silent_rank(rank, ranks);
            const NodeDistribution distribution(torus, this_rank);
            REQUIRE(distribution.count() > 0);
            std::uint32_t nodes_of_box = 1;
            for (int axis = 0; axis < 3; ++axis) {
                std::uint32_t low = ~0u, high = 0;
                for (const std::uint32_t node : distribution.own()) {
                    low = std::min(low, raya_torus_place(torus, node).at[axis]);
                    high = std::max(high, raya_torus_place(torus, node).at[axis]);
                }
                nodes_of_box *= 1 + high - low;
            }
            CHECK(nodes_of_box == distribution.count());
            for (std::uint32_t link = 0; link < RAYA_LINKS; ++link) {
                std::vector<int> uses(distribution.inboxes());  // [inbox]: number of links that use it
                for (const std::uint32_t node : distribution.own())
                    ++uses.at(distribution.inbox_from(raya_link_end(torus, node, link ^ 1u), link));
                CHECK(std::ranges::count_if(uses, [](int n) { return n > 1; }) == 0);
            }
        }
    }
    const raya_torus cube = make_torus({4, 4, 4}, Links::kTorus3d);
    const std::pair<std::uint32_t, std::uint32_t> max_nodes[] = {{1, 64}, {2, 32}, {3, 24}, {4, 16},
                                                                 {7, 12}, {8, 8},  {64, 1}};
    for (const auto& [count, nodes] : max_nodes) {
        std::vector<std::uint32_t> nodes_of(count);
        for (const std::uint32_t rank : ranks_of_nodes(cube, count)) ++nodes_of.at(rank);
        CHECK(std::ranges::max(nodes_of) == nodes);
    }
    CHECK_THROWS_WITH(ranks_of_nodes(make_torus({2, 1, 1}, Links::kTorus3d), 3),
                      Catch::Contains("3 ranks for 2 nodes") && Catch::Contains("start 2 ranks or fewer"));
}

}  // namespace raya
