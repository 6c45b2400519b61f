// Compares the traversal by stepper.clh with that by traversal.clh: both visit the same voxels and leave them at the
// same t, bit for bit, until the ray leaves the box.
#include <catch2/catch.hpp>

#include "host/scene/packer.hpp"
#include "tests/accel/random_grids.hpp"
#include "tests/kernels/kernel_runner.hpp"
#include "tests/kernels/probe.hpp"

namespace raya {
namespace {

constexpr std::size_t kGrids = 40, kRays = 1024;  // kRays: number of rays per grid

struct SteppedVoxels {
    std::vector<std::uint32_t> voxels;  // [ray][max_count]: voxel numbers, RAYA_NO_VOXEL after the last
    std::vector<float> t_exits;         // [ray][max_count]: t at which the ray leaves each voxel
};

SteppedVoxels plain_traversal(KernelRunner& runner, const raya_grid& grid, const std::vector<float>& rays) {
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
    return {runner.read(voxels), runner.read(t_exits)};
}

SteppedVoxels stepped_traversal(KernelRunner& runner, const raya_grid& grid, const std::vector<float>& rays) {
    const std::size_t count = rays.size() / 7;
    const std::uint32_t max_count = max_voxels(grid);
    const auto grid_buffer = runner.filled("grid", grid_words(grid));
    const auto ray_buffer = runner.filled("rays", rays);
    auto voxels = runner.constant<std::uint32_t>("voxels", count * max_count, RAYA_NO_VOXEL);
    auto t_exits = runner.constant<float>("t_exits", count * max_count, 0);
    runner
        .run_rows<const Buffer<std::uint32_t>&, const Buffer<float>&, cl_uint, Buffer<std::uint32_t>&, Buffer<float>&>(
            "stepped_traversal", count, grid_buffer, ray_buffer, max_count, voxels, t_exits);
    return {runner.read(voxels), runner.read(t_exits)};
}

/// Returns the number of voxels that stepper.clh must visit, given the voxels that traversal.clh visits. stepper.clh
/// skips the last voxels if the ray's path through them has length 0, for example if the ray leaves the box through an
/// edge.
std::size_t voxels_until_end(const SteppedVoxels& plain, std::size_t ray, std::uint32_t max_count) {
    std::size_t count = 0;
    while (count < max_count && plain.voxels[ray * max_count + count] != RAYA_NO_VOXEL) ++count;
    while (count > 1 && plain.t_exits[ray * max_count + count - 2] == plain.t_exits[ray * max_count + count - 1])
        --count;
    return count;
}

}  // namespace

TEST_CASE("for every number of lanes, the stepper visits the voxels of the plain traversal at the same t") {
    std::size_t steps = 0;
    for (const std::uint32_t lanes : {1u, 4u, 8u, 16u}) {
        KernelRunner plain("tests/accel/traversal_probe.cl", {lanes, true}),
            stepped("tests/accel/stepper_probe.cl", {lanes, true});
        for (std::uint64_t seed = 0; seed < kGrids; ++seed) {
            SplitMix random(seed);
            const raya_grid grid = random_grid(random);
            std::vector<reference::Ray> rays;
            for (std::size_t i = 0; i < kRays; ++i) rays.push_back(random_grid_ray(random, grid));
            const std::vector<float> words = ray_words(rays);
            const SteppedVoxels expected = plain_traversal(plain, grid, words),
                                found = stepped_traversal(stepped, grid, words);
            const std::uint32_t max_count = max_voxels(grid);
            for (std::size_t ray = 0; ray < kRays; ++ray) {
                const std::size_t end = voxels_until_end(expected, ray, max_count);
                CAPTURE(lanes, seed, ray, end);
                std::size_t i = ray * max_count;
                for (; i < ray * max_count + end; ++i) {
                    if (found.voxels[i] != expected.voxels[i]) FAIL("the stepper visits a different voxel");
                    if (bits({found.t_exits[i]}) != bits({expected.t_exits[i]}))
                        FAIL("the stepper leaves the voxel at a different t");
                }
                if (i < (ray + 1) * max_count) REQUIRE(found.voxels[i] == RAYA_NO_VOXEL);
                steps += end;
            }
        }
    }
    CHECK(steps > 4 * kGrids * kRays);
}

}  // namespace raya
