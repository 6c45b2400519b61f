// raya bench --tune: what a device is tuned to, searched, checked and kept.
#pragma once
#include <string>
#include <vector>

#include "host/cli/render_options.hpp"

namespace raya {

struct TuneCommand {
    bool wanted = false, exhaustive = false;
    double seconds = 60, candidate_seconds = 20;
    std::string trial;  // an order, in the process of a trial (host/tune/trial.hpp)
    int lines = -1;     // a pipe, in there
};

/// Adds --tune and what goes with it.
void add_tune_options(CLI::App& bench, TuneCommand& tune);

/// Refuses options that say nothing with --tune, or without it. UserError.
void check_tune_options(const CLI::App& parsed, const TuneCommand& tune);

/// Tunes the device for `ways` in the formats of `render`, for the usual workloads where both are empty; writes
/// `report` where it names a file. In the process of a trial runs that.
void bench_tune(const CLI::App& parsed, const RenderOptions& render, const std::vector<std::string>& ways,
                const std::string& report, const TuneCommand& tune);

}  // namespace raya
