// A report as a page for a browser: its JSON within one HTML file, whose scripts show it.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "host/base/json.hpp"

namespace raya {

/// The page of a report of render, bench, verify or explore. No text in the report can end its element or run; the page
/// needs no network, and shows the JSON itself where scripts are off.
std::string report_page(const Json& report);

/// The explorer's script adds up costs in doubles, which hold whole numbers below this one exactly.
inline constexpr std::uint64_t kExactCycles = std::uint64_t{1} << 53;

/// A cost image as the explorer's script reads it back, {"bytes": B, "gzip": base64}: the lowest bytes of all pixels
/// row by row, then the next ones, B times; as one gzip file. Neighbours differ little in their high bytes, so that
/// planes of bytes take less room than pixels one after another.
Json cost_json(const std::vector<std::uint64_t>& cycles);

}  // namespace raya
