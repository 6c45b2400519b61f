// Tunes a device for one workload: measures the defaults, searches, checks the image of every candidate, and finally
// compares the best candidate with the defaults again.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/tune/search.hpp"
#include "host/tune/trial.hpp"

namespace raya {

struct TuneSettings {
    TrialSetup render;        // for all trials
    double seconds = 60;      // time limit of the search
    double limit_s = 20;      // time limit of a candidate, with its build
    bool exhaustive = false;  // also try every candidate after the search
};

/// Called about five times a second while a trial runs, with the candidate's values and the run time in seconds.
using TrialProgress = std::function<void(const TunedValues& values, double seconds)>;

/// Result of tuning a workload.
struct Tuning {
    Workload workload;
    Space space;
    TunedValues best;
    double ratio = 1;                     // time of `best` over that of the defaults, by the final comparison
    bool complete = false;                // the search ended by itself, not by its time limit
    std::vector<Trial> trials;            // one for each candidate of the search
    double seconds = 0;                   // duration of the search, with builds
    std::optional<TunedValues> best_all;  // best of the exhaustive search
    double ratio_all = 1;                 // time of `best` over that of `best_all`
    std::size_t tried_all = 0;            // number of candidates of the exhaustive search

    std::size_t count(TrialStatus status) const;
    /// Number of candidates that failed, rendered another image, or exceeded the time limit.
    std::size_t dropped() const;
};

/// Tunes `workload`. A candidate is better if ratio_of() is at most kMaxWinRatio. If the best candidate is not
/// significantly faster than the defaults (wins_significantly()), the defaults are the result. Throws DeviceError if
/// the defaults fail.
Tuning tune(const DeviceInfo& device, const Workload& workload, const TuneSettings& settings,
            const TrialProgress& running);

/// All trials as JSON in the T4 results format 1.0.0 of Kernel Tuner (KernelTuner/kernel_tuner,
/// kernel_tuner/schema/T4/1.0.0/results-schema.json): one result for each finished candidate, with its values and
/// workload as "configuration", times in milliseconds, its status as "invalidity", and the measurements "time", the
/// minimum for an image, and "ratio", to the best so far.
std::string t4_text(const DeviceInfo& device, const std::vector<Tuning>& tunings);

}  // namespace raya
