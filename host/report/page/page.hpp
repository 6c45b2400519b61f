// HTML page of a report: one file that contains the report as JSON, and scripts that display the report.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "host/base/json.hpp"

namespace raya {

/// Returns the page of a report of raya render, bench, verify or explore, or of tools/gpu_day. Texts of the report are
/// escaped, so that they cannot close the element that contains them or run as a script. The page does not load
/// anything from the network. Without JavaScript it shows the JSON.
std::string report_page(const Json& report);

/// Maximum number of cycles of an image, summed over its pixels. The explorer's script computes with doubles, which
/// represent integers exactly up to this limit.
inline constexpr std::uint64_t kExactCycles = std::uint64_t{1} << 53;

/// Encodes the costs of pixels for the explorer's script: {"bytes": B, "gzip": base64}. The gzip data has B planes, one
/// for each byte of a cost, from the lowest to the highest byte. A plane has one byte per pixel, row by row. Planes
/// compress better than interleaved bytes, because adjacent pixels rarely differ in the high bytes of their costs.
Json cost_json(const std::vector<std::uint64_t>& cycles);

}  // namespace raya
