// Compares the grid traversal (traversal.clh) with a reference that uses bisection: a traversal visits voxels in order,
// misses none, and visits none that is far from the ray.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <set>

#include "host/scene/packer.hpp"
#include "tests/accel/random_grids.hpp"
#include "tests/accel/reference_traversal.hpp"
#include "tests/kernels/kernel_runner.hpp"
#include "tests/kernels/probe.hpp"

namespace raya {
namespace {

constexpr std::size_t kTraversedGrids = 50, kTraversedRays = 2048;  // kTraversedRays: number of rays per grid

struct Traversals {
    std::vector<std::uint32_t> wide;         // [ray]: 1 if the ray is wide, else 0
    std::vector<std::uint32_t> voxels;       // [ray][max_count]: voxel numbers, then RAYA_NO_VOXEL
    std::vector<float> t_exits;              // [ray][max_count]: t at which the ray leaves each voxel
    std::vector<float> resumed_t_exits;      // [ray][max_count]: as `t_exits`, if the traversal is resumed in the voxel
    std::vector<std::uint32_t> next_voxels;  // [ray][max_count]: the voxel that the resumed traversal visits next
};

Traversals traverse(KernelRunner& runner, const raya_grid& grid, const std::vector<float>& rays) {
    const std::size_t count = rays.size() / 7;
    const std::uint32_t max_count = max_voxels(grid);
    const auto grid_buffer = runner.filled("grid", grid_words(grid));
    const auto ray_buffer = runner.filled("rays", rays);
    auto wide = runner.constant<std::uint32_t>("wide", count, 0);
    auto voxels = runner.constant<std::uint32_t>("voxels", count * max_count, RAYA_NO_VOXEL);
    auto t_exits = runner.constant<float>("t_exits", count * max_count, 0);
    runner.run_rows<const Buffer<std::uint32_t>&, const Buffer<float>&, cl_uint, Buffer<std::uint32_t>&,
                    Buffer<std::uint32_t>&, Buffer<float>&>("traverse", count, grid_buffer, ray_buffer, max_count, wide,
                                                            voxels, t_exits);
    auto resumed = runner.constant<float>("resumed", count * max_count, 0);
    auto next_voxels = runner.constant<std::uint32_t>("next voxels", count * max_count, RAYA_NO_VOXEL);
    runner.run_rows<const Buffer<std::uint32_t>&, const Buffer<float>&, cl_uint, const Buffer<std::uint32_t>&,
                    Buffer<float>&, Buffer<std::uint32_t>&>("resume_in_voxels", count, grid_buffer, ray_buffer,
                                                            max_count, voxels, resumed, next_voxels);
    return {runner.read(wide), runner.read(voxels), runner.read(t_exits), runner.read(resumed),
            runner.read(next_voxels)};
}

/// The voxels that a ray visits, in order, and the values of t at which the ray leaves them.
struct Path {
    std::vector<std::uint32_t> voxels;
    std::vector<float> t_exits;
};

Path path_of(const Traversals& traversals, std::size_t ray, std::uint32_t max_count) {
    Path path;
    for (std::size_t i = ray * max_count; i < (ray + 1) * max_count && traversals.voxels[i] != RAYA_NO_VOXEL; ++i) {
        path.voxels.push_back(traversals.voxels[i]);
        path.t_exits.push_back(traversals.t_exits[i]);
    }
    return path;
}

/// Returns the maximum distance of a ray from the traversal's voxel: a quarter of the traversal error that
/// host/accel/partition.cpp allows.
double max_traversal_error(const raya_grid& grid, const reference::Ray& ray) {
    double box = 0, origin = 0;
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
        for (const std::uint32_t k : {0u, grid.divisions[axis]})
            box = std::max(box, std::abs(double{raya_voxel_plane(grid, axis, k)}));
        origin = std::max(origin, std::abs(ray.origin[static_cast<int>(axis)]));
    }
    return 4 * 0x1p-24 * (origin + box);
}

/// Returns true if each step leads to a neighbouring voxel in the direction of the ray and t never decreases.
bool steps_forward(const raya_grid& grid, const reference::Ray& ray, const Path& path) {
    for (std::size_t i = 1; i < path.voxels.size(); ++i) {
        const VoxelBlock previous = one_voxel(grid, path.voxels[i - 1]), current = one_voxel(grid, path.voxels[i]);
        int steps = 0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (current.first[axis] == previous.first[axis]) continue;
            const bool up = ray.direction[static_cast<int>(axis)] > 0;
            steps += current.first[axis] == previous.first[axis] + (up ? 1u : -1u) ? 1 : 4;
        }
        if (steps != 1 || path.t_exits[i] < path.t_exits[i - 1]) return false;
    }
    return true;
}

