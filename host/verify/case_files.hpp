// The files of a self-contained case of a failed check; see reproduce.hpp.
#pragma once
#include <filesystem>
#include <string>

#include "host/verify/supervisor.hpp"

namespace raya {

/// Adds the host program, its header, Makefile and README to the captured files in `folder`. `step`: name of the
/// captured step; `reference`: source of the expected words; `kernels`: folder of the kernels, empty for raya's own.
/// With other kernels, also writes raya's own kernel, right.cl. Throws UserError.
void write_case(const std::filesystem::path& folder, const DeviceChecks& device, const Check& check,
                const std::string& step, const std::string& reference, const std::filesystem::path& kernels);

}  // namespace raya
