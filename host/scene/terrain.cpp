// The height field `terrain`, as a scene, as NFF and as PLY.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <utility>
#include <vector>

#include "host/error.hpp"
#include "host/scene/generate.hpp"
#include "host/scene/nff.hpp"
#include "host/scene/split_mix.hpp"

namespace raya {
namespace {

constexpr int kHeightSteps = 64;  // heights are multiples of 1 / kHeightSteps

/// One octave of value noise: random values at the points of a lattice, interpolated by the cubic 3 t^2 - 2 t^3 along
/// each axis. All arithmetic is in integers, so that heights are equal on all machines.
class Octave {
  public:
    Octave(std::int64_t spacing, int side, std::uint64_t seed)
        : spacing_(spacing), seed_(seed), values_(static_cast<std::size_t>(side / spacing) + 2) {
        const std::int64_t cube = spacing * spacing * spacing;
        for (std::int64_t t = 0; t < spacing; ++t) weights_.push_back(kOne * t * t * (3 * spacing - 2 * t) / cube);
    }

    /// Adds the octave's values at the points of a row, which are proportional to the spacing.
    void add_row(std::int64_t row, std::vector<std::int64_t>& sums) {
        const std::int64_t lattice_row = row / spacing_, weight = weights_[static_cast<std::size_t>(row % spacing_)];
        for (std::size_t i = 0; i < values_.size(); ++i)
            values_[i] = mixed(random(i, lattice_row), random(i, lattice_row + 1), weight);
        for (std::size_t x = 0; x < sums.size(); ++x) {
            const std::size_t i = x / static_cast<std::size_t>(spacing_), t = x % static_cast<std::size_t>(spacing_);
            sums[x] += spacing_ * mixed(values_[i], values_[i + 1], weights_[t]);
        }
    }

  private:
    static constexpr std::int64_t kOne = 1 << 16;  // a weight of 1

    static std::int64_t mixed(std::int64_t first, std::int64_t second, std::int64_t weight) {
        return first + ((second - first) * weight >> 16);
    }

    /// Returns the random value of a lattice point, -2^15..2^15 - 1.
    std::int64_t random(std::size_t column, std::int64_t row) const {
        const auto place = static_cast<std::uint64_t>(row) << 32 | column;
        return static_cast<std::int64_t>(SplitMix(SplitMix(seed_ ^ place).next() + seed_).next() >> 48) - (1 << 15);
    }

    std::int64_t spacing_;
    std::uint64_t seed_;
    std::vector<std::int64_t> weights_;  // [offset from a lattice point]
    std::vector<std::int64_t> values_;   // of the lattice columns, interpolated in the current row
};

/// The points of the height field: a square lattice with spacing 1 of which row and column start at 0.
class Heights {
  public:
    Heights(int triangles, std::uint64_t seed) : triangles_(triangles) {
        if (triangles < 1 || triangles > kMaxObjects)
            throw UserError(fmt::format("terrain: {} triangles: must be 1..{}", triangles, kMaxObjects));
        while (2 * side_ * side_ < triangles) ++side_;
        std::uint64_t octave_seed = seed;
        for (int spacing = 4; spacing <= std::max(4, static_cast<int>(side_) / 2); spacing *= 2)
            octaves_.emplace_back(spacing, side(), octave_seed = SplitMix(octave_seed).next());
    }

    int triangles() const { return static_cast<int>(triangles_); }
    int side() const { return static_cast<int>(side_); }                                       // cells of a row
    int rows() const { return static_cast<int>((triangles_ + 2 * side_ - 1) / (2 * side_)); }  // rows of cells

    /// Returns the heights of the points of a row, in multiples of 1 / kHeightSteps.
    std::vector<std::int64_t> row(int row) {
        std::vector<std::int64_t> sums(static_cast<std::size_t>(side_) + 1, 0);
        for (Octave& octave : octaves_) octave.add_row(row, sums);
        for (std::int64_t& sum : sums) sum >>= 12;  // each octave then reaches up to 1/8 of its spacing
        return sums;
    }

    /// Returns the number of triangles in a row of cells.
    int triangles_of_row(int row) const { return static_cast<int>(std::min(2 * side_, triangles_ - row * 2 * side_)); }

