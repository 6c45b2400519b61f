#include "host/study/strategies.hpp"

#include <fmt/core.h>

#include <cmath>
#include <numeric>

#include "host/study/arrays.hpp"

namespace raya {
namespace {

bool owns_single_columns(const raya_mapping& mapping) {
    std::vector<std::uint32_t> column_of(mapping.pes, mapping.width);  // mapping.width: none yet
    for (std::uint32_t row = 0; row < mapping.height; ++row)
        for (std::uint32_t column = 0; column < mapping.width; ++column) {
            std::uint32_t& own = column_of[raya_owner(mapping, row, column)];
            if (own == mapping.width) own = column;
            if (own != column) return false;
        }
    return true;
}

// The dynamic one or the hybrid, with free requests and with such of `overhead` cycles.
void add_asking(std::vector<Strategy>& all, const raya_mapping& start, std::uint32_t chunk, double share,
                std::uint64_t overhead) {
    const std::string name =
        share > 0 ? fmt::format("hybrid:{}, share {}", chunk, share) : fmt::format("dynamic:{}", chunk);
    const StrategyKind kind = share > 0 ? StrategyKind::kHybrid : StrategyKind::kDynamic;
    all.push_back({name + ", free requests", kind, start, {chunk, 0, share}});
    all.push_back({name, kind, start, {chunk, overhead, share}});
}

}  // namespace

std::vector<Strategy> strategies(std::uint32_t size, std::uint32_t pes, std::uint64_t overhead) {
    constexpr std::uint32_t kOffset = 16, kTile = 8;
    const std::uint32_t tile = std::gcd(size, kTile);
    const auto other = [&](const MappingRule& rule) { return make_mapping(rule, {size, size}, pes); };
    const raya_mapping columns = cyclic(size, size, pes, 0), grid = squarest_grid(size, size, pes);
    std::vector<Strategy> all;
    const auto add = [&](const char* name, const raya_mapping& mapping) {
        all.push_back({name, StrategyKind::kStatic, mapping, {}});
    };
    add("column split", columns);
    add("cyclic, p = 16", cyclic(size, size, pes, kOffset % size));
    add("cyclic, p = sqrt(P)", cyclic(size, size, pes, root_offset(pes) % size));
    add("blocks of scan lines", other(blocks_mapping()));
    add("tiles 8 x 8", other(tiles_mapping(tile, tile)));
    add("grid", grid);
    add("random", random_pixels(size, size, pes));
    for (const std::uint32_t chunk : {1u, 16u, 64u}) add_asking(all, columns, chunk, 0, overhead);
    add_asking(all, grid, 16, 0.5, overhead);
    add_asking(all, grid, 16, 0.9, overhead);
    add_asking(all, grid, 1, 0.9, overhead);
    return all;
}

StrategyOutcome run_strategy(const CostImage& image, const Strategy& strategy) {
    const std::uint32_t pes = strategy.mapping.pes;
    StrategyOutcome outcome;
    if (strategy.kind == StrategyKind::kStatic) {
        outcome.makespan = static_load(image, strategy.mapping).max;
        outcome.single_columns = owns_single_columns(strategy.mapping);
    } else {
        const Schedule schedule = dynamic_schedule(image, strategy.mapping, strategy.plan);
        outcome.makespan = makespan(schedule);
        outcome.requests = schedule.requests;
    }
    if (outcome.makespan == 0) return {0, 1, 1, outcome.requests, outcome.single_columns};
    const auto last = static_cast<double>(outcome.makespan);
    outcome.efficiency = static_cast<double>(total_cycles(image)) / (static_cast<double>(pes) * last);
    outcome.over_bound = last / static_cast<double>(lower_bound(image, pes));
    return outcome;
}

std::uint64_t round_trip_cycles(const Machine& machine, double factor) {
    constexpr double kWords = 1 + 2;
    const double ms = 2 * machine.rotation_sync_ms.value() + 1e3 * kWords / machine.link_words_per_s.value();
    return static_cast<std::uint64_t>(std::llround(1e6 * ms / (factor * machine.cycle_ns.value())));
}

}  // namespace raya
