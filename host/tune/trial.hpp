// A trial: renders a few candidates side by side in a child process.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "host/base/json.hpp"
#include "host/cl/tuned.hpp"
#include "host/model/mapping_rule.hpp"
#include "host/model/number_format.hpp"

namespace raya {

/// A variant in a number format. Variants: none, grid, bvh (ring machine with that accelerator), torus (4 x 4 x 4
/// nodes).
struct Workload {
    std::string variant;
    NumberFormat format{};

    TunedFor what() const;     // throws UserError for an unknown variant
    std::string name() const;  // "ring none fp32", "torus fp32"
};

/// The ring without accelerator in fp32 and e6m15, with each accelerator in fp32, and the torus in fp32.
std::vector<Workload> default_workloads();

/// Device, scene and image size of trials. Without a scene file: 30 spheres and a plane, or with an accelerator SPD's
/// balls of 7,381 spheres. Without a size: 512 pixels a side, with an accelerator and on the torus 256.
struct TrialSetup {
    std::string device, scene, kernel_dir;  // see choose_device(); empty: built-in scene, built-in kernels
    bool strict = false;                    // read the scene strictly
    ImageSize size{};
    std::uint32_t pes = 256;  // on the ring
};

/// Task of a trial's process.
struct TrialRequest {
    TrialSetup render;
    Workload workload;
    std::vector<TunedValues> candidates;  // the best so far, and the one to compare with it
    std::uint32_t samples = 5;            // of each candidate, in turn
    bool stop_early = true;               // stop when the last candidate is far slower than the first
};
Json to_json(const TrialRequest& request);

/// Result of a trial. The names are those of the T4 format (t4_text() in tune.hpp).
enum class TrialStatus {
    kCorrect,
    kCompile,      // building the kernels failed or crashed
    kRuntime,      // rendering failed or crashed
    kCorrectness,  // another image, or another number of rays
    kTimeout,      // exceeded the time limit of a candidate
    kUnfinished    // stopped at the time limit of the search: no result
};

struct Trial {
    TunedValues values;  // of the last candidate
    TrialStatus status = TrialStatus::kUnfinished;
    std::string error;                         // one line; empty for kCorrect
    std::string check;                         // hash and number of rays of the last candidate
    double build_s = 0;                        // of the last candidate
    double wall_s = 0;                         // of the whole process
    std::vector<std::vector<double>> samples;  // [candidate][sample]: seconds for one image
    std::string when;                          // end of the trial: "2026-11-22T23:59:59Z"
};

/// Time of the last candidate over that of the first: the larger of the ratio of minimum times and the median ratio of
/// consecutive samples, so that a win needs both. 1 without samples.
double ratio_of(const Trial& trial);

/// Returns true if the last candidate is significantly faster than the first: ratio_of() is at most kMaxWinRatio, and
/// it wins at least 8 of 9 pairs of samples, which has a probability of 2 % for equal candidates.
bool wins_significantly(const Trial& trial);

/// Median ratio of two candidates' samples, for reports.
double median_ratio(const std::vector<double>& of, const std::vector<double>& over);

/// Mean seconds of one call, over enough calls for 20 ms, so that the clock and launches do not matter.
double mean_seconds(const std::function<double()>& seconds);

/// Task of a trial's process (host/base/child_process.hpp). run_trial() writes to the file descriptor `lines`, one JSON
/// object per line:
///
///     {"built": N}                                       the renderer of candidate N is built
///     {"check": TEXT, "build_s": S}                      it has rendered once
///     {"samples": [[S, ...], ...]}                       of each candidate; the trial is done
///     {"error": TEXT, "kind": "user" or "device" or "internal"}      the last line
///
/// except "error": it throws instead.
inline constexpr const char* kTrialTask = "tune";
void run_trial(int lines, const Json& request);

}  // namespace raya
