// Tunes a device for one workload: measures its defaults, searches, checks every candidate, and holds the best against
// the defaults once more.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/tune/search.hpp"
#include "host/tune/trial.hpp"

namespace raya {

struct TuneSettings {
    TrialRenders render;      // of all trials
    double seconds = 60;      // of the search
    double limit_s = 20;      // of a candidate, with its build
    bool exhaustive = false;  // every candidate is tried as well
};

/// Told about five times a second: a trial has been running for so many seconds; `values` are the candidate's.
using TrialWatch = std::function<void(const TunedValues& values, double seconds)>;

/// What came of a workload.
struct Tuning {
    Workload workload;
    Space space;
    TunedValues best;
    double ratio = 1;                     // of the best one's time to the defaults', measured in the end
    bool complete = false;                // nothing promising was left when the search ended
    std::vector<Trial> trials;            // of the search, candidates alone
    double seconds = 0;                   // of the search, builds and all
    std::optional<TunedValues> best_all;  // of an exhaustive search
    double ratio_all = 1;                 // of the tuned one's time to that one's
    std::size_t tried_all = 0;            // candidates of the exhaustive search

    std::size_t count(Fate fate) const;
    /// Candidates that failed, rendered something else, or hung.
    std::size_t dropped() const;
};

/// A candidate counts as better where it wins by both figures of ratio_of(); the best in the end must win surely
/// against the defaults (wins_surely), or the defaults are the best. DeviceError where the defaults themselves fail.
Tuning tune(const DeviceInfo& device, const Workload& workload, const TuneSettings& settings,
            const TrialWatch& running);

/// Everything that was tried, in the results format of the T4 schema, version 1.0.0, which Kernel Tuner writes and
/// tools about it read (KernelTuner/kernel_tuner, kernel_tuner/schema/T4/1.0.0/results-schema.json): a result for each
/// candidate that has ended, its values and its workload as "configuration", times in milliseconds, how it ended as
/// "invalidity", and the measurements "time", the least of an image, and "ratio", to the best so far.
std::string t4_text(const DeviceInfo& device, const std::vector<Tuning>& tunings);

}  // namespace raya
