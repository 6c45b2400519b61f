// Search space of the tuner (parameters and their values), and the search for the fastest candidate. The search does
// not depend on the quantity that the callback measures.
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/cl/tuned.hpp"

namespace raya {

/// A tuning parameter and its possible values, ordered so that adjacent values behave similarly: `lanes` 1, 4, 8, 16.
struct TuningParameter {
    std::uint32_t TunedValues::*value = nullptr;
    std::vector<std::uint32_t> values;

    const char* name() const;  // from kTunedNames
};

/// A candidate is better than the best so far if the ratio of its time to the best's is at most this. Smaller gains may
/// be noise.
inline constexpr double kMaxWinRatio = 0.98;

/// One choice of values: [parameter], index into TuningParameter::values.
using Candidate = std::vector<std::size_t>;

struct Space {
    std::vector<TuningParameter> parameters;
    TunedValues defaults;
    Candidate start;  // the candidate with the default values

    std::size_t size() const;
    TunedValues values_of(const Candidate& candidate) const;
};

/// Calls `visit` for every candidate of the space.
void for_each_candidate(const Space& space, const std::function<void(const Candidate&)>& visit);

/// Returns the tuning parameters of these kernels on this device:
///   - lanes;
///   - group size: on a CPU few work-items, because lanes vectorise; for torus nodes on a CPU one, which preserves the
///     order of packets;
///   - job words in local or global memory, without an accelerator;
///   - the batch of spheres, without an accelerator in fp32 on the ring;
///   - trees and beams, with a grid;
///   - the exchange over links, on the torus;
///   - the register limit, if the compiler has such an option.
/// Settings that change counts of the modelled machine, such as the width of the BVH and the queues of torus nodes, are
/// not tuning parameters, so that modelled figures do not depend on tuning.
Space space_of(const DeviceInfo& device, const TuningKey& key);

/// Returns the values of all parameters, and the changes between two candidates: "lanes 16, group 1 -> 2, batch own".
std::string change_text(const Space& space, const TunedValues& from, const TunedValues& to);

/// Measures a candidate and the best so far alternately. Returns the candidate's time divided by the best's, or nullopt
/// if the candidate fails and is dropped.
using MeasureRatio = std::function<std::optional<double>(const Candidate& best, const Candidate& candidate)>;

/// Called before each candidate. Returns true to end the search.
using ShouldStop = std::function<bool()>;

struct SearchResult {
    Candidate best;
    double cost = 1;        // time of `best` over that of the start: product of the measured ratios
    std::size_t tried = 0;  // number of candidates measured, without the start
    bool ended = true;      // true: no promising candidate is left; false: stopped by ShouldStop
};

/// Searches in three phases, and measures each candidate at most once. After a new best in phase 2 or 3 the search
/// returns to phase 1.
///   - Coordinate descent from the start: varies one parameter at a time from the best so far, to larger values or, if
///     none of them helps, to smaller ones, until the time is much worse; repeats until no change of one parameter
///     helps.
///   - Tries the remaining candidates in the order of predicted time, while the prediction is near the best time. The
///     predicted time is the best time multiplied by the loss of each value, which is the minimum time measured with
///     that value over the best time.
///   - Tries neighbours of the best that differ in two parameters.
SearchResult search(const Space& space, const MeasureRatio& measure, const ShouldStop& stop);

/// Exhaustive search, the reference for search(): compares every candidate with the best so far, starting from `from`.
SearchResult search_all(const Space& space, const Candidate& from, const MeasureRatio& measure, const ShouldStop& stop);

}  // namespace raya
