// Tunes a device for one workload: measures the defaults, compares every candidate (a combination of values) with the
// best so far, checks the image of each, and finally compares the best candidate with the defaults again.
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "host/base/json.hpp"
#include "host/cl/kernel_options.hpp"
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

/// The values that the search tries.
struct Space {
    TunedValues defaults;
    /// All combinations of values; those that differ from the defaults in fewer parameters come first.
    std::vector<TunedValues> candidates{};
};

/// Returns the values to try for these kernels on this device:
///   - lanes;
///   - group size: on a CPU few work-items, because lanes already use its vector instructions; for torus nodes on a
///     CPU 1, because larger groups change the order of packets;
///   - without an accelerator: the memory of the job's words (local or global);
///   - without an accelerator, on the ring in fp32: the number of spheres in a batch.
/// Settings that change counts of the modelled machine, such as the width of the BVH and the queues of torus nodes, are
/// not tuned, so that modelled figures do not depend on tuning.
Space space_of(const DeviceInfo& device, const TuningKey& key);

/// Returns a text with the old values of all parameters, and their new values where they differ: "lanes 16, group 1 ->
/// 2, local words yes, batch default". Value 0 is printed as "default": the kernels choose the value.
std::string change_text(const TunedValues& old_values, const TunedValues& new_values);

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

/// Name and function of the task of a trial's process (host/base/child_process.hpp), which renders a few candidates
/// alternately. It writes one JSON object per line to the file descriptor `lines`:
///
///     {"built": N}                          the kernels of N candidates are built
///     {"check": TEXT}                       the last candidate has rendered its first image
///     {"samples": [[S, ...], ...]}          seconds per image of each candidate; the trial is done
///     {"error": TEXT, "kind": "user" or "device" or "internal"}      an exception ends the process; the last line
///
/// run_trial() throws the exception; its caller writes "error".
inline constexpr const char* kTrialTask = "tune";
void run_trial(int lines, const Json& request);

/// A trial: the last candidate compared with the first.
struct Trial {
    TunedValues values;                        // of the last candidate
    std::string error;                         // why the last candidate is dropped; empty: its image is right
    std::string check;                         // image hash and number of rays of the last candidate, for comparison
    std::vector<std::vector<double>> samples;  // [candidate][sample]: seconds per image
};

/// Returns the time of the last candidate divided by the time of the first; 1 if there are no samples. The result is
/// the larger of two ratios: the ratio of the minimum times, and the median ratio of consecutive samples. A candidate
/// is therefore faster only if both ratios are below 1.
double ratio_of(const Trial& trial);

/// Returns true if the last candidate is right and significantly faster than the first: ratio_of() is at most 0.98, and
/// the last candidate is faster in at least 8 of 9 pairs of samples. For two equally fast candidates, the probability
/// of such a result is only 2 %.
bool wins_significantly(const Trial& trial);

/// Calls `render`, which returns its duration in seconds, until the durations add up to at least 20 ms, so that the
/// clock's resolution does not matter. Returns the mean duration.
double mean_seconds(const std::function<double()>& render);

struct TuneSettings {
    TrialSetup render;    // device, scene and size of all trials
    double seconds = 60;  // time limit of the search in seconds
};

/// Called about five times a second while a trial runs, with the candidate's values and the trial's run time in
/// seconds.
using TrialProgress = std::function<void(const TunedValues& values, double seconds)>;

/// Result of tuning a workload.
struct Tuning {
    Workload workload;
    Space space;
    TunedValues best;
    double ratio = 1;            // time of `best` divided by the time of the defaults, from the final comparison
    bool complete = true;        // false: the time limit ended the search
    std::size_t tried = 0;       // number of measured candidates
    std::vector<Trial> dropped;  // candidates that failed, rendered a wrong image, or exceeded their time limit
    double seconds = 0;          // duration of the search, including builds
};

/// Tunes `workload`. A candidate is better than the best so far if ratio_of() is at most 0.98: smaller gains may be
/// noise. A trial of a slow candidate ends early. `best` has the default values unless the best candidate is
/// significantly faster than the defaults (wins_significantly()). Throws DeviceError if the render with the defaults
/// fails.
Tuning tune(const DeviceInfo& device, const Workload& workload, const TuneSettings& settings,
            const TrialProgress& progress);

}  // namespace raya
