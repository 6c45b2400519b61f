// Tunes a device for one workload: measures the defaults, searches for a faster candidate, checks the image of every
// candidate, and finally compares the best candidate with the defaults again.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/tune/search.hpp"
#include "host/tune/trial.hpp"

namespace raya {

struct TuneSettings {
    TrialSetup render;        // device, scene and size of all trials
    double seconds = 60;      // time limit of the search, seconds
    double limit_s = 20;      // time limit of a candidate including its build, seconds
    bool exhaustive = false;  // after the search, also measure every candidate
};

/// Called about five times a second while a trial runs, with the candidate's values and the trial's run time in
/// seconds.
using TrialProgress = std::function<void(const TunedValues& values, double seconds)>;

/// Result of tuning a workload.
struct Tuning {
    Workload workload;
    Space space;
    TunedValues best;
    double ratio = 1;                     // time of `best` over that of the defaults, from the final comparison
    bool complete = false;                // the search was not ended by its time limit
    std::vector<Trial> trials;            // one for each candidate that the search measured
    double seconds = 0;                   // duration of the search including builds
    std::optional<TunedValues> best_all;  // best of the exhaustive search
    double ratio_all = 1;                 // time of `best` over that of `best_all`
    std::size_t tried_all = 0;            // number of candidates of the exhaustive search

    std::size_t count(TrialStatus status) const;
    /// Returns the number of candidates that failed, rendered a wrong image, or exceeded the time limit.
    std::size_t dropped() const;
};

/// Tunes `workload`. A candidate is better than the best so far if ratio_of() is at most kMaxWinRatio. The result is
/// the defaults unless the best candidate is significantly faster than they are (wins_significantly()). Throws
/// DeviceError if rendering with the defaults fails.
Tuning tune(const DeviceInfo& device, const Workload& workload, const TuneSettings& settings,
            const TrialProgress& running);

/// Returns all trials as JSON in the T4 results format 1.0.0 of Kernel Tuner (KernelTuner/kernel_tuner,
/// kernel_tuner/schema/T4/1.0.0/results-schema.json). There is one result for each finished candidate. It has the
/// values and workload as "configuration", times in milliseconds, the status as "invalidity", and as measurements
/// "time", the minimum time of an image, and "ratio", the time divided by that of the best so far.
std::string t4_text(const DeviceInfo& device, const std::vector<Tuning>& tunings);

}  // namespace raya
