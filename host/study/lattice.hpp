// The pixels of one PE as a lattice, and whether a good lattice is a good offset.
//
// Where there is a PE for each of N columns, the PE of pixel (j, x) also has (j + a, x + b) wherever b = a p mod N: a
// lattice. Its shortest vector is the least distance between two pixels of one PE. Distances are those in the image,
// without wrapping round its sides; on the torus of N x N pixels they would be the same, since the lattice has the
// period N both ways and every vector shorter than N joins two pixels of some PE.
#pragma once
#include <cstdint>
#include <vector>

namespace raya {

/// From one pixel of a PE to another: so many rows down, so many columns to the right, or to the left where negative.
struct LatticeVector {
    std::int64_t rows = 0, columns = 0;
    std::uint64_t square() const { return static_cast<std::uint64_t>(rows * rows + columns * columns); }
    bool operator==(const LatticeVector&) const = default;
};

/// A shortest vector, of several the one of the fewest rows, of two in one row the one to the right; `side` N 1 or
/// more, `offset` below it.
LatticeVector shortest_vector(std::uint32_t offset, std::uint32_t side);

/// Square of its length, pixels.
std::uint64_t shortest_square(std::uint32_t offset, std::uint32_t side);

/// Offsets above `reference` whose shortest vector is longer than its own, and those where it is as long. The mirror of
/// the reference, side - reference, is in neither: the same lattice seen in a mirror.
struct SpreadOffsets {
    std::vector<std::uint32_t> longer, as_long;
};
SpreadOffsets well_spread_offsets(std::uint32_t side, std::uint32_t reference);

/// Whether each n x n block of pixels, wherever it lies, has no two pixels of one PE; with N = n n PEs it then has one
/// of each, as on n x n PEs of which each has every n-th pixel of every n-th line.
bool shares_blocks(std::uint32_t offset, std::uint32_t side, std::uint32_t n);

/// Rank of each value, 1 for the least; equal ones share the mean of their ranks.
std::vector<double> ranks_of(const std::vector<double>& values);

/// Spearman's correlation, of the ranks: -1..1, 0 where all values of either are equal.
double rank_correlation(const std::vector<double>& a, const std::vector<double>& b);

}  // namespace raya
