// How the program was started: alone, or as one of several processes by mpirun, srun and their kin.
#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/ranks/ranks.hpp"

namespace raya {

/// What a launcher says of itself in the environment.
struct Launch {
    std::uint32_t rank = 0;
    std::optional<std::uint32_t> count;  // empty where it does not say
};

/// Empty where no launcher has started this process. `variable` stands in for std::getenv.
std::optional<Launch> launch_of(const std::function<const char*(const char*)>& variable);
std::optional<Launch> launched();

/// The ranks, where a launcher has started more than one; else nothing. PoCL then takes this rank's part of the host's
/// cores: POCL_MAX_PTHREAD_COUNT, unless it is set. To be called before OpenCL is. UserError in every process where
/// this raya has no MPI, or another one than the launcher's.
std::unique_ptr<Ranks> open_ranks();

/// UserError where this rank has another version of raya than rank 0, or other arguments.
void check_alike(Ranks& ranks, const std::vector<std::string>& arguments);

/// Threads for a rank's part of a host's CPU: `usable` cores of `cores` are this process's; where it is bound to some
/// of them, these are its own, else the ranks of the host share all of them.
std::uint32_t threads_of_rank(std::uint32_t usable, std::uint32_t cores, std::uint32_t ranks_of_host);

}  // namespace raya
