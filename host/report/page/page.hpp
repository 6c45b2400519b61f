// HTML page of a report: one file that contains the report as JSON, and scripts that display the report.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "host/base/members.hpp"

namespace raya {

/// Returns the page of a report of raya render, bench, verify or explore, or of tools/gpu_day. Texts of the report are
/// escaped, so that they cannot close the element that contains them or run as a script. The page does not load
/// anything from the network. Without JavaScript it shows the JSON.
std::string report_page(const Json& report);

/// The costs of pixels for the explorer's script. The gzip data has a plane for each byte of a cost, from the lowest to
/// the highest byte. A plane has one byte per pixel, row by row. Planes compress better than interleaved bytes, because
/// adjacent pixels rarely differ in the high bytes of their costs.
struct CostPlanes {
    std::uint32_t bytes = 1;  // of a cost
    std::string gzip;
};
void members_of(Members& m, const CostPlanes& cost);
CostPlanes cost_planes(const std::vector<std::uint64_t>& cycles);

}  // namespace raya
