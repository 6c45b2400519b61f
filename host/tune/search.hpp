// What is searched, knobs and the values that each may have, and the search for the quickest candidate, among more than
// there is time to try; it knows nothing of what it measures.
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/cl/tuned.hpp"

namespace raya {

/// A knob and the values that are tried, in an order in which neighbours are alike: `lanes` 1, 4, 8, 16.
struct Knob {
    std::uint32_t TunedValues::*value = nullptr;
    std::vector<std::uint32_t> values;

    const char* name() const;  // of kTunedNames
};

/// A candidate that takes this part of the best one's time is better; less is noise.
inline constexpr double kLeastWin = 0.98;

/// Of each knob the place of its value.
using Candidate = std::vector<std::size_t>;

struct Space {
    std::vector<Knob> knobs;
    TunedValues defaults;
    Candidate start;  // the defaults

    std::size_t size() const;
    TunedValues values_of(const Candidate& candidate) const;
};

/// Calls `visit` with every candidate.
void for_each_candidate(const Space& space, const std::function<void(const Candidate&)>& visit);

/// What can be tuned of these kernels on this device: lanes; work-items of a group, few on a CPU, where lanes do the
/// work, and one on torus nodes, whose packets so keep their order, elsewhere up to what the device takes; words in
/// local memory or where they lie, where rays meet all of them; the batch of spheres, where fp32 tests them all; trees
/// and beams, with a grid; how packets come over links, on the torus; registers, where the compiler can be told. What
/// changes the modelled machine's counts (the tree's width, the queues of torus nodes) is no knob: a report's modelled
/// figures would follow from what a device was tuned to.
Space space_of(const DeviceInfo& device, const TunedFor& what);

/// "lanes 16, group 1 -> 2, batch own": the knobs of a space, with what changes.
std::string change_text(const Space& space, const TunedValues& from, const TunedValues& to);

/// A candidate's time over that of the best so far, measured side by side; empty: it is dropped.
using Judge = std::function<std::optional<double>(const Candidate& best, const Candidate& candidate)>;

/// Told before each candidate: whether to end the search.
using SearchEnd = std::function<bool()>;

struct SearchResult {
    Candidate best;
    double cost = 1;        // its time over that of the start, the product of what was judged
    std::size_t tried = 0;  // candidates beside the start
    bool ended = true;      // by itself, with nothing promising left; false: by its end
};

/// From the start, one knob after another: its values upwards and then downwards, until they are far slower than the
/// best, and once more until no knob gains. Then what has not been tried, most promising first: the least time that was
/// seen with each of its values, as if each added its loss to the best; until that says that nothing is near; then
/// steps of two knobs at once. Every candidate is judged once at most.
SearchResult search(const Space& space, const Judge& judge, const SearchEnd& end);

/// Every candidate but `from` is judged against the best so far, which `from` is first: what a search is held against.
SearchResult search_all(const Space& space, const Candidate& from, const Judge& judge, const SearchEnd& end);

}  // namespace raya
