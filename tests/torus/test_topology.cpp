// Node and voxel numbers, links and routes of the torus machine, on hundreds of machines of random shape.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdint>
#include <cstdlib>
#include <set>
#include <vector>

#include "tests/torus/random_torus.hpp"

using namespace raya;
using Catch::Contains;

namespace {

constexpr std::uint32_t kLinks[] = {0, 1, 2, 3, 4, 5};

bool same(const raya_place& a, const raya_place& b) { return std::equal(a.at, a.at + 3, b.at); }

// Returns [node]: distance from the node `source`. A breadth-first search over the links finds the distances
// independently of the torus's sides and of routing.
std::vector<std::uint32_t> searched_distances(const raya_torus& torus, std::uint32_t source) {
    std::vector<std::uint32_t> distances(raya_nodes(torus), UINT32_MAX), front = {source};
    distances[source] = 0;
    for (std::uint32_t steps = 1; !front.empty(); ++steps) {
        std::vector<std::uint32_t> next;
        for (const std::uint32_t node : front)
            for (const std::uint32_t link : kLinks) {
                const std::uint32_t end = raya_link_end(torus, node, link);
                if (distances[end] != UINT32_MAX) continue;
                distances[end] = steps;
                next.push_back(end);
            }
        front = next;
    }
    return distances;
}

// Returns the links that a packet takes. Stops after one link more than there are nodes. Returns RAYA_NO_LINK alone if
// the route ends in a wrong node.
std::vector<std::uint32_t> route_of(const raya_torus& torus, std::uint32_t source, std::uint32_t destination) {
    std::vector<std::uint32_t> links;
    for (std::uint32_t node = source; links.size() <= raya_nodes(torus);) {
        const std::uint32_t link = raya_next_link(torus, node, destination);
        if (link == RAYA_NO_LINK) return node == destination ? links : std::vector<std::uint32_t>{RAYA_NO_LINK};
        links.push_back(link);
        node = raya_link_end(torus, node, link);
    }
    return links;
}

// Returns the route that kernels/shared/torus.h defines, found by trying both directions round each side.
std::vector<std::uint32_t> defined_route(const raya_torus& torus, std::uint32_t source, std::uint32_t destination) {
    const raya_place a = raya_torus_place(torus, source), b = raya_torus_place(torus, destination);
    std::vector<std::uint32_t> links;
    for (std::uint32_t d = 0; d < 3; ++d) {
        std::uint32_t up = 0, down = 0;
        while ((a.at[d] + up) % torus.sides[d] != b.at[d]) ++up;
        while ((b.at[d] + down) % torus.sides[d] != a.at[d]) ++down;
        links.insert(links.end(), std::min(up, down), up <= down ? 2 * d : 2 * d + 1);
    }
    return links;
}

}  // namespace

TEST_CASE("links and sides have names", "[torus]") {
    CHECK(links_name(Links::kTorus3d) == "torus3d");
    CHECK(links_name(Links::kTorus2d) == "torus2d");
    CHECK(sides_text({4, 12, 1}) == "4x12x1");
}

TEST_CASE("a torus has 1 to 65,536 nodes", "[torus]") {
    for (const Links links : {Links::kTorus3d, Links::kTorus2d}) {
        CHECK(raya_nodes(make_torus({1, 1, 1}, links)) == 1);
        CHECK(raya_nodes(make_torus({64, 32, 32}, links)) == 65536);
        CHECK(raya_nodes(make_torus({1, 1, 65536}, links)) == 65536);
        for (const auto& nodes : std::vector<std::array<std::uint32_t, 3>>{
                 {0, 4, 4}, {4, 0, 4}, {4, 4, 0}, {0, 0, 0}, {0, UINT32_MAX, 1}}) {
            CAPTURE(sides_text(nodes));
            const std::string message = user_error_message([&] { make_torus(nodes, links); });
            CHECK_THAT(message, Contains(sides_text(nodes)));
            CHECK_THAT(message, Contains("1 or more") || Contains("more than 65536 nodes"));
        }
        for (const auto& nodes : std::vector<std::array<std::uint32_t, 3>>{
                 {65537, 1, 1}, {64, 32, 33}, {1u << 31, 1u << 31, 4}, {UINT32_MAX, UINT32_MAX, UINT32_MAX}}) {
            CAPTURE(sides_text(nodes));
            CHECK_THAT(user_error_message([&] { make_torus(nodes, links); }), Contains("more than 65536 nodes"));
        }
    }
}

