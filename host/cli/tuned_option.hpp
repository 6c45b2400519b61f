// --no-tuned: use of the values that raya tune stored for a device.
#pragma once
#include "host/cl/tuned.hpp"
#include "host/cli/scene_input.hpp"

namespace raya {

/// Adds --no-tuned.
void add_tuned_option(CLI::App& command, bool& no_tuned);

/// During its lifetime renders use the stored values, unless `no_tuned`. An unusable file is a warning, added to
/// `warnings` if given; they must outlive the result.
ScopedTunedSource use_tuned(bool no_tuned, Warnings* warnings = nullptr);

}  // namespace raya
