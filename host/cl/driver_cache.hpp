// Where PoCL keeps the kernels that it has built.
#pragma once
#include <string>

namespace raya {

/// Names in POCL_CACHE_DIR, unless it is set, a folder for PoCL's kernels that no other user but root may write: the
/// one that PoCL would take, else one below the folder for temporary files, with a warning. PoCL runs what it finds
/// there, and has no device where it cannot write it. To be called before OpenCL is.
void provide_driver_cache();

/// Why PoCL cannot keep kernels in that folder, and the remedy; empty where it can. Writes a file there for a moment.
std::string driver_cache_trouble();

}  // namespace raya
