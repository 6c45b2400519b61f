// Options of a run of raya with an injected OpenCL fault.
#pragma once
#include <string>

#include "tests/cli/run_program.hpp"
#include "tests/paths.h"

namespace raya {

#ifdef __SANITIZE_ADDRESS__
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

/// Returns the options of a run with an injected fault. `fault`: value of RAYA_FAULT (cl_faults.cpp).
inline RunOptions device_with_fault(const std::string& fault) {
    return {.variables = {{"LD_PRELOAD", RAYA_CL_FAULTS},
                          {"RAYA_FAULT", fault},
                          {"ASAN_OPTIONS", "detect_leaks=0:verify_asan_link_order=0:handle_segv=0"}}};
}

}  // namespace raya
