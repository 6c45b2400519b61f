// Detection of an MPI launcher (mpirun, srun, ...), and start of the ranks.
#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/ranks/ranks.hpp"

namespace raya {

/// Rank and number of ranks, as given by a launcher's environment variables.
struct Launch {
    std::uint32_t rank = 0;
    std::optional<std::uint32_t> count;  // empty if the launcher does not set it
};

/// Return rank and count as set by the launcher; empty if no launcher has started this process. launch_from() reads
/// environment variables with `variable` instead of std::getenv.
std::optional<Launch> launch_from(const std::function<const char*(const char*)>& variable);
std::optional<Launch> find_launch();

/// Connects the ranks if a launcher has started more than one, else returns nullptr. Must be called before OpenCL is
/// used, because it sets POCL_MAX_PTHREAD_COUNT (unless it is set) to this rank's share of the host's cores. Throws
/// UserError in every process if raya was built without MPI, or with a different MPI than that of the launcher.
std::unique_ptr<Ranks> open_ranks();

/// Throws UserError if this rank runs a different version of raya than rank 0, or has different arguments.
void check_same_program(Ranks& ranks, const std::vector<std::string>& arguments);

/// Returns the number of threads for a rank. `cores`: number of the host's cores; `usable`: number of cores that this
/// process may use. A process that is bound to some of the cores uses these; otherwise the host's ranks share all
/// cores.
std::uint32_t threads_of_rank(std::uint32_t usable, std::uint32_t cores, std::uint32_t ranks_of_host);

}  // namespace raya
