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

/// A kind of render to tune: a variant and a number format. Variants: "none", "grid" and "bvh" (ring machine with that
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

/// Device, scene and image size of trials. The default scene has 30 spheres and a plane; for a variant with an
/// accelerator it is "balls" of the Standard Procedural Databases, with 7,381 spheres. The default image has 512 x 512
/// pixels; for a variant with an accelerator and for the torus it has 256 x 256.
struct TrialSetup {
    std::string device;             // selector for choose_device()
    std::string scene, kernel_dir;  // paths; empty: the default scene, the embedded kernels
    bool strict = false;            // read the scene file in strict mode
    ImageSize size{};               // 0 x 0: the default size
    std::uint32_t pes = 256;        // number of PEs of the ring
};

/// Request to the child process of a trial.
struct TrialRequest {
    TrialSetup render;
    Workload workload;
    std::vector<TunedValues> candidates;  // the best so far, then the candidate to compare with it
    std::uint32_t samples = 5;            // number of samples of each candidate; the candidates alternate
    bool stop_early = true;               // stop if the last candidate is much slower than the first
};
Json to_json(const TrialRequest& request);

/// Result of a trial. All names except kUnfinished are those of the T4 format (t4_text() in tune.hpp).
enum class TrialStatus {
    kCorrect,
    kCompile,      // building the kernels failed or crashed
    kRuntime,      // rendering failed or crashed
    kCorrectness,  // the image or the number of rays differs from that with the default values
    kTimeout,      // a candidate exceeded its time limit
    kUnfinished    // no result: the time limit of the search ended the trial
};

struct Trial {
    TunedValues values;  // the last candidate's values
    TrialStatus status = TrialStatus::kUnfinished;
    std::string error;                         // one line of text; empty for kCorrect
    std::string check;                         // image hash and number of rays of the last candidate, for comparison
    double build_s = 0;                        // build time of the last candidate's kernels
    double wall_s = 0;                         // run time of the child process
    std::vector<std::vector<double>> samples;  // [candidate][sample]: seconds per image
    std::string ended_at;                      // time of the trial's end: "2026-11-22T23:59:59Z"
};

/// Returns the time of the last candidate divided by the time of the first; 1 if there are no samples. The result is
/// the larger of two ratios: the ratio of the minimum times, and the median ratio of consecutive samples. A candidate
/// is therefore faster only if both ratios are below 1.
double ratio_of(const Trial& trial);

/// Returns true if the last candidate is significantly faster than the first: ratio_of() is at most kMaxWinRatio, and
/// the last candidate is faster in at least 8 of 9 pairs of samples. For two equally fast candidates, the probability
/// of such a result is only 2 %.
bool wins_significantly(const Trial& trial);

/// Returns the median of seconds[i] / reference[i], the ratios of the samples of two candidates; 1 without samples.
double median_ratio(const std::vector<double>& seconds, const std::vector<double>& reference);

/// Calls `render`, which returns its duration in seconds, until the durations add up to at least 20 ms, so that the
/// clock's resolution does not matter. Returns the mean duration.
double mean_seconds(const std::function<double()>& render);

/// Name and function of the child process's task (host/base/child_process.hpp). run_trial() writes one JSON object per
/// line to the file descriptor `lines`:
///
///     {"built": N}                                       the kernels of candidate N are built
///     {"check": TEXT, "build_s": S}                      candidate N has rendered its first image
///     {"samples": [[S, ...], ...]}                       seconds per image of each candidate; the trial is done
///     {"error": TEXT, "kind": "user" or "device" or "internal"}      an exception ends the process; the last line
///
/// run_trial() throws the exception; its caller writes "error".
inline constexpr const char* kTrialTask = "tune";
void run_trial(int lines, const Json& request);

}  // namespace raya
