// Detection of an MPI launcher (mpirun, srun, ...), and start of the ranks.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/ranks/ranks.hpp"

namespace raya {

/// Rank of this process and number of ranks, which a launcher has set in environment variables.
struct Launch {
    std::uint32_t rank = 0;
    std::optional<std::uint32_t> count;  // number of ranks; empty if the launcher does not set it
};

/// Returns rank and number of ranks, or empty if no launcher has started this process.
std::optional<Launch> find_launch();

/// Connects the ranks if a launcher has started more than one, else returns nullptr. Sets the environment variable
/// POCL_MAX_PTHREAD_COUNT to threads_of_rank(), unless the user has set it. So open_ranks() must be called before
/// OpenCL is used. Throws UserError in every process if raya was built without MPI, or with a different MPI than that
/// of the launcher.
std::unique_ptr<Ranks> open_ranks();

/// Collective: throws UserError if this rank runs a different version of raya than rank 0, or has different arguments.
void check_same_program(Ranks& ranks, const std::vector<std::string>& arguments);

/// Returns the number of threads, at least 1, for a rank's OpenCL CPU device. `usable_cores`: number of cores to which
/// the process is bound. Returns `usable_cores` if it is less than `host_cores`, else `host_cores` / `ranks_of_host`.
std::uint32_t threads_of_rank(std::uint32_t usable_cores, std::uint32_t host_cores, std::uint32_t ranks_of_host);

}  // namespace raya
