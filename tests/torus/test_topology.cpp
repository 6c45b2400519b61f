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

// Returns the links that a ray, or a return, takes. Stops after one link more than there are nodes. Returns
// RAYA_NO_LINK alone if the route ends in a wrong node.
std::vector<std::uint32_t> route_of(const raya_torus& torus, std::uint32_t source, std::uint32_t destination,
                                    bool is_return = false) {
    std::vector<std::uint32_t> links;
    for (std::uint32_t node = source; links.size() <= raya_nodes(torus);) {
        const std::uint32_t link = is_return ? raya_return_link(torus, node) : raya_next_link(torus, node, destination);
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

TEST_CASE("a torus has 1 to 65,536 nodes", "[torus]") {
    CHECK(raya_nodes(make_torus({1, 1, 1}, Links::kTorus3d)) == 1);
    CHECK(raya_nodes(make_torus({64, 32, 32}, Links::kTorus2d)) == 65536);
    for (const auto& nodes : std::vector<std::array<std::uint32_t, 3>>{
             {0, 4, 4}, {0, UINT32_MAX, 1}, {65537, 1, 1}, {64, 32, 33}, {UINT32_MAX, UINT32_MAX, UINT32_MAX}})
        CHECK_THROWS_WITH(make_torus(nodes, Links::kTorus3d),
                          Contains(sides_text(nodes)) &&
                              Contains(nodes[0] == 0 ? "use 1 or more" : "more than 65536 nodes; use fewer"));
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
    CHECK(links_of_node(make_torus({4, 4, 4}, Links::kTorus3d)) == 6);
    CHECK(links_of_node(make_torus({4, 4, 4}, Links::kTorus2d)) == 4);
    CHECK(links_of_node(make_torus({1, 1, 2}, Links::kTorus2d)) == 2);
    CHECK(links_of_node(make_torus({1, 1, 1}, Links::kTorus3d)) == 0);
}

TEST_CASE("nodes, voxels and links: numbers and places agree", "[torus]") {
    for (std::uint64_t seed = 1; seed <= 200; ++seed) {
        SplitMix random(seed);
        const raya_torus t = random_torus(random, 7);
        const auto divisions = random_sides(random, 12);
        raya_grid g{};
        std::copy(divisions.begin(), divisions.end(), g.divisions);
        CAPTURE(seed, torus_text(t), sides_text(divisions));
        std::size_t wrong_nodes = 0, wrong_links = 0, wrong_voxels = 0;
        std::set<std::uint32_t> places;
        for (std::uint32_t node = 0; node < raya_nodes(t); ++node) {
            const raya_place of_node = raya_node_place(t, node), p = raya_torus_place(t, node);
            wrong_nodes +=
                raya_node_of(t, of_node.at[0], of_node.at[1], of_node.at[2]) != node || raya_node_at(t, p) != node;
            for (int d = 0; d < 3; ++d) wrong_nodes += of_node.at[d] >= t.nodes[d] || p.at[d] >= t.sides[d];
            for (const std::uint32_t link : kLinks) {
                const std::uint32_t end = raya_link_end(t, node, link), d = link / 2;
                raya_place lower = raya_torus_place(t, link % 2 ? end : node);
                lower.at[d] = (lower.at[d] + 1) % t.sides[d];
                wrong_links += raya_link_end(t, end, link ^ 1u) != node ||  // the opposite link leads back
                               !same(lower, raya_torus_place(t, link % 2 ? node : end));
            }
            // The local numbers of the node's voxels have no gaps.
            for (std::uint32_t local = 0; local < raya_node_voxels(t, g, node); ++local) {
                const std::uint32_t voxel = raya_voxel_of_node(t, g, node, local);
                const raya_place v = raya_place_of(voxel, divisions[0], divisions[1]);
                wrong_voxels += !places.insert(voxel).second || raya_node_of_voxel(t, g, voxel) != node ||
                                raya_local_voxel(t, g, voxel) != local ||
                                raya_voxel(g, v.at[0], v.at[1], v.at[2]) != voxel;
                for (int d = 0; d < 3; ++d) wrong_voxels += v.at[d] % t.nodes[d] != of_node.at[d];
            }
        }
        CHECK(wrong_nodes == 0);
        CHECK(wrong_links == 0);
        CHECK(wrong_voxels == 0);
        CHECK(places.size() == raya_voxels(g));
    }
}

TEST_CASE("packets take the documented route, which is a shortest route", "[torus]") {
    for (std::uint64_t seed = 1; seed <= 150; ++seed) {
        SplitMix random(seed);
        const raya_torus t = random_torus(random, 6);
        CAPTURE(seed, torus_text(t));
        for (std::uint32_t source = 0; source < raya_nodes(t); ++source) {
            const std::vector<std::uint32_t> distances = searched_distances(t, source);
            for (std::uint32_t end = 0; end < raya_nodes(t); ++end) {
                const std::vector<std::uint32_t> links = route_of(t, source, end);
                if (links.size() != distances[end])
                    FAIL("not a shortest route: " << links.size() << " links from " << source << " to " << end);
                if (end == RAYA_ROOT && route_of(t, source, end, true).size() != distances[end])
                    FAIL("not a shortest route of a return from " << source);
                if (links != defined_route(t, source, end))
                    FAIL("not the documented route from " << source << " to " << end);
            }
        }
    }
}
