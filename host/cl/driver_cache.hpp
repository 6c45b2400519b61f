// Where PoCL keeps the kernels that it has built.
#pragma once

namespace raya {

/// PoCL finds no device where it cannot write its cache: where neither POCL_CACHE_DIR nor a home that may be written
/// gives it a place, one below the folder for temporary files is named in POCL_CACHE_DIR, and that said on stderr. To
/// be called before OpenCL is; does nothing the second time.
void provide_driver_cache();

}  // namespace raya
