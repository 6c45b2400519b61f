// Detection of a launcher (mpirun, srun, ...) and the start of ranks.
#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/ranks/ranks.hpp"

namespace raya {

/// Rank and number of ranks, from a launcher's environment variables.
struct Launch {
    std::uint32_t rank = 0;
    std::optional<std::uint32_t> count;  // empty if the launcher does not set it
};

/// Empty if no launcher has started this process. `variable` replaces std::getenv.
std::optional<Launch> launch_of(const std::function<const char*(const char*)>& variable);
std::optional<Launch> launched();

/// Opens the ranks if a launcher has started more than one, else returns nullptr. Must be called before OpenCL: sets
/// POCL_MAX_PTHREAD_COUNT, unless it is set, to this rank's share of the host's cores. Throws UserError in every
/// process if this raya was built without MPI or with a different one than the launcher's.
std::unique_ptr<Ranks> open_ranks();

/// Throws UserError if this rank runs a different version of raya than rank 0, or has different arguments.
void check_same_program(Ranks& ranks, const std::vector<std::string>& arguments);

/// Number of threads for a rank. `usable`: cores that this process may use, of the host's `cores`. A process that is
/// bound to some cores uses those; otherwise the ranks of the host share all cores.
std::uint32_t threads_of_rank(std::uint32_t usable, std::uint32_t cores, std::uint32_t ranks_of_host);

}  // namespace raya
