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
    double seconds = 60;      // time limit of the search in seconds
    double limit_s = 20;      // time limit of a candidate, including its build, in seconds
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
    double ratio = 1;           // time of `best` divided by the time of the defaults, from the final comparison
    bool complete = false;      // false: the time limit ended the search
    std::vector<Trial> trials;  // trials of the search, one for each measured candidate
    double seconds = 0;         // duration of the search, including builds
    std::optional<TunedValues> exhaustive_best;  // best candidate of the exhaustive search, if requested
    double exhaustive_ratio = 1;                 // time of `best` divided by the time of `exhaustive_best`
    std::size_t exhaustive_tried = 0;            // number of candidates that the exhaustive search measured

    std::size_t count(TrialStatus status) const;
    /// Returns the number of candidates that failed, rendered a wrong image, or exceeded the time limit.
    std::size_t dropped() const;
};

/// Tunes `workload`. A candidate is better than the best so far if ratio_of() is at most kMaxWinRatio. `best` has the
/// default values unless the best candidate is significantly faster than the defaults (wins_significantly()). Throws
/// DeviceError if the render with the defaults fails.
Tuning tune(const DeviceInfo& device, const Workload& workload, const TuneSettings& settings,
            const TrialProgress& progress);

/// Returns all trials as JSON in the T4 results format 1.0.0 of Kernel Tuner (KernelTuner/kernel_tuner,
/// kernel_tuner/schema/T4/1.0.0/results-schema.json). There is one result for each finished candidate, with
/// the values and the workload as "configuration", times in milliseconds, the status as "invalidity", and two
/// measurements: "time", the minimum time of an image, and "ratio", ratio_of() relative to the best candidate so far.
std::string t4_text(const DeviceInfo& device, const std::vector<Tuning>& tunings);

}  // namespace raya
