// The search for the quickest candidate, among more than there is time to try; it knows nothing of what it measures.
#pragma once
#include <cstddef>
#include <functional>
#include <optional>

#include "host/tune/space.hpp"

namespace raya {

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