TEST_CASE("4 x 4 x 4 nodes are a torus of 8 x 8 with four slabs of equal k", "[torus]") {
    const raya_torus torus = make_torus({4, 4, 4}, Links::kTorus2d);
    CHECK(torus_text(torus) == "4x4x4 on 8x8x1");
    CHECK(torus.slabs == 2);
    for (std::uint32_t node = 0; node < 64; ++node) {
        const std::uint32_t column = node % 8, row = node / 8;
        const raya_place place = raya_node_place(torus, node);
        CAPTURE(node);
        CHECK(place.at[0] == column % 4);
        CHECK(place.at[1] == row % 4);
        CHECK(place.at[2] == (column >= 4 ? 1u : 0u) + (row >= 4 ? 2u : 0u));
    }
    CHECK(torus_text(make_torus({4, 4, 4}, Links::kTorus3d)) == "4x4x4 on 4x4x4");
    CHECK(torus_text(make_torus({2, 8, 4}, Links::kTorus2d)) == "2x8x4 on 8x8x1");
    CHECK(torus_text(make_torus({1, 1, 2}, Links::kTorus2d)) == "1x1x2 on 1x2x1");  // 2x1x1 is equally square
    CHECK(torus_text(make_torus({8, 8, 1}, Links::kTorus2d)) == "8x8x1 on 8x8x1");
    CHECK(torus_text(make_torus({8, 2, 3}, Links::kTorus2d)) == "8x2x3 on 8x6x1");
}

TEST_CASE("a 2-D torus has sides as close to square as its nodes allow", "[torus]") {
    for (std::uint64_t seed = 1; seed <= 400; ++seed) {
        SplitMix random(seed);
        const auto nodes = random_sides(random, 24);
        const raya_torus torus = make_torus(nodes, Links::kTorus2d);
        CAPTURE(seed, torus_text(torus), torus.slabs);  // if two numbers of slabs give equal ratios, the smaller
        REQUIRE(torus.sides[2] == 1);
        REQUIRE(nodes[2] % torus.slabs == 0);
        REQUIRE(torus.sides[0] == nodes[0] * torus.slabs);
        REQUIRE(torus.sides[1] == nodes[1] * (nodes[2] / torus.slabs));
        for (std::uint32_t slabs = 1; slabs <= nodes[2]; ++slabs) {
            if (nodes[2] % slabs != 0) continue;
            const auto ratio = [&](std::uint64_t x, std::uint64_t y) {
                return double(std::max(x, y)) / double(std::min(x, y));
            };
            const double chosen_ratio = ratio(torus.sides[0], torus.sides[1]);
            const double slabs_ratio = ratio(nodes[0] * slabs, nodes[1] * (nodes[2] / slabs));
            CHECK((slabs < torus.slabs ? chosen_ratio < slabs_ratio : chosen_ratio <= slabs_ratio));
        }
    }
}

TEST_CASE("every node has one number and one place", "[torus]") {
    for (std::uint64_t seed = 1; seed <= 400; ++seed) {
        SplitMix random(seed);
        const raya_torus t = random_torus(random, 9);
        CAPTURE(seed, torus_text(t));
        std::set<std::uint32_t> numbers;
        for (std::uint32_t k = 0; k < t.nodes[2]; ++k)
            for (std::uint32_t j = 0; j < t.nodes[1]; ++j)
                for (std::uint32_t i = 0; i < t.nodes[0]; ++i) {
                    const std::uint32_t node = raya_node_of(t, i, j, k);
                    if (!numbers.insert(node).second) FAIL("two nodes have the number " << node);
                    if (node >= raya_nodes(t)) FAIL("number of a node too large: " << node);
                    if (!same(raya_node_place(t, node), {{i, j, k}})) FAIL("wrong raya_node_place() of node " << node);
                    const raya_place p = raya_torus_place(t, node);
                    if (raya_node_at(t, p) != node) FAIL("wrong raya_node_at() of the place of node " << node);
                    for (int d = 0; d < 3; ++d)
                        if (p.at[d] >= t.sides[d]) FAIL("node " << node << " has a place outside the torus");
                }
        CHECK(numbers.size() == raya_nodes(t));
    }
}

