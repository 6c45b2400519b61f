// Invariants of BVHs, checked on BVHs built from random items.
#include <algorithm>
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <set>

#include "host/accel/bvh.hpp"
#include "host/accel/hit_regions.hpp"
#include "host/scene/generate.hpp"
#include "host/scene/packer.hpp"
#include "host/scene/split_mix.hpp"
#include "tests/thorough.hpp"

namespace raya {
namespace {

BvhItem item_at(SplitMix& random, std::uint32_t number, double size, int layout) {
    constexpr std::array<std::uint32_t, 4> kinds = {RAYA_LINK_SPHERES, RAYA_LINK_FACES, RAYA_LINK_POLYGON,
                                                    RAYA_LINK_OBJECT};
    BvhItem item{{}, number, kinds[number % kinds.size()]};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double centre = layout == 0   ? random.uniform(-1, 1)
                              : layout == 1 ? 0.25  // all items in one place
                              : layout == 2 ? std::pow(2.0, -double(number % 60)) * (axis == 0)  // ever closer together
                                            : number % 7;                                        // in seven places
        item.box.low[axis] = static_cast<float>(centre - size);
        item.box.high[axis] = static_cast<float>(centre + size * random.uniform(0.5, 2));
    }
    return item;
}

/// Returns true if `outer` is the smallest box that contains the boxes of first .. end - 1.
template <class Boxed>
bool fits(const Bounds& outer, const Boxed* first, const Boxed* end) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto by_low = [&](const Boxed& a, const Boxed& b) { return a.box.low[axis] < b.box.low[axis]; };
        const auto by_high = [&](const Boxed& a, const Boxed& b) { return a.box.high[axis] < b.box.high[axis]; };
        if (outer.low[axis] != std::min_element(first, end, by_low)->box.low[axis] ||
            outer.high[axis] != std::max_element(first, end, by_high)->box.high[axis])
            return false;
    }
    return true;
}

/// Checks the invariants of a subtree and collects the numbers of its items. Returns the depth of the subtree: the
/// maximum number of nodes on a path to a leaf.
std::uint32_t check_child(const Bvh& tree, const BvhChild& child, std::multiset<std::uint32_t>& numbers) {
    if (child.kind != RAYA_LINK_NODE) {
        REQUIRE(child.items >= 1);
        REQUIRE(child.items <= max_leaf_items(child.kind));
        CHECK(fits(child.box, &tree.items[child.first], &tree.items[child.first] + child.items));
        for (std::uint32_t i = child.first; i < child.first + child.items; ++i) {
            CHECK(tree.items[i].kind == child.kind);
            if (i > child.first) CHECK(tree.items[i].number > tree.items[i - 1].number);
            numbers.insert(tree.items[i].number);
        }
        return 0;
    }
    const BvhNode& node = tree.nodes.at(child.first);
    REQUIRE(node.count >= 2);
    CHECK(fits(child.box, node.children.data(), node.children.data() + node.count));
    std::uint32_t depth = 0;
    for (std::uint32_t i = 0; i < node.count; ++i) {
        const BvhChild& grandchild = node.children[i];
        if (grandchild.kind == RAYA_LINK_NODE) CHECK(grandchild.first > child.first);
        depth = std::max(depth, check_child(tree, grandchild, numbers));
    }
    return depth + 1;
}

/// Requires that two BVHs have equal items, nodes and depth.
void require_equal(const Bvh& a, const Bvh& b) {
    const auto same_box = [](const Bounds& c, const Bounds& d) { return c.low == d.low && c.high == d.high; };
    const auto same_child = [&](const BvhChild& c, const BvhChild& d) {
        return same_box(c.box, d.box) && c.kind == d.kind && c.first == d.first && c.items == d.items;
    };
    REQUIRE(
        std::equal(a.items.begin(), a.items.end(), b.items.begin(), b.items.end(),
                   [&](const BvhItem& c, const BvhItem& d) { return c.number == d.number && same_box(c.box, d.box); }));
    REQUIRE(std::equal(
        a.nodes.begin(), a.nodes.end(), b.nodes.begin(), b.nodes.end(), [&](const BvhNode& c, const BvhNode& d) {
            return c.count == d.count &&
                   std::equal(c.children.begin(), c.children.begin() + c.count, d.children.begin(), same_child);
        }));
    REQUIRE(same_child(a.root, b.root));
    REQUIRE(a.depth == b.depth);
}

