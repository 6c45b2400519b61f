// Whether a command takes what raya tune has kept for its device.
#pragma once
#include "host/cl/tuned.hpp"
#include "host/cli/scene_input.hpp"

namespace raya {

/// Adds --no-tuned.
void add_tuned_option(CLI::App& command, bool& no_tuned);

/// While it lives, renders take what is kept, unless `no_tuned`. A file that cannot be used is a warning: one of
/// `warnings`, where they are given, which outlive it.
TunedUse use_tuned(bool no_tuned, Warnings* warnings = nullptr);

}  // namespace raya