TEST_CASE("every voxel has one node and one local number", "[torus]") {
    for (std::uint64_t seed = 1; seed <= 400; ++seed) {
        SplitMix random(seed);
        const raya_torus t = random_torus(random, 5);
        const auto divisions = random_sides(random, 12);
        raya_grid g{};
        std::copy(divisions.begin(), divisions.end(), g.divisions);
        CAPTURE(seed, torus_text(t), sides_text(divisions));
        std::vector<std::set<std::uint32_t>> held(raya_nodes(t));
        for (std::uint32_t voxel = 0; voxel < raya_voxels(g); ++voxel) {
            const std::uint32_t node = raya_node_of_voxel(t, g, voxel), local = raya_local_voxel(t, g, voxel);
            if (!held.at(node).insert(local).second)
                FAIL("two voxels of node " << node << " have the local number " << local);
            if (raya_voxel_of_node(t, g, node, local) != voxel) FAIL("wrong raya_voxel_of_node() of voxel " << voxel);
            const raya_place v = raya_place_of(voxel, divisions[0], divisions[1]), n = raya_node_place(t, node);
            if (raya_voxel(g, v.at[0], v.at[1], v.at[2]) != voxel)
                FAIL("wrong raya_voxel() of the place of voxel " << voxel);
            for (int d = 0; d < 3; ++d)
                if (v.at[d] % t.nodes[d] != n.at[d]) FAIL("wrong node " << node << " of voxel " << voxel);
        }
        for (std::uint32_t node = 0; node < raya_nodes(t); ++node) {
            if (held[node].size() != raya_node_voxels(t, g, node)) FAIL("wrong raya_node_voxels() of node " << node);
            if (!held[node].empty() && *held[node].rbegin() + 1 != held[node].size())
                FAIL("gaps between the local voxel numbers of node " << node);
        }
    }
}

TEST_CASE("a link leads to a neighbouring place, and the opposite link of that place leads back", "[torus]") {
    for (std::uint64_t seed = 1; seed <= 400; ++seed) {
        SplitMix random(seed);
        const raya_torus t = random_torus(random, 9);
        CAPTURE(seed, torus_text(t));
        for (std::uint32_t node = 0; node < raya_nodes(t); ++node)
            for (const std::uint32_t link : kLinks) {
                const std::uint32_t end = raya_link_end(t, node, link), d = link / 2;
                if (raya_link_end(t, end, link ^ 1u) != node)
                    FAIL("the opposite of link " << link << " of node " << node << " does not lead back");
                raya_place lower = raya_torus_place(t, link % 2 ? end : node);
                lower.at[d] = (lower.at[d] + 1) % t.sides[d];
                if (!same(lower, raya_torus_place(t, link % 2 ? node : end)))
                    FAIL("link " << link << " of node " << node << " does not lead to the neighbouring place");
            }
    }
}

TEST_CASE("packets take the documented route, which is a shortest route", "[torus]") {
    for (std::uint64_t seed = 1; seed <= 300; ++seed) {
        SplitMix random(seed);
        const raya_torus t = random_torus(random, 6);
        CAPTURE(seed, torus_text(t));
        std::set<std::uint64_t> sums;
        for (std::uint32_t source = 0; source < raya_nodes(t); ++source) {
            const std::vector<std::uint32_t> distances = searched_distances(t, source);
            std::uint64_t sum = 0;
            for (std::uint32_t end = 0; end < raya_nodes(t); ++end) {
                const std::vector<std::uint32_t> links = route_of(t, source, end);
                if (links.size() != distances[end])
                    FAIL("not a shortest route: " << links.size() << " links from " << source << " to " << end);
                if (raya_node_distance(t, source, end) != distances[end])
                    FAIL("wrong raya_node_distance() from " << source << " to " << end);
                if (links != defined_route(t, source, end))
                    FAIL("not the documented route from " << source << " to " << end);
                sum += raya_node_distance(t, source, end);
            }
            sums.insert(sum);
        }
        CHECK(sums.size() == 1);  // a torus looks the same from every node
    }
}
