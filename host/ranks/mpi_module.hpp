// The function by which the module of MPI is opened.
#pragma once

namespace raya {

class Transport;

/// Starts MPI. A wait of more than `limit_s` seconds ends with RankFailure. The caller owns what is returned.
using OpenMpi = Transport*(double limit_s);

inline constexpr const char *kMpiModule = "raya_mpi", *kOpenMpi = "raya_open_mpi";

}  // namespace raya
