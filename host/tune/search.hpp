// Search space of the tuner (parameters and their values), and the search for the fastest candidate. A callback
// measures the candidates; the search works for any measured quantity.
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/cl/tuned.hpp"

namespace raya {

/// A tuning parameter and its possible values, ordered so that adjacent values behave similarly. Example: `lanes` with
/// 1, 4, 8, 16.
struct TuningParameter {
    std::uint32_t TunedValues::*value = nullptr;  // the member that holds the parameter's value
    std::vector<std::uint32_t> values;

    const char* name() const;  // name in kTunedNames
};

/// A candidate is better than the best so far if its time divided by the best candidate's time is at most this ratio.
/// Smaller gains may be noise.
inline constexpr double kMaxWinRatio = 0.98;

/// A combination of values: [parameter]: index into TuningParameter::values.
using Candidate = std::vector<std::size_t>;

/// The search space: all candidates.
struct Space {
    std::vector<TuningParameter> parameters;
    TunedValues defaults;
    Candidate start;  // the candidate with the default values

    std::size_t size() const;  // number of candidates
    TunedValues values_of(const Candidate& candidate) const;
};

void for_each_candidate(const Space& space, const std::function<void(const Candidate&)>& visit);

/// Returns the tuning parameters of these kernels on this device:
///   - lanes;
///   - group size: on a CPU few work-items, because lanes already use its vector instructions; for torus nodes on a
///     CPU 1, because larger groups change the order of packets;
///   - without an accelerator: the memory of the job's words (local or global);
///   - without an accelerator, on the ring in fp32: the number of spheres in a batch;
///   - with a grid: the numbers of ray trees and beams that a work-item traces concurrently;
///   - on the torus: the link exchange (buffer copies or kernel);
///   - the register limit, if the compiler has such an option.
/// Settings that change counts of the modelled machine, such as the width of the BVH and the queues of torus nodes, are
/// not tuning parameters, so that modelled figures do not depend on tuning.
Space space_of(const DeviceInfo& device, const TuningKey& key);

/// Returns a text with the old values of all parameters, and their new values where they differ:
/// "lanes 16, group 1 -> 2, batch default". Value 0 is printed as "default": the kernels choose the value.
std::string change_text(const Space& space, const TunedValues& old_values, const TunedValues& new_values);

/// Measures a candidate and the best so far alternately. Returns the candidate's time divided by that of the best, or
/// nullopt if the candidate fails and is dropped.
using MeasureRatio = std::function<std::optional<double>(const Candidate& best, const Candidate& candidate)>;

/// Called before each candidate. Returns true to end the search.
using ShouldStop = std::function<bool()>;

struct SearchResult {
    Candidate best;
    double cost = 1;        // time of `best` divided by the time of `Space::start`: product of the measured ratios
    std::size_t tried = 0;  // number of measured candidates, without the start
    bool complete = true;   // true: no promising candidate is left; false: stopped by ShouldStop
};

/// Searches in three phases, and measures each candidate at most once. If phase 2 or 3 finds a new best candidate, the
/// search returns to phase 1.
///   1. Coordinate descent from the start. Varies one parameter of the best candidate at a time, until the time is much
///      worse: first to larger values, then, if no larger value helps, to smaller ones. Repeats until no change of one
///      parameter helps.
///   2. Tries the remaining candidates in the order of predicted time, as long as the prediction is near the best time.
///      The predicted time is the best time multiplied by the loss of each of the candidate's values. The loss of a
///      value is the minimum time measured with the value divided by the best time.
///   3. Tries the neighbours of the best candidate that differ from it in two parameters.
SearchResult search(const Space& space, const MeasureRatio& measure, const ShouldStop& stop);

/// Exhaustive search, for comparison with search(): compares every candidate with the best so far, at first `start`.
SearchResult search_all(const Space& space, const Candidate& start, const MeasureRatio& measure,
                        const ShouldStop& stop);

}  // namespace raya
