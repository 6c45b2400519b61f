// Ways to give an image to P PEs, static, dynamic and both, and how near each comes to the best there can be.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "host/model/machine.hpp"
#include "host/ring/schedule.hpp"

namespace raya {

enum class StrategyKind { kStatic, kDynamic, kHybrid };

struct Strategy {
    std::string name;  // "cyclic, p = sqrt(P)"
    StrategyKind kind = StrategyKind::kStatic;
    raya_mapping mapping = {};  // of the whole image; of a hybrid: what it starts with
    DynamicPlan plan;           // of a dynamic one or a hybrid

    bool pays() const { return plan.overhead > 0; }  // for its requests
};

/// Column split, cyclic p = 16 and p = sqrt(P), blocks of scan lines, tiles of 8 x 8, the grid nearest to a square,
/// random; dynamic with chunks of 1, 16 and 64; hybrid with chunks of 16 after shares of 0.5 and 0.9 and of 1 after
/// 0.9, of the grid's pixels. Those that ask, with requests for nothing and with requests of `overhead` cycles. Where
/// 16, sqrt(P) or 8 does not suit the image's side, the offset is taken modulo it, the tile of its greatest common
/// divisor with it.
std::vector<Strategy> strategies(std::uint32_t size, std::uint32_t pes, std::uint64_t overhead);

struct StrategyOutcome {
    std::uint64_t makespan = 0;  // cycles
    double efficiency = 0;       // pure work / (P makespan)
    double over_bound = 1;       // makespan / lower_bound(): 1 is optimal
    std::uint64_t requests = 0;
    bool single_columns = false;  // of a static one: each PE's pixels lie in one column
};
/// `image`: of the size that the strategy was made for.
StrategyOutcome run_strategy(const CostImage& image, const Strategy& strategy);

/// Budget cycles of a PE, each `factor` times the machine's cycle (spa_clock.hpp), from a request until its answer is
/// there: a word (its number) to the root and two (first pixel, how many) back at the links' rate, each way with the
/// synchronisation of a rotation. [?] The SPA never did this. The synchronisation is what a barrier of all PEs takes
/// and so the most that one PE's request can; what its host takes to look a chunk up is left out.
std::uint64_t round_trip_cycles(const Machine& machine, double factor);

}  // namespace raya
