// A node's pixel window contains all pixels whose rays enter the box at the node's voxels, and few other pixels.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <vector>

#include "host/torus/torus_plan.hpp"
#include "tests/torus/random_nodes.hpp"

namespace raya {
namespace {

struct Camera {
    raya_job job;
    NumberFormat format;
};

double rounded(double value, const NumberFormat& format) {
    return format.is_fp32() ? static_cast<double>(static_cast<float>(value)) : round_to_format(value, format);
}

Vec3 vector_of(const float (&v)[3]) { return {v[0], v[1], v[2]}; }

// Returns the direction of the ray through an image point. Each operation is rounded to the format, as in the kernels
// (geometry/ray.clh).
Vec3 direction_of(const Camera& c, double row, double column) {
    const auto round = [&](double value) { return rounded(value, c.format); };
    Vec3 d;
    for (int axis = 0; axis < 3; ++axis)
        d[axis] = round(c.job.column_step[axis] * column + round(c.job.row_step[axis] * row + c.job.corner[axis]));
    const double square = round(d.z * d.z + round(d.y * d.y + round(d.x * d.x)));
    const double inverse = round(1 / round(std::sqrt(square)));
    return {round(d.x * inverse), round(d.y * inverse), round(d.z * inverse)};
}

constexpr double kNoEntry = std::numeric_limits<double>::infinity();

// Returns the distance, in double precision, at which a ray enters the box that the voxels `first` to `last` fill;
// kNoEntry if the ray misses this box.
double entry_distance(const raya_grid& grid, const raya_place& first, const raya_place& last, const Vec3& origin,
                      const Vec3& direction) {
    double in = 0, out = kNoEntry;
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
        const double o = origin[static_cast<int>(axis)], d = direction[static_cast<int>(axis)];
        const double low = raya_voxel_plane(grid, axis, first.at[axis]) - o;
        const double high = raya_voxel_plane(grid, axis, last.at[axis] + 1) - o;
        if (d == 0 && (low > 0 || high < 0)) return kNoEntry;
        if (d == 0) continue;
        in = std::max(in, std::min(low / d, high / d));
        out = std::min(out, std::max(low / d, high / d));
    }
    return in <= out ? in : kNoEntry;
}

// Returns true if a ray enters the grid's box at voxel `at`.
bool enters(const raya_grid& grid, const raya_place& at, const Vec3& origin, const Vec3& direction) {
    const raya_place last{{grid.divisions[0] - 1, grid.divisions[1] - 1, grid.divisions[2] - 1}};
    const double box_entry = entry_distance(grid, {{0, 0, 0}}, last, origin, direction);
    return box_entry < kNoEntry && entry_distance(grid, at, at, origin, direction) <= box_entry * (1 + 1e-12);
}

// The range ([0]: rows, [1]: columns) of the image points whose rays enter the box at a node's voxels.
struct EntryBounds {
    double low[2] = {1e9, 1e9}, high[2] = {-1e9, -1e9};
    bool is_nonempty() const { return low[0] <= high[0]; }
};

// Finds EntryBounds from `rays_per_side` x `rays_per_side` rays per pixel.
EntryBounds entry_bounds(const Camera& c, const raya_grid& grid, const raya_torus& torus, std::uint32_t node,
                         int rays_per_side) {
    EntryBounds bounds;
    const Vec3 eye = vector_of(c.job.eye);
    const int rows = static_cast<int>(c.job.mapping.height), columns = static_cast<int>(c.job.mapping.width);
    for (int row = 0; row < rows * rays_per_side; ++row)
        for (int column = 0; column < columns * rays_per_side; ++column) {
            const double place[2] = {static_cast<double>(row) / rays_per_side,
                                     static_cast<double>(column) / rays_per_side};
            const Vec3 d = direction_of(c, place[0], place[1]);
            bool enters_box = false;
            for (std::uint32_t i = 0; i < raya_node_voxels(torus, grid, node) && !enters_box; ++i) {
                const std::uint32_t voxel = raya_voxel_of_node(torus, grid, node, i);
                enters_box = enters(grid, raya_place_of(voxel, grid.divisions[0], grid.divisions[1]), eye, d);
            }
            for (int i = 0; i < 2 && enters_box; ++i) {
                bounds.low[i] = std::min(bounds.low[i], place[i]);
                bounds.high[i] = std::max(bounds.high[i], place[i]);
            }
        }
    return bounds;
}

raya_grid random_grid(SplitMix& random, const Divisions& divisions) {
    raya_grid grid{};
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
        grid.low[axis] = static_cast<float>(random.uniform(-3, 1));
        grid.cell[axis] = static_cast<float>(random.uniform(0.2, 4) / divisions[axis]);
        grid.divisions[axis] = divisions[axis];
    }
    return grid;
}

Vec3 middle_of(const raya_grid& grid) {
    Vec3 middle;
    for (int axis = 0; axis < 3; ++axis) middle[axis] = grid.low[axis] + 0.5 * grid.cell[axis] * grid.divisions[axis];
    return middle;
}

