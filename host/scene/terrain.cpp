// The height field `terrain`.
#include <fmt/core.h>

#include <algorithm>
#include <array>
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

/// Returns the corners of a triangle of a row of cells: the column, and the row relative to that of the cells. Each
/// cell consists of two triangles, counter-clockwise seen from above.
std::array<std::array<std::size_t, 2>, 3> corners_of(std::size_t triangle) {
    const std::size_t cell = triangle / 2;
    if (triangle % 2 == 0) return {{{cell, 0}, {cell + 1, 0}, {cell + 1, 1}}};
    return {{{cell, 0}, {cell + 1, 1}, {cell, 1}}};
}

}  // namespace

Scene generate_terrain(int triangles, std::uint64_t seed) {
    if (triangles < 1 || triangles > kMaxObjects)
        throw UserError(fmt::format("terrain: {} triangles: must be 1..{}", triangles, kMaxObjects));
    const auto count = static_cast<std::size_t>(triangles);
    std::size_t cells = 1;  // of a row
    while (2 * cells * cells < count) ++cells;
    std::vector<Octave> octaves;
    std::uint64_t octave_seed = seed;
    for (int spacing = 4; spacing <= std::max(4, static_cast<int>(cells) / 2); spacing *= 2)
        octaves.emplace_back(spacing, static_cast<int>(cells), octave_seed = SplitMix(octave_seed).next());
    const auto heights_of = [&](std::size_t row) {
        std::vector<std::int64_t> sums(cells + 1);
        for (Octave& octave : octaves) octave.add_row(static_cast<std::int64_t>(row), sums);
        std::vector<double> heights;
        for (const std::int64_t sum : sums)  // each octave reaches up to 1/8 of its spacing
            heights.push_back(static_cast<double>(sum >> 12) / kHeightSteps);
        return heights;
    };
    const auto side = static_cast<double>(cells);
    Scene scene;
    scene.name = fmt::format("terrain{}_{}.nff", triangles, seed);
    scene.background = {0.5, 0.7, 0.9};
    scene.view = {{0.5 * side, -0.5 * side, 0.625 * side}, {0.5 * side, 0.375 * side, 0}, {0, 0, 1}, 45, 0, 512, 512};
    scene.lights = {{{-side, -side, 2 * side}, {}}};
    scene.surfaces = {{{0.6, 0.55, 0.4}, 1, 0, 0, 0, 1, {}}};
    scene.polygons.reserve(count);
    std::array<std::vector<double>, 2> rows;  // below and above a row of cells
    rows[1] = heights_of(0);
    for (std::size_t row = 0; scene.polygons.size() < count; ++row) {
        rows[0] = std::exchange(rows[1], heights_of(row + 1));
        for (std::size_t i = 0; i < 2 * cells && scene.polygons.size() < count; ++i) {
            Polygon& triangle = scene.polygons.emplace_back();
            for (const auto& [x, y] : corners_of(i))
                triangle.vertices.emplace_back(static_cast<double>(x), static_cast<double>(row + y), rows[y][x]);
        }
    }
    return scene;
}

}  // namespace raya
