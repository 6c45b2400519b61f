// A cost image in as few bytes as a page can read back exactly.
#pragma once
#include <cstdint>
#include <string>

#include "host/ring/schedule.hpp"

namespace raya {

/// The script adds costs up in doubles, which hold whole numbers below this one exactly.
inline constexpr std::uint64_t kExactCycles = std::uint64_t{1} << 53;

/// Bytes of the largest cost, 1 at least.
std::uint32_t bytes_of_cost(const CostImage& cost);

/// The lowest bytes of all pixels row by row, then the next ones, bytes_of_cost() times; as one gzip file. Neighbours
/// differ little in their high bytes, so that planes of bytes take less room than pixels one after another.
std::string cost_bytes(const CostImage& cost);

}  // namespace raya
