// A node's pixel window contains all pixels whose rays enter the box at the node's voxels, and few other pixels.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "host/torus/torus_plan.hpp"
#include "tests/kernels/random_scene.hpp"
#include "tests/torus/random_torus.hpp"

namespace raya {
namespace {

Vec3 vector_of(const float (&v)[3]) { return {v[0], v[1], v[2]}; }

// Returns the direction of a pixel's ray. Each operation is rounded to the format, as in the kernels
// (geometry/ray.clh).
Vec3 direction_of(const raya_job& job, const NumberFormat& format, double row, double column) {
    const auto round = [&](double value) {
        return format.is_fp32() ? static_cast<double>(static_cast<float>(value)) : round_to_format(value, format);
    };
    Vec3 d;
    for (int axis = 0; axis < 3; ++axis)
        d[axis] = round(job.column_step[axis] * column + round(job.row_step[axis] * row + job.corner[axis]));
    const double square = round(d.z * d.z + round(d.y * d.y + round(d.x * d.x)));
    const double inverse = round(1 / round(std::sqrt(square)));
    return {round(d.x * inverse), round(d.y * inverse), round(d.z * inverse)};
}

// Returns the voxel, in double precision, in which a ray enters the grid's box; empty if the ray misses the box.
std::optional<raya_place> entry_voxel(const raya_grid& grid, const Vec3& eye, const Vec3& direction) {
    double in = 0, out = 1e300;
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
        const double low = raya_voxel_plane(grid, axis, 0) - eye[static_cast<int>(axis)],
                     high = raya_voxel_plane(grid, axis, grid.divisions[axis]) - eye[static_cast<int>(axis)],
                     d = direction[static_cast<int>(axis)];
        if (d == 0 && (low > 0 || high < 0)) return {};
        if (d == 0) continue;
        in = std::max(in, std::min(low / d, high / d));
        out = std::min(out, std::max(low / d, high / d));
    }
    if (in > out) return {};
    raya_place place{};
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
        const double at = eye[static_cast<int>(axis)] + in * direction[static_cast<int>(axis)];
        while (place.at[axis] + 1 < grid.divisions[axis] && at >= raya_voxel_plane(grid, axis, place.at[axis] + 1))
            ++place.at[axis];
    }
    return place;
}

raya_grid random_grid(SplitMix& random) {
    raya_grid grid{};
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
        grid.divisions[axis] = 1 + random_below(random, 5);
        grid.low[axis] = static_cast<float>(random.uniform(-3, 1));
        grid.cell[axis] = static_cast<float>(random.uniform(0.2, 4) / grid.divisions[axis]);
    }
    return grid;
}

// Returns the job of a random camera whose eye is at `distance` from the middle of the box. If the distance is short,
// the eye is in the box.
raya_job random_camera(SplitMix& random, const raya_grid& grid, const NumberFormat& format, double distance) {
    Vec3 middle;
    for (int axis = 0; axis < 3; ++axis) middle[axis] = grid.low[axis] + 0.5 * grid.cell[axis] * grid.divisions[axis];
    Scene scene = empty_scene();
    scene.view.from = middle + distance * random_direction(random);
    scene.view.at = middle + random_point(random, 0.4);
    scene.view.up = random_direction(random);
    // If the eye is far away, the pixel spacing is as small as the last bits of a direction.
    scene.view.angle_degrees = distance < 50 ? random.uniform(10, 150) : random.uniform(50, 300) / distance;
    JobSettings settings;
    settings.image = {1 + random_below(random, 40), 1 + random_below(random, 30)};
    settings.sampling = random.next() % 2 ? Sampling::kCentres : Sampling::kCorners;
    settings.format = format;
    return pack_job(scene, settings).header();
}

}  // namespace

TEST_CASE("a node's window holds the pixels whose rays enter the box at its voxels, and few others", "[torus]") {
    const std::uint64_t seed = 9183;
    SplitMix random(seed);
    std::size_t entering = 0, in_windows = 0, in_margins = 0;
    for (int i = 0; i < 800; ++i) {
        const NumberFormat format = parse_format(std::array{"fp32", "spa22", "e8m12t", "e5m10", "e5m6"}[i % 5u]);
        const raya_torus torus = random_torus(random, 3);
        const raya_grid grid = random_grid(random);
        const double distance = std::array{0.0, 0.3, 2.0, 8.0, 30.0, 300.0, 3000.0, 10000.0}[random_below(random, 8)];
        const raya_job job = random_camera(random, grid, format, distance);
        const auto windows = pixel_windows(job, grid, torus, format);
        REQUIRE(windows.size() == raya_nodes(torus));
        CAPTURE(seed, i, torus_text(torus), distance);
        std::size_t missing = 0;
        std::vector<std::size_t> pixels(windows.size());  // [node]: number of pixels whose rays enter at its voxels
        for (std::uint32_t row = 0; row < job.mapping.height; ++row)
            for (std::uint32_t column = 0; column < job.mapping.width; ++column) {
                const auto place = entry_voxel(grid, vector_of(job.eye), direction_of(job, format, row, column));
                if (!place) continue;
                const std::uint32_t voxel = raya_voxel(grid, place->at[0], place->at[1], place->at[2]),
                                    node = raya_node_of_voxel(torus, grid, voxel);
                const PixelWindow& w = windows[node];
                missing += row < w.rows[0] || row >= w.rows[1] || column < w.columns[0] || column >= w.columns[1];
                ++pixels[node];
            }
        CHECK(missing == 0);
        for (std::size_t node = 0; node < windows.size(); ++node) {
            const PixelWindow& w = windows[node];
            const std::uint32_t rows = w.rows[1] - w.rows[0], columns = w.columns[1] - w.columns[0];
            CHECK((w.rows[1] <= job.mapping.height && w.columns[1] <= job.mapping.width));
            entering += pixels[node];
            if (!format.is_fp32() || distance < 5 || distance > 50 || pixels[node] == 0) continue;
            in_windows += rows * columns;
            in_margins += pixels[node] + 10 * (rows + columns);  // five pixels on each side
        }
    }
    CHECK(entering > 10'000);
    CHECK(in_windows > 1000);
    CHECK(in_windows < in_margins);
}

}  // namespace raya
