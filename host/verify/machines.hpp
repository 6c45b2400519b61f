// What the machines rest on beside numbers, by kernels/checks/machine.cl: whole-number arithmetic, local memory,
// barriers and atomics. All of it is exact: the host computes the same with the same headers.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "host/cl/kernel_source.hpp"
#include "host/verify/check_runner.hpp"
#include "host/verify/verdict.hpp"

namespace raya {

/// The program; `group_size`: L of its kernel turn_round, 1..1024.
CheckRunner machine_runner(Session& session, const KernelSources& sources, std::uint32_t group_size = 1);

/// Owners of pixels, their numbers and neighbours, in so many cases of a kind of mapping
/// (RAYA_FOLD_CYCLIC..RAYA_RANDOM).
Verdict check_owners(CheckRunner& runner, std::uint32_t kind, std::size_t cases);

/// The first links of so many ways through toruses of either kind, and the ends of links.
Verdict check_ways(CheckRunner& runner, std::size_t cases);

/// Words that work-groups turn round in local memory, several times, and numbers that their work-items draw.
Verdict check_local_memory(CheckRunner& runner, std::uint32_t group_size);

}  // namespace raya
