// Renders on the ranks that can be had here, for the study of ranks to be held against.
#pragma once
#include <cstdint>
#include <vector>

#include "host/cl/device_info.hpp"
#include "host/study/rank_runs.hpp"
#include "host/study/ranks_machines.hpp"

namespace raya {

inline constexpr int kRankTurns = 3;       // renders on each number of ranks, in turn, at most
inline constexpr double kEnoughRankS = 5;  // of renders on one number of ranks: then no further

/// What is here.
struct RanksHere {
    std::vector<std::uint32_t> ranks;  // that are measured, 1, 2, 4, ...: up to twice the cores, 4 to 16
    std::vector<double> processors;    // that these have together
    PingReport ping;                   // between two hosts where there are several
};

/// RanksFailure.
RanksHere look_around(const Mpirun& mpirun);

/// A number of ranks that was tried.
struct RankTrial {
    std::vector<double> seconds;  // of each render
    RankedRender best;            // of least time
};

/// On each of here.ranks, one thread a rank; after a render that does not count. RanksFailure; UserError where the
/// ranks take another device than `device`, whose kernels have told what is counted.
std::vector<RankTrial> measure(const Mpirun& mpirun, const RankedMachine& machine, const RanksHere& here,
                               const DeviceInfo& device);

}  // namespace raya
