// HTML page of a report: one file with the JSON, and scripts that display it.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "host/base/json.hpp"

namespace raya {

/// Returns the page of a report of render, bench, verify, explore or tools/gpu_day. Texts of the report are escaped, so
/// that none can end its element or run as a script. The page needs no network; without scripts it shows the JSON.
std::string report_page(const Json& report);

/// Limit of the sum of costs: the explorer's script uses doubles, which represent integers exactly up to here.
inline constexpr std::uint64_t kExactCycles = std::uint64_t{1} << 53;

/// Encodes a cost image for the explorer's script: {"bytes": B, "gzip": base64}. The gzip data has B planes: the lowest
/// bytes of all pixels row by row, then the next higher ones. Planes compress better than interleaved bytes, because
/// neighbours rarely differ in their high bytes.
Json cost_json(const std::vector<std::uint64_t>& cycles);

}  // namespace raya
