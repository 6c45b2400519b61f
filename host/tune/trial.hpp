// A trial: a few candidates that are rendered side by side in a process of their own, and what came of it.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "host/tune/space.hpp"
#include "host/tune/workload.hpp"

namespace raya {

/// What the process is to do, as it reads it from its command line.
struct TrialOrder {
    Workload workload;
    std::vector<TunedValues> candidates;  // the best so far, and what is held against it
    std::uint32_t samples = 5;            // of each, in turn
    bool stop_early = true;               // once the last one is far slower than the first

    std::string text() const;
    static TrialOrder of(const std::string& text);  // UserError
};

/// How it ended. The names are those of the T4 format (t4_report.hpp).
enum class Fate {
    kCorrect,
    kCompile,      // a driver did not build the kernels, or ended the program while it did
    kRuntime,      // it failed, or ended the program, while it rendered
    kCorrectness,  // another image, or another number of rays
    kTimeout,      // it was not done in time
    kUnfinished    // the search's own time was over: nothing is known
};

struct Trial {
    TunedValues values;  // of the last candidate
    Fate fate = Fate::kUnfinished;
    std::string told;                          // what was wrong, in a line
    std::string check;                         // of the last candidate
    double build_s = 0;                        // of the last candidate
    double wall_s = 0;                         // of the whole process
    std::vector<std::vector<double>> samples;  // of each candidate the seconds of one image
    std::string when;                          // it ended: "2026-11-22T23:59:59Z"
};

/// The last candidate's time over the first one's: of the ratio of the least times and the median of the ratios of
/// samples that were taken one after the other, the larger; what is to count as a win must win by both. 1 where there
/// is no sample.
double ratio_of(const Trial& trial);

/// Whether the last candidate is better than the first beyond chance: by both figures of ratio_of(), and in all pairs
/// of samples but one in nine, which happens once in fifty times where both are alike.
bool wins_surely(const Trial& trial);

/// The median ratio of two candidates' samples alone, for figures that are told.
double median_ratio(const std::vector<double>& of, const std::vector<double>& over);

/// Runs the order in this process and writes what comes of it to the file `lines`, a JSON object a line; what goes
/// wrong becomes a line:
///
///     {"built": N}                                       candidate N can render
///     {"check": TEXT, "build_s": S}                      and has rendered once
///     {"samples": [[S, ...], ...]}                       of each candidate; that was all
///     {"error": TEXT, "kind": "user" or "device"}        nothing more comes
void run_trial(int lines, const std::string& device, const TrialOrder& order, const Scene* given, const ImageSize& size,
               std::uint32_t pes, const KernelSources& sources);

}  // namespace raya
