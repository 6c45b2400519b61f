// The option --no-tuned, and the use of the values that raya tune stored for a device.
#pragma once
#include "host/cl/tuned.hpp"
#include "host/cli/scene_input.hpp"

namespace raya {

void add_tuned_option(CLI::App& command, bool& no_tuned);

/// Returns an object during whose lifetime renders use the stored values or, with `no_tuned`, the defaults. Prints a
/// warning if the file of stored values is unusable, and adds it to `warnings` unless `warnings` is null. `warnings`
/// must outlive the result.
ScopedTunedSource use_tuned(bool no_tuned, Warnings* warnings = nullptr);

}  // namespace raya
