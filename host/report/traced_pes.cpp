#include "host/report/traced_pes.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <numeric>

namespace raya {

std::vector<TracedPe> traced_pes(const std::vector<std::uint64_t>& loads, std::size_t most) {
    const std::size_t pes = loads.size(), all = std::min(most, pes);
    std::vector<std::uint32_t> by_load(pes);
    std::iota(by_load.begin(), by_load.end(), 0u);
    std::stable_sort(by_load.begin(), by_load.end(), [&](auto a, auto b) { return loads[a] > loads[b]; });
    std::map<std::uint32_t, std::string> chosen;
    for (std::size_t i = 0; i < (all + 3) / 4; ++i) chosen[by_load[i]] = "busiest";
    std::stable_sort(by_load.begin(), by_load.end(), [&](auto a, auto b) { return loads[a] < loads[b]; });
    for (std::size_t i = 0; i < all / 4; ++i) chosen.try_emplace(by_load[i], "idlest");
    const std::size_t others = all - std::min(all, chosen.size());
    for (std::size_t i = 0; i < others; ++i) chosen.try_emplace(static_cast<std::uint32_t>(i * pes / others), "");
    for (std::uint32_t pe = 0; chosen.size() < all; ++pe) chosen.try_emplace(pe, "");
    std::vector<TracedPe> traced;
    for (const auto& [pe, remark] : chosen) traced.push_back({pe, remark});
    return traced;
}

std::string traced_pe_name(const std::string& kind, const TracedPe& traced) {
    return fmt::format("{} {}{}", kind, traced.pe, traced.remark.empty() ? "" : fmt::format(" ({})", traced.remark));
}

}  // namespace raya
