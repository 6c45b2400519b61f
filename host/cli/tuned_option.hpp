// The option --no-tuned, and the use of the values that raya tune stored for a device.
#pragma once
#include "host/cl/tuned.hpp"
#include "host/cli/scene_input.hpp"

namespace raya {

/// Adds --no-tuned.
void add_tuned_option(CLI::App& command, bool& no_tuned);

/// Returns an object during whose lifetime renders use the stored values or, with `no_tuned`, the defaults. An unusable
/// file of tuned values causes a warning, which is also added to `warnings` unless `warnings` is null. `warnings` must
/// outlive the result.
ScopedTunedSource use_tuned(bool no_tuned, Warnings* warnings = nullptr);

}  // namespace raya