/// Returns true if the ray is within `error` of the traversal's current voxel at all t.
bool stays_near_ray(const raya_grid& grid, const reference::Ray& ray, const Path& path, double error) {
    const Passage box = passage(grid, all_voxels(grid), ray, -error);
    for (std::size_t i = 0; i < path.voxels.size(); ++i) {
        const Passage near = passage(grid, one_voxel(grid, path.voxels[i]), ray, error);
        const double t_entry = i == 0 ? near.in : std::max(box.in, double{path.t_exits[i - 1]}),
                     t_exit = path.t_exits[i];
        if (near.empty() || t_exit > near.out || (t_entry <= t_exit && t_entry < near.in)) return false;
    }
    return true;
}

/// Returns true if the path contains all voxels that the ray still crosses if their planes are moved inward by
/// `error`.
bool misses_none(const raya_grid& grid, const reference::Ray& ray, const Path& path, double error) {
    std::vector<std::uint32_t> crossed;
    add_crossed(grid, all_voxels(grid), ray, error, crossed);
    const std::set<std::uint32_t> visited(path.voxels.begin(), path.voxels.end());
    return std::all_of(crossed.begin(), crossed.end(), [&](std::uint32_t v) { return visited.count(v) == 1; });
}

/// Rule for a ray's entry into the grid. kMust: the ray certainly crosses the box before its limit. kMay: the ray comes
/// near the box before its limit. kMustNot: all other rays.
enum class Entry { kMust, kMay, kMustNot };

Entry required_entry(const raya_grid& grid, const reference::Ray& ray, double limit, double error) {
    const Passage near = passage(grid, all_voxels(grid), ray, error),
                  crossed = passage(grid, all_voxels(grid), ray, -error);
    if (near.empty() || near.in > limit) return Entry::kMustNot;
    return !crossed.empty() && crossed.in <= limit ? Entry::kMust : Entry::kMay;
}

double random_limit(SplitMix& random, const raya_grid& grid, const reference::Ray& ray) {
    const Passage box = passage(grid, all_voxels(grid), ray, 0);
    if (below(random, 4) != 0 || box.empty()) return kFarLimit;
    static constexpr std::array<double, 4> kFractions = {0.3, 0.99, 1.01, 1.5};
    return fp32(box.in * kFractions[below(random, kFractions.size())]);
}

/// A random grid, random rays, and the limits of the rays.
struct TraversalCase {
    explicit TraversalCase(std::uint64_t seed) {
        SplitMix random(seed);
        grid = random_grid(random);
        for (std::size_t i = 0; i < kTraversedRays; ++i) {
            rays.push_back(random_grid_ray(random, grid));
            limits.push_back(random_limit(random, grid, rays.back()));
        }
    }
    std::vector<float> words() const {
        std::vector<float> words = ray_words(rays);
        for (std::size_t i = 0; i < rays.size(); ++i) words[i * 7 + 6] = static_cast<float>(limits[i]);
        return words;
    }

    raya_grid grid{};
    std::vector<reference::Ray> rays;
    std::vector<double> limits;
};

void check_grid_traversal(const raya_grid& grid, const reference::Ray& ray, double limit, const Path& path) {
    const double error = max_traversal_error(grid, ray);
    const Entry expected = required_entry(grid, ray, limit, error);
    CAPTURE(ray.origin, ray.direction, limit, path.voxels, path.t_exits, error);
    if (expected == Entry::kMust) REQUIRE(!path.voxels.empty());
    if (expected == Entry::kMustNot) REQUIRE(path.voxels.empty());
    REQUIRE(steps_forward(grid, ray, path));
    REQUIRE(stays_near_ray(grid, ray, path, error));
    if (!path.voxels.empty()) REQUIRE(misses_none(grid, ray, path, error));
}

}  // namespace

TEST_CASE("a traversal visits the voxels that the ray crosses, in order") {
    KernelRunner runner("tests/accel/traversal_probe.cl", {1, true, {}});
    std::size_t visits = 0, empty = 0;
    for (std::size_t seed = 0; seed < kTraversedGrids; ++seed) {
        const TraversalCase c(seed);
        const Traversals traversals = traverse(runner, c.grid, c.words());
        CAPTURE(seed, c.grid.divisions, c.grid.low, c.grid.cell);
        for (std::size_t i = 0; i < kTraversedRays; ++i) {
            const Path path = path_of(traversals, i, max_voxels(c.grid));
            check_grid_traversal(c.grid, c.rays[i], c.limits[i], path);
            visits += path.voxels.size();
            empty += path.voxels.empty();
        }
    }
    CHECK(empty > kTraversedGrids * kTraversedRays / 10);
    CHECK(visits > kTraversedGrids * kTraversedRays * 10);
}

