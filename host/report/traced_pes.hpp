// Which PEs of a machine a trace shows.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace raya {

struct TracedPe {
    std::uint32_t pe = 0;
    std::string remark;  // "busiest", "idlest" or empty
};

/// At most `most` PEs, by number: a quarter of them the busiest, a quarter the idlest, of equals the lowest numbers;
/// the others spread evenly over the numbers, PE 0 first. All PEs where there are no more than that.
std::vector<TracedPe> traced_pes(const std::vector<std::uint64_t>& loads, std::size_t most);

/// "PE 17 (busiest)"; `kind` is "PE" or "node".
std::string traced_pe_name(const std::string& kind, const TracedPe& traced);

}  // namespace raya
