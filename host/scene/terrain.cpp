// The height field `terrain`, as a scene and as PLY.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <utility>
#include <vector>

#include "host/error.hpp"
#include "host/scene/generate.hpp"
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

    /// Returns the heights of the points of a row.
    std::vector<double> row(int row) {
        std::vector<std::int64_t> sums(static_cast<std::size_t>(side_) + 1, 0);
        for (Octave& octave : octaves_) octave.add_row(row, sums);
        std::vector<double> heights;
        for (const std::int64_t sum : sums)  // each octave reaches up to 1/8 of its spacing
            heights.push_back(static_cast<double>(sum >> 12) / kHeightSteps);
        return heights;
    }

    /// Returns the number of triangles in a row of cells.
    int triangles_of_row(int row) const { return static_cast<int>(std::min(2 * side_, triangles_ - row * 2 * side_)); }

  private:
    std::int64_t triangles_, side_ = 1;
    std::vector<Octave> octaves_;
};

/// Returns the corners of a triangle of a row of cells: the column, and the row relative to that of the cells. Each
/// cell consists of two triangles, counter-clockwise seen from above.
std::array<std::array<std::size_t, 2>, 3> corners_of(int triangle) {
    const auto cell = static_cast<std::size_t>(triangle / 2);
    if (triangle % 2 == 0) return {{{cell, 0}, {cell + 1, 0}, {cell + 1, 1}}};
    return {{{cell, 0}, {cell + 1, 1}, {cell, 1}}};
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
    const double side = heights.side();
    Scene scene;
    scene.name = fmt::format("terrain{}_{}.nff", triangles, seed);
    scene.background = {0.5, 0.7, 0.9};
    scene.view = {{0.5 * side, -0.5 * side, 0.625 * side}, {0.5 * side, 0.375 * side, 0}, {0, 0, 1}, 45, 0, 512, 512};
    scene.lights = {{{-side, -side, 2 * side}, {}}};
    scene.surfaces = {{{0.6, 0.55, 0.4}, 1, 0, 0, 0, 1, {}}};
    scene.polygons.reserve(static_cast<std::size_t>(triangles));
    std::array<std::vector<double>, 2> rows = {heights.row(0), {}};
    for (int row = 0; row < heights.rows(); ++row, std::swap(rows[0], rows[1])) {
        rows[1] = heights.row(row + 1);
        for (int i = 0; i < heights.triangles_of_row(row); ++i) {
            Polygon& triangle = scene.polygons.emplace_back();
            for (const auto& [x, y] : corners_of(i))
                triangle.vertices.emplace_back(static_cast<double>(x), row + static_cast<double>(y), rows[y][x]);
        }
    }
    return scene;
}

std::function<std::string_view()> terrain_ply(int triangles, std::uint64_t seed) {
    Heights heights(triangles, seed);
    std::string header = ply_header(heights);
    return [heights = std::move(heights), bytes = std::move(header), piece = -1]() mutable {
        const int points_rows = heights.rows() + 1, columns = heights.side() + 1;
        if (piece++ == -1) return std::string_view(bytes);
        bytes.clear();
        if (piece <= points_rows) {
            double x = 0;
            for (const double height : heights.row(piece - 1))
                for (const double value : {x++, piece - 1.0, height})
                    put_word(bytes, std::bit_cast<std::uint32_t>(static_cast<float>(value)));
        } else if (const int row = piece - 1 - points_rows; row < heights.rows()) {
            for (int i = 0; i < heights.triangles_of_row(row); ++i) {
                bytes += '\3';
                for (const auto& [x, y] : corners_of(i))
                    put_word(bytes, static_cast<std::uint32_t>((static_cast<std::size_t>(row) + y) * columns + x));
            }
        }
        return std::string_view(bytes);
    };
}

}  // namespace raya