// Returns a random camera whose eye is at `distance` from the middle of the box. If the distance is short, the eye is
// in the box. `angle`: field of view in degrees.
Camera random_camera(SplitMix& random, const raya_grid& grid, const NumberFormat& format, double distance,
                     double angle) {
    Scene scene = empty_scene();
    scene.view.from = middle_of(grid) + distance * random_direction(random);
    scene.view.at = middle_of(grid) + random_point(random, 0.4);
    scene.view.up = random_direction(random);
    scene.view.angle_degrees = angle;
    JobSettings settings;
    settings.image = {1 + random_below(random, 40), 1 + random_below(random, 30)};
    settings.sampling = random.next() % 2 ? Sampling::kCentres : Sampling::kCorners;
    settings.format = format;
    return {pack_job(scene, settings).header(), format};
}

}  // namespace

TEST_CASE("a node's window holds every pixel whose ray enters the box at its voxels", "[torus]") {
    const std::uint64_t seed = 9183;
    SplitMix random(seed);
    std::size_t entered_nodes = 0, partial_windows = 0;
    for (int i = 0; i < 800; ++i) {
        const NumberFormat format = parse_format(std::array{"fp32", "spa22", "e8m12t", "e5m10", "e5m6"}[i % 5u]);
        const raya_torus torus = random_torus(random, 3);
        const raya_grid grid = random_grid(
            random, {1 + random_below(random, 5), 1 + random_below(random, 5), 1 + random_below(random, 5)});
        const double distance = std::array{0.0, 0.3, 2.0, 8.0, 30.0, 300.0, 3000.0, 10000.0}[random_below(random, 8)];
        // If the eye is far away, the pixel spacing is as small as the last bits of a direction.
        const double angle = distance < 50 ? random.uniform(10, 150) : random.uniform(50, 300) / distance;
        const Camera camera = random_camera(random, grid, format, distance, angle);
        const auto windows = pixel_windows(camera.job, grid, torus, format);
        REQUIRE(windows.size() == raya_nodes(torus));
        for (std::uint32_t node = 0; node < windows.size(); ++node) {
            const PixelWindow& w = windows[node];
            CAPTURE(seed, i, torus_text(torus), node, distance, w.rows[0], w.rows[1], w.columns[0], w.columns[1]);
            const bool empty = w.rows[0] >= w.rows[1] || w.columns[0] >= w.columns[1];
            CHECK((raya_node_voxels(torus, grid, node) > 0 || empty));
            CHECK(w.rows[1] <= camera.job.mapping.height);
            CHECK(w.columns[1] <= camera.job.mapping.width);
            const EntryBounds bounds = entry_bounds(camera, grid, torus, node, 1);
            if (!bounds.is_nonempty()) continue;
            ++entered_nodes;
            partial_windows += w.rows[1] - w.rows[0] < camera.job.mapping.height;
            CHECK(bounds.low[0] >= w.rows[0]);
            CHECK(bounds.high[0] < w.rows[1]);
            CHECK(bounds.low[1] >= w.columns[0]);
            CHECK(bounds.high[1] < w.columns[1]);
        }
    }
    CHECK(entered_nodes > 1000);
    CHECK(partial_windows > 200);
}

TEST_CASE("a window exceeds the projection of the node's outer faces by at most five pixels", "[torus]") {
    const std::uint64_t seed = 77;
    SplitMix random(seed);
    const raya_torus torus = make_torus({3, 3, 3}, Links::kTorus3d);
    int unclipped = 0;
    for (int i = 0; i < 40; ++i) {
        const raya_grid grid = random_grid(random, {3, 3, 3});
        Camera camera = random_camera(random, grid, parse_format("fp32"), 12, random.uniform(20, 60));
        const auto windows = pixel_windows(camera.job, grid, torus, camera.format);
        for (std::uint32_t node = 0; node < windows.size(); ++node) {
            const PixelWindow& w = windows[node];
            const EntryBounds bounds = entry_bounds(camera, grid, torus, node, 4);
            CAPTURE(seed, i, node, w.rows[0], w.rows[1], w.columns[0], w.columns[1], bounds.low[0], bounds.high[0],
                    bounds.low[1], bounds.high[1]);
            // If the image's edge clips the projection, the window may exceed the bounds by more than five pixels.
            const bool clipped = bounds.low[0] <= 0 || bounds.low[1] <= 0 ||
                                 bounds.high[0] > camera.job.mapping.height - 1.5 ||
                                 bounds.high[1] > camera.job.mapping.width - 1.5;
            if (!bounds.is_nonempty() || clipped) continue;
            ++unclipped;
            CHECK(w.rows[0] + 4 >= bounds.low[0]);
            CHECK(w.rows[1] <= bounds.high[0] + 5);
            CHECK(w.columns[0] + 4 >= bounds.low[1]);
            CHECK(w.columns[1] <= bounds.high[1] + 5);
        }
    }
    CHECK(unclipped > 100);
}

}  // namespace raya
