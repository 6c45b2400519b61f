#include "host/tune/search.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>

namespace raya {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kSteep = 1.25;  // of the best's time: further values of the knob will hardly be better
constexpr double kNear = 1.12;   // of the best's time: what values do to each other may be worth as much
constexpr double kFar = 1.5;     // likewise, of two neighbouring values

class Descent {
  public:
    Descent(const Space& space, const Judge& judge, const SearchEnd& end)
        : space_(space), judge_(judge), end_(end), order_(space.knobs.size()), result_{.best = space.start} {
        costs_[space.start] = 1;
        std::iota(order_.begin(), order_.end(), std::size_t{0});
        std::stable_sort(order_.begin(), order_.end(), [&space](std::size_t a, std::size_t b) {
            return space.knobs[a].values.size() < space.knobs[b].values.size();
        });
    }

    SearchResult run() {
        pass();
        while (result_.ended) {
            Candidate next = most_promising();
            if (next.empty()) next = best_step_of_two();
            if (next.empty()) break;
            if (try_one(next)) pass();
        }
        return result_;
    }

  private:
    // Whether it is better than the best so far, which it then is.
    bool try_one(const Candidate& candidate) {
        if (costs_.contains(candidate)) return false;
        if (end_()) {
            result_.ended = false;
            return false;
        }
        const std::optional<double> ratio = judge_(result_.best, candidate);
        ++result_.tried;
        const double cost = ratio ? *ratio * result_.cost : kNever;
        costs_[candidate] = cost;
        if (!ratio || *ratio > kLeastWin) return false;
        result_.best = candidate;
        result_.cost = cost;
        return true;
    }

    // Knob after knob, until none gains. Those with the fewest values first: where time ends the search, most knobs
    // have been moved by then.
    void pass() {
        for (bool gained = true; gained && result_.ended;) {
            gained = false;
            for (const std::size_t knob : order_) gained |= walk(knob);
        }
    }

    // Upwards from the best one's value, and downwards if that was of no use.
    bool walk(std::size_t knob) {
        const Candidate from = result_.best;
        return walk_from(from, knob, +1) || walk_from(from, knob, -1);
    }

    bool walk_from(Candidate candidate, std::size_t knob, int direction) {
        bool gained = false;
        const std::size_t count = space_.knobs[knob].values.size();
        for (std::size_t& place = candidate[knob]; result_.ended;) {
            place += static_cast<std::size_t>(direction);  // below 0 it is a large number
            if (place >= count) break;
            gained |= try_one(candidate);
            if (!result_.ended || costs_[candidate] > kSteep * result_.cost) break;
        }
        return gained;
    }

    // Of each value of each knob the least time that was seen with it.
    std::vector<std::vector<double>> least_costs() const {
        std::vector<std::vector<double>> least;
        for (const Knob& knob : space_.knobs) least.emplace_back(knob.values.size(), kNever);
        for (const auto& [candidate, cost] : costs_)
            for (std::size_t k = 0; k < candidate.size(); ++k)
                least[k][candidate[k]] = std::min(least[k][candidate[k]], cost);
        return least;
    }

    // Of candidates that have not been tried, the one from which least is expected: that each of its values adds what
    // the best candidate with it has lost.
    class Hope {
      public:
        Hope(const Descent& search, double near)
            : search_(search), least_(search.least_costs()), lowest_(near * search.result_.cost) {}

        void look_at(const Candidate& candidate) {
            const double best = search_.result_.cost;
            double expected = best;
            for (std::size_t k = 0; k < candidate.size(); ++k) expected *= least_[k][candidate[k]] / best;
            if (expected >= lowest_ || search_.costs_.contains(candidate)) return;
            lowest_ = expected;
            found_ = candidate;
        }
        const Candidate& found() const { return found_; }

      private:
        const Descent& search_;
        std::vector<std::vector<double>> least_;
        double lowest_;
        Candidate found_;  // empty where none is near
    };

    Candidate most_promising() const {
        Hope hope(*this, kNear);
        for_each_candidate(space_, [&](const Candidate& candidate) { hope.look_at(candidate); });
        return hope.found();
    }

    // Where knobs share what a device has, such as registers, one gains only as the other gives way.
    Candidate best_step_of_two() const {
        Hope hope(*this, kFar);
        for (std::size_t a = 0; a < space_.knobs.size(); ++a)
            for (std::size_t b = 0; b < a; ++b)
                for (const int corner : {0, 1, 2, 3}) {
                    Candidate candidate = result_.best;
                    candidate[a] += corner & 1 ? 1 : -1;  // below 0 it is a large number
                    candidate[b] += corner & 2 ? 1 : -1;
                    if (candidate[a] < space_.knobs[a].values.size() && candidate[b] < space_.knobs[b].values.size())
                        hope.look_at(candidate);
                }
        return hope.found();
    }

    const Space& space_;
    const Judge& judge_;
    const SearchEnd& end_;
    std::vector<std::size_t> order_;  // of the knobs
    SearchResult result_;
    std::map<Candidate, double> costs_;  // over the start's; of what was dropped kNever
};

}  // namespace

SearchResult search(const Space& space, const Judge& judge, const SearchEnd& end) {
    return Descent(space, judge, end).run();
}

SearchResult search_all(const Space& space, const Candidate& from, const Judge& judge, const SearchEnd& end) {
    SearchResult result{.best = from};
    for_each_candidate(space, [&](const Candidate& candidate) {
        if (candidate == from || !result.ended) return;
        if (end()) {
            result.ended = false;
            return;
        }
        const std::optional<double> ratio = judge(result.best, candidate);
        ++result.tried;
        if (!ratio || *ratio > kLeastWin) return;
        result.best = candidate;
        result.cost *= *ratio;
    });
    return result;
}

}  // namespace raya
