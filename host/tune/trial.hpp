// A trial: renders a few candidates alternately in a child process, and measures them.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "host/base/json.hpp"
#include "host/cl/tuned.hpp"
#include "host/model/mapping_rule.hpp"
#include "host/model/number_format.hpp"

namespace raya {

/// A variant of the renderer in a number format. Variants: "none", "grid" and "bvh" (ring machine with that
/// accelerator) and "torus" (4 x 4 x 4 nodes).
struct Workload {
    std::string variant;
    NumberFormat format{};

    TuningKey key() const;     // throws UserError for an unknown variant
    std::string name() const;  // "ring none fp32", "torus fp32"
};

/// Returns the ring without accelerator in fp32 and e6m15, the ring with each accelerator in fp32, and the torus in
/// fp32.
std::vector<Workload> default_workloads();

/// Device, scene and image size of trials. The default scene has 30 spheres and a plane; with an accelerator it is
/// "balls" of the Standard Procedural Databases, with 7,381 spheres. The default size is 512 x 512 pixels; with an
/// accelerator and on the torus it is 256 x 256.
struct TrialSetup {
    std::string device, scene, kernel_dir;  // device: see choose_device(); empty: built-in scene, kernels
    bool strict = false;                    // read the scene file in strict mode
    ImageSize size{};
    std::uint32_t pes = 256;  // number of PEs of the ring
};

/// Request to the child process of a trial.
struct TrialRequest {
    TrialSetup render;
    Workload workload;
    std::vector<TunedValues> candidates;  // the best so far, then the candidate to compare with it
    std::uint32_t samples = 5;            // of each candidate; the candidates alternate
    bool stop_early = true;               // stop if the last candidate is much slower than the first
};
Json to_json(const TrialRequest& request);

/// Result of a trial. The names are those of the T4 format (t4_text() in tune.hpp).
enum class TrialStatus {
    kCorrect,
    kCompile,      // building the kernels failed or crashed
    kRuntime,      // rendering failed or crashed
    kCorrectness,  // the image or the number of rays differs from the defaults'
    kTimeout,      // a candidate exceeded its time limit
    kUnfinished    // no result: the time limit of the search ended the trial
};

struct Trial {
    TunedValues values;  // of the last candidate
    TrialStatus status = TrialStatus::kUnfinished;
    std::string error;                         // one line of text; empty for kCorrect
    std::string check;                         // image hash and number of rays of the last candidate
    double build_s = 0;                        // of the last candidate
    double wall_s = 0;                         // run time of the whole process
    std::vector<std::vector<double>> samples;  // [candidate][sample]: seconds per image
    std::string when;                          // time of the trial's end: "2026-11-22T23:59:59Z"
};

/// Returns the time of the last candidate over that of the first: the ratio of the minimum times or the median ratio of
/// consecutive samples, whichever is larger, so that a faster candidate must be faster by both. 1 without samples.
double ratio_of(const Trial& trial);

/// Returns true if the last candidate is significantly faster than the first: ratio_of() is at most kMaxWinRatio, and
/// the last candidate is faster in at least 8 of 9 pairs of samples. For equally fast candidates, a result of 8 of 9
/// pairs has a probability of 2 %.
bool wins_significantly(const Trial& trial);

/// Returns the median of seconds[i] / reference[i], the ratios of two candidates' samples; for reports.
double median_ratio(const std::vector<double>& seconds, const std::vector<double>& reference);

/// Returns the mean of the seconds that `seconds` returns, over as many calls as take 20 ms, so that the clock's
/// resolution and the overhead of launches do not matter.
double mean_seconds(const std::function<double()>& seconds);

/// Task of the child process (host/base/child_process.hpp). run_trial() writes one JSON object per line to the file
/// descriptor `lines`:
///
///     {"built": N}                                       the renderer of candidate N is built
///     {"check": TEXT, "build_s": S}                      it has rendered once
///     {"samples": [[S, ...], ...]}                       of each candidate; the trial is done
///     {"error": TEXT, "kind": "user" or "device" or "internal"}      the last line
///
/// Instead of writing "error", run_trial() throws.
inline constexpr const char* kTrialTask = "tune";
void run_trial(int lines, const Json& request);

}  // namespace raya
