// A trial: a few candidates that are rendered side by side in a process of their own, and what came of it.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "host/base/json.hpp"
#include "host/cl/tuned.hpp"
#include "host/model/mapping_rule.hpp"
#include "host/model/number_format.hpp"

namespace raya {

/// A variant of rendering (none, grid, bvh: the ring machine with that accelerator; torus: 4 x 4 x 4 nodes) in a
/// format.
struct Workload {
    std::string variant;
    NumberFormat format{};

    TunedFor what() const;     // UserError for a variant that there is not
    std::string name() const;  // "ring none fp32", "torus fp32"
};

/// What is tuned where nothing else is asked for: the ring without accelerator in fp32 and e6m15, with either
/// accelerator in fp32, and the torus in fp32.
std::vector<Workload> usual_workloads();

/// What a workload renders, and on which device: `scene`, a file, where a user brings one; else 30 spheres and a plane
/// for variants that test all objects, and SPD's balls of 7,381 spheres for those that do not. No size: 512 pixels a
/// side, with an accelerator and on the torus 256.
struct TrialRenders {
    std::string device, scene, kernel_dir;  // see choose_device(); empty: own scene, own kernels
    bool strict = false;                    // of the scene
    ImageSize size{};
    std::uint32_t pes = 256;  // of the ring
};

/// What the process is to do.
struct TrialOrder {
    TrialRenders render;
    Workload workload;
    std::vector<TunedValues> candidates;  // the best so far, and what is held against it
    std::uint32_t samples = 5;            // of each, in turn
    bool stop_early = true;               // once the last one is far slower than the first
};
Json to_json(const TrialOrder& order);

/// How it ended. The names are those of the T4 format (t4_text() in tune.hpp).
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

/// Mean seconds of one call, of as many as take 20 ms together: what lasts less, clock and launch would count in.
double mean_seconds(const std::function<double()>& seconds);

/// The task of a trial's process (host/base/own_process.hpp), and what it does: writes to the file `lines`, a JSON
/// object a line
///
///     {"built": N}                                       candidate N can render
///     {"check": TEXT, "build_s": S}                      and has rendered once
///     {"samples": [[S, ...], ...]}                       of each candidate; that was all
///     {"error": TEXT, "kind": "user" or "device" or "internal"}      nothing more comes
///
/// but for the last: what goes wrong is thrown.
inline constexpr const char* kTrialTask = "tune";
void run_trial(int lines, const Json& order);

}  // namespace raya