TEST_CASE("BVH: every item is in one leaf of its kind, boxes are tight, and order and threads change nothing",
          "[tree]") {
    for (unsigned seed = 1; seed <= quick_cases(60, 600); ++seed) {
        SplitMix random(seed);
        const int layout = static_cast<int>(seed % 4);
        // The largest trees have subtrees of several threads and splits by several threads.
        const auto count = static_cast<std::uint32_t>(seed <= 2 ? 70'000 + random.next() % 20'000
                                                                : 1 + random.next() % (seed % 5 == 0 ? 9'000 : 100));
        std::vector<BvhItem> items;
        for (std::uint32_t i = 0; i < count; ++i) items.push_back(item_at(random, i, 0.01, layout));
        const Bvh tree = build_bvh(items, 1);
        CAPTURE(seed, count, layout);
        std::multiset<std::uint32_t> numbers;
        CHECK(check_child(tree, tree.root, numbers) == tree.depth);
        CHECK(numbers.size() == count);
        CHECK(std::set<std::uint32_t>(numbers.begin(), numbers.end()).size() == count);
        CHECK(tree.depth <= 40);
        std::reverse(items.begin(), items.end());
        for (const unsigned threads : {1u, 2u, 3u, 8u}) {
            CAPTURE(threads);
            require_equal(build_bvh(items, threads), tree);
        }
    }
    CHECK(build_bvh({}).nodes.empty());
}

TEST_CASE("BVH: the same words for any number of threads", "[tree]") {
    for (const Scene& scene : {generate_random(9000, 3), generate_lattice(12), generate_gears(4)})
        for (const NumberFormat& format : {parse_format("fp32"), parse_format("e6m15")}) {
            CAPTURE(scene.name, format_name(format));
            const PackedJob job = pack_job(scene, {.image = {1, 1}, .format = format});
            PackedJob expected = job;
            const AccelSummary summary = append_bvh(expected, format, 1);
            for (const unsigned threads : {2u, 3u, 8u}) {
                PackedJob got = job;
                CHECK(append_bvh(got, format, threads).leaves == summary.leaves);
                CHECK(got.words() == expected.words());
            }
        }
}

/// Returns the bounding box of a sphere or polygon.
Box exact_box(const PackedJob& job, std::uint32_t number) {
    const auto& objects = job.header().objects;
    const auto real = [&](std::size_t at) { return double{std::bit_cast<float>(job.words()[at])}; };
    const auto vector = [&](std::size_t at) { return Vec3(real(at), real(at + 1), real(at + 2)); };
    if (number < objects.spheres) {
        const std::size_t at = objects.spheres_at + std::size_t{number} * RAYA_SPHERE_WORDS;
        const Vec3 radii(std::sqrt(std::abs(real(at + RAYA_SPHERE_SQUARE))));
        return {vector(at + RAYA_SPHERE_CENTRE) - radii, vector(at + RAYA_SPHERE_CENTRE) + radii};
    }
    const std::size_t polygon = number - objects.spheres - objects.planes;
    const std::size_t at = objects.polygons_at + polygon * RAYA_POLYGON_WORDS;
    Box box;
    for (std::uint32_t i = 0; i < job.words()[at + RAYA_POLYGON_CORNERS]; ++i)
        box.extend(vector(job.words()[at + RAYA_POLYGON_CORNERS_AT] + i * RAYA_CORNER_WORDS));
    return box;
}

TEST_CASE("BVH: hits in fp32 lie within RAYA_BVH_HIT_MARGIN of their objects' boxes", "[tree]") {
    for (const Scene& scene : {generate_random(500, 3), generate_gears(2)})
        for (const double reach : {2.0, 8.0, 64.0}) {
            CAPTURE(scene.name, reach);
            const PackedJob job = pack_job(scene, {.image = {1, 1}});
            const HitRegions regions(job, {}, reach);
            REQUIRE(regions.all_bounded());
            const double margin = RAYA_BVH_HIT_MARGIN * regions.reach();
            for (std::size_t i = 0; i < regions.size(); ++i) {
                const Box exact = exact_box(job, regions.number(i)), hits = regions.region(i).box;
                for (int axis = 0; axis < 3; ++axis) {
                    REQUIRE(hits.min[axis] >= exact.min[axis] - margin);
                    REQUIRE(hits.max[axis] <= exact.max[axis] + margin);
                }
            }
        }
}

}  // namespace
}  // namespace raya