  private:
    std::int64_t triangles_, side_ = 1;
    std::vector<Octave> octaves_;
};

/// A corner of a triangle: its column, and its row relative to the row of cells.
struct TerrainCorner {
    std::size_t column, row;
};

/// Returns the corners of a triangle of a row of cells. Each cell consists of two triangles, counter-clockwise seen
/// from above.
std::array<TerrainCorner, 3> corners_of(int triangle) {
    const auto cell = static_cast<std::size_t>(triangle / 2);
    if (triangle % 2 == 0) return {{{cell, 0}, {cell + 1, 0}, {cell + 1, 1}}};
    return {{{cell, 0}, {cell + 1, 1}, {cell, 1}}};
}

Scene empty_scene(const Heights& heights, std::uint64_t seed) {
    const double side = heights.side();
    Scene scene;
    scene.name = fmt::format("terrain{}_{}.nff", heights.triangles(), seed);
    scene.background = {0.5, 0.7, 0.9};
    scene.view = {{0.5 * side, -0.5 * side, 0.625 * side}, {0.5 * side, 0.375 * side, 0}, {0, 0, 1}, 45, 0, 512, 512};
    scene.lights = {{{-side, -side, 2 * side}, {}}};
    scene.surfaces = {{{0.6, 0.55, 0.4}, 1, 0, 0, 0, 1, {}}};
    return scene;
}

/// Points of the rows below and above a row of cells.
template <class Point>
struct PointRows {
    std::vector<Point> rows[2];
    const Point& at(const TerrainCorner& corner) const { return rows[corner.row][corner.column]; }
};

/// Returns the points of a row: make(x, y, z) for each.
template <class Make>
auto points_of_row(Heights& heights, int row, const Make& make) {
    std::vector<decltype(make(0, 0, 0.0))> points;
    int x = 0;
    for (const std::int64_t height : heights.row(row))
        points.push_back(make(x++, row, static_cast<double>(height) / kHeightSteps));
    return points;
}

/// Calls visit(corner, corner, corner) for each triangle of a row of cells, with the points that make(x, y, z) returns.
template <class Point, class Make, class Visit>
void visit_row(Heights& heights, int row, PointRows<Point>& points, const Make& make, const Visit& visit) {
    points.rows[0] = row == 0 ? points_of_row(heights, 0, make) : std::move(points.rows[1]);
    points.rows[1] = points_of_row(heights, row + 1, make);
    for (int i = 0; i < heights.triangles_of_row(row); ++i) {
        const std::array<TerrainCorner, 3> corners = corners_of(i);
        visit(points.at(corners[0]), points.at(corners[1]), points.at(corners[2]));
    }
}

void put_word(std::string& bytes, std::uint32_t word) {
    for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(word >> shift);
}

std::string ply_header(const Heights& heights) {
    const std::int64_t points = (std::int64_t{heights.side()} + 1) * (heights.rows() + 1);
    return fmt::format(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float "
        "z\n"
        "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        points, heights.triangles());
}

}  // namespace

Scene generate_terrain(int triangles, std::uint64_t seed) {
    Heights heights(triangles, seed);
    Scene scene = empty_scene(heights, seed);
    PointRows<Vec3> points;
    const auto make = [](int x, int y, double z) { return Vec3(x, y, z); };
    for (int row = 0; row < heights.rows(); ++row)
        visit_row(heights, row, points, make, [&](const Vec3& a, const Vec3& b, const Vec3& c) {
            scene.polygons.push_back({{a, b, c}, {}, 0});
        });
    return scene;
}

std::function<std::string_view()> terrain_nff(int triangles, std::uint64_t seed) {
    Heights heights(triangles, seed);
    // The head of the file, with the surface before the first triangle.
    Scene first = empty_scene(heights, seed);
    first.polygons = generate_terrain(1, 0).polygons;
    std::string head = write_nff(first);
    head.resize(head.rfind("p 3\n"));
    return
        [heights = std::move(heights), text = std::move(head), points = PointRows<std::string>{}, row = -1]() mutable {
            if (row++ == -1) return std::string_view(text);
            text.clear();
            if (row > heights.rows()) return std::string_view();
            visit_row(
                heights, row - 1, points, [](int x, int y, double z) { return fmt::format("{} {} {}\n", x, y, z); },
                [&](const std::string& a, const std::string& b, const std::string& c) {
                    text.append("p 3\n").append(a).append(b).append(c);
                });
            return std::string_view(text);
        };
}

std::function<std::string_view()> terrain_ply(int triangles, std::uint64_t seed) {
    Heights heights(triangles, seed);
    std::string header = ply_header(heights);
    return [heights = std::move(heights), bytes = std::move(header), piece = -1]() mutable {
        const int points_rows = heights.rows() + 1, columns = heights.side() + 1;
        if (piece++ == -1) return std::string_view(bytes);
        bytes.clear();
        if (piece <= points_rows) {
            points_of_row(heights, piece - 1, [&](int x, int y, double z) {
                for (const double value : {double(x), double(y), z})
                    put_word(bytes, std::bit_cast<std::uint32_t>(static_cast<float>(value)));
                return 0;
            });
        } else if (const int row = piece - 1 - points_rows; row < heights.rows()) {
            for (int i = 0; i < heights.triangles_of_row(row); ++i) {
                bytes += '\3';
                for (const TerrainCorner& corner : corners_of(i))
                    put_word(bytes, static_cast<std::uint32_t>((static_cast<std::size_t>(row) + corner.row) * columns +
                                                               corner.column));
            }
        }
        return std::string_view(bytes);
    };
}

}  // namespace raya
