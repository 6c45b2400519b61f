// Runs trials, each in a process of its own: a driver that crashes or hangs takes that process with it, and no other.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "host/tune/trial.hpp"

namespace raya {

/// Called about twice a second while a trial runs, with its seconds.
using TrialSink = std::function<void(double)>;

/// Starts this program with `arguments`, which end with the option that takes a trial's order, and watches it: for
/// `limit_s` seconds, after which it is ended. `check` is what the candidates' images must be; empty: anything.
/// UserError as the process met it.
Trial supervise_trial(const std::vector<std::string>& arguments, const TrialOrder& order, double limit_s,
                      const std::string& check, const TrialSink& running = {});

}  // namespace raya
