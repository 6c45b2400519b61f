#include "machine/machine.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "error.hpp"

namespace raya {

const std::vector<Machine>& machines() {
    static const std::vector<Machine> all = {
        // Kohata & Ito 1993: 256 DSPs, 32 KB each, ring and bus, up to 8 reflections and refractions; best offset 16
        {.name = "spa",
         .title = "the SPA",
         .topology = "ring+bus",
         .pes = 256,
         .offset = 16,
         .pe_memory_bytes = 32 * 1024,
         .format = {6, 15, false}},  // 22 bits; how they are divided is not printed in the paper
        // ours: the same array without the memory limit, one PE a column; fp32, as it is there for scenes that no SPA
        // could hold
        {.name = "grande",
         .title = "grande",
         .topology = "ring+bus",
         .pes = {},
         .offset = 16,
         .pe_memory_bytes = {},
         .format = {}},
    };
    return all;
}

const Machine& machine_named(const std::string& name) {
    const auto& all = machines();
    const auto found = std::find_if(all.begin(), all.end(), [&](const Machine& m) { return m.name == name; });
    if (found != all.end()) return *found;
    std::vector<std::string> names;
    for (const Machine& m : all) names.push_back(m.name);
    throw UserError(fmt::format("no machine '{}': there are {}", name, fmt::join(names, ", ")));
}

std::array<std::uint32_t, RAYA_EVENTS> cycles_of_events() {
    constexpr std::uint32_t kRoot = 8;  // division, square root
    std::array<std::uint32_t, RAYA_EVENTS> cycles{};
    cycles[RAYA_PRIMARY] = 6 + 6 + 2 * kRoot;                                // two steps from the corner; normalise
    cycles[RAYA_REFLECTED] = 1;                                              // weight
    cycles[RAYA_REFRACTED] = 3 + 2 + 2 + 2 + 3 + 3 + 3 + 1 + 6 + 4 * kRoot;  // Snell, direction, normalise
    cycles[RAYA_SHADOW] = 3 + 3 + 3 + 3 + 2 * kRoot;                         // arm, length, N.L, direction
    cycles[RAYA_SPHERE_TESTS] = 3 + 3 + 3 + 3 + 2 + kRoot;
    cycles[RAYA_PLANE_TESTS] = 3 + 3 + kRoot;
    cycles[RAYA_POLYGON_TESTS] = 3 + 3 + kRoot + 2 + 3 * 2;  // three edges
    cycles[RAYA_CONE_TESTS] = 3 + 3 + 3 + 6 + 6 + 2 + 12 + 2 + 4 + 3 * kRoot;
    cycles[RAYA_SHADED] =
        3 + 3 + 6 + 3 + 3 + 4 + 3 + 3 + 4 + 3 + 2 * kRoot;  // point, normal, tint, ambient, mirror, margin
    cycles[RAYA_LIT] = 3 + 3 + 3 + 3 + 3;                   // N.L, R.L, sum
    cycles[RAYA_HIGHLIGHTS] = 2 + 7 + 11 + kRoot;           // a power
    return cycles;                                          // hits cost nothing of their own
}

}  // namespace raya