TEST_CASE("a traversal that is resumed in any of its voxels visits the same voxels as before") {
    KernelRunner runner("tests/accel/traversal_probe.cl", {16, true, {}});
    for (std::size_t seed = 0; seed < kTraversedGrids / 2; ++seed) {
        const TraversalCase c(seed);
        const Traversals traversals = traverse(runner, c.grid, c.words());
        CAPTURE(seed);
        REQUIRE(bits(traversals.resumed_t_exits) == bits(traversals.t_exits));
        std::vector<std::uint32_t> expected_next(traversals.voxels.size(), RAYA_NO_VOXEL);
        for (std::size_t i = 0; i + 1 < expected_next.size(); ++i)
            if (traversals.voxels[i] != RAYA_NO_VOXEL) expected_next[i] = traversals.voxels[i + 1];
        REQUIRE(traversals.next_voxels == expected_next);
    }
}

TEST_CASE("traversals have the same bits for all numbers of lanes") {
    std::vector<Traversals> first;
    for (const TestBuild& test_build : test_builds()) {
        CAPTURE(test_build.name());
        KernelRunner runner("tests/accel/traversal_probe.cl", test_build);
        constexpr std::size_t kFewGrids = 8;
        for (std::size_t seed = 0; seed < kFewGrids; ++seed) {
            const TraversalCase c(seed);
            const Traversals traversals = traverse(runner, c.grid, c.words());
            if (first.size() < kFewGrids) first.push_back(traversals);
            CAPTURE(seed);
            REQUIRE(traversals.voxels == first[seed].voxels);
            REQUIRE(bits(traversals.t_exits) == bits(first[seed].t_exits));
            REQUIRE(traversals.wide == first[seed].wide);
        }
    }
}

TEST_CASE("a ray is wide if it starts beyond the reach or its direction's length is too far from 1, and only then") {
    KernelRunner runner("tests/accel/traversal_probe.cl", {16, true, {}});
    constexpr float kAboveReach = 0x1.000002p3F, kLong = 1 + 0x1.8p-20F, kTooLong = 1 + 0x1.4p-19F,
                    kTooShort = 1 - 0x1.4p-19F;
    raya_grid grid{{-1, -1, -1}, {2, 2, 2}, {1, 1, 1}, 8};
    const std::vector<std::array<float, 6>> not_wide = {
        {0, 0, 0, 1, 0, 0}, {8, -8, 8, 0, 0.6F, 0.8F}, {0, 0, 0, 0, 0, kLong}};
    const std::vector<std::array<float, 6>> wide = {{kAboveReach, 0, 0, 1, 0, 0},
                                                    {0, -kAboveReach, 0, 1, 0, 0},
                                                    {0, 0, kAboveReach, 1, 0, 0},
                                                    {0, 0, 0, kTooLong, 0, 0},
                                                    {0, 0, 0, 0, 0, -kTooShort},
                                                    {0, 0, 0, 0, NAN, 1},
                                                    {0, 0, 0, 0, 0, 0}};
    std::vector<float> words;
    for (const auto* rays : {&not_wide, &wide})
        for (const auto& ray : *rays) {
            words.insert(words.end(), ray.begin(), ray.end());
            words.push_back(kFarLimit);
        }
    const std::size_t rays = words.size() / 7;
    words.resize(kMaxLanes * 7, 0);
    const std::vector<std::uint32_t> found = traverse(runner, grid, words).wide;
    for (std::size_t i = 0; i < rays; ++i) {
        CAPTURE(i);
        CHECK(found[i] == (i < not_wide.size() ? 0 : 1));
    }
}

// The kernels make primary and shadow rays with normalised directions. After several reflections a ray may be wide.
TEST_CASE("rays with normalised directions are never wide; rays reflected once are rarely wide") {
    const raya_grid grid{{-1, -1, -1}, {2, 2, 2}, {1, 1, 1}, 8};
    constexpr std::size_t kCount = 1 << 16;
    for (const char* format : {"fp32", "e6m15", "e6m15t", "e8m12", "e5m10t"}) {
        KernelRunner runner("tests/accel/traversal_probe.cl", {4, true, parse_format(format)});
        SplitMix random(1);
        std::vector<float> arms;
        for (std::size_t i = 0; i < kCount * 2; ++i) {
            const Vec3 arm = random.uniform(0.25, 4) * random_direction(random);
            for (int axis = 0; axis < 3; ++axis) arms.push_back(round_to_format(arm[axis], parse_format(format)));
        }
        const auto grid_buffer = runner.filled("grid", grid_words(grid));
        const auto arm_buffer = runner.filled("arms", arms);
        auto wide = runner.constant<std::uint32_t>("wide", kCount * 2, 0);
        runner.run_rows<const Buffer<std::uint32_t>&, const Buffer<float>&, Buffer<std::uint32_t>&>(
            "find_wide_rays", kCount, grid_buffer, arm_buffer, wide);
        const std::vector<std::uint32_t> found = runner.read(wide);
        std::array<std::size_t, 2> counts{};
        for (std::size_t i = 0; i < found.size(); ++i) counts[i % 2] += found[i];
        CAPTURE(format);
        CHECK(counts[0] == 0);
        CHECK(counts[1] < kCount / 1000);
    }
}

}  // namespace raya
