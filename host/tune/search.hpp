// Search space of the tuner (knobs and their values) and the search for the fastest candidate. The search does not know
// what it measures.
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/cl/tuned.hpp"

namespace raya {

/// A tuning parameter and its values, ordered so that neighbours are similar: `lanes` 1, 4, 8, 16.
struct Knob {
    std::uint32_t TunedValues::*value = nullptr;
    std::vector<std::uint32_t> values;

    const char* name() const;  // in kTunedNames
};

/// A candidate is better if its time over that of the best so far is at most this; smaller gains may be noise.
inline constexpr double kMaxWinRatio = 0.98;

/// Index of the value of each knob.
using Candidate = std::vector<std::size_t>;

struct Space {
    std::vector<Knob> knobs;
    TunedValues defaults;
    Candidate start;  // the defaults

    std::size_t size() const;
    TunedValues values_of(const Candidate& candidate) const;
};

/// Calls `visit` for every candidate of the space.
void for_each_candidate(const Space& space, const std::function<void(const Candidate&)>& visit);

/// The knobs of these kernels on this device: lanes; work-items of a group (on a CPU few, because lanes do the work,
/// and on torus nodes one, which keeps the order of packets); job words in local or global memory, without an
/// accelerator; the batch of spheres, without an accelerator in fp32 on the ring; trees and beams, with a grid; the
/// exchange over links, on the torus; the register limit, where the compiler has one. Settings that change the modelled
/// machine's counts (the BVH's width, the queues of torus nodes) are not knobs, so that modelled figures do not depend
/// on tuning.
Space space_of(const DeviceInfo& device, const TunedFor& what);

/// Values of all knobs and changes between two candidates: "lanes 16, group 1 -> 2, batch own".
std::string change_text(const Space& space, const TunedValues& from, const TunedValues& to);

/// Measures a candidate and the best so far side by side. Returns the ratio of their times; empty: the candidate is
/// dropped.
using MeasureRatio = std::function<std::optional<double>(const Candidate& best, const Candidate& candidate)>;

/// Called before each candidate; true ends the search.
using ShouldStop = std::function<bool()>;

struct SearchResult {
    Candidate best;
    double cost = 1;        // its time over that of the start: the product of measured ratios
    std::size_t tried = 0;  // number of measured candidates, without the start
    bool ended = true;      // no promising candidate is left; false: stopped by ShouldStop
};

/// Coordinate descent from the start: tries the values of one knob after another, upwards and then downwards, until
/// they are far slower than the best; repeats until no knob gains. Then it tries other candidates in the order of
/// predicted time, where the losses of a candidate's values (each the minimum time measured with that value) multiply,
/// until no prediction is near the best, and then neighbours that differ in two knobs. Measures each candidate at most
/// once.
SearchResult search(const Space& space, const MeasureRatio& measure, const ShouldStop& stop);

/// Exhaustive search, the reference for search(): measures every candidate except `from` against the best so far, which
/// is `from` at first.
SearchResult search_all(const Space& space, const Candidate& from, const MeasureRatio& measure, const ShouldStop& stop);

}  // namespace raya
