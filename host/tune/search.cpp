#include "host/tune/search.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>

namespace raya {
namespace {

using Values = std::vector<std::uint32_t>;

// Powers of two from `least` on.
Values group_sizes(std::uint32_t least, std::uint32_t most) {
    Values all;
    for (std::uint32_t size = least; size <= most; size *= 2) all.push_back(size);
    if (all.empty()) all.push_back(most);
    return all;
}

constexpr auto kByCopies = static_cast<std::uint32_t>(LinkMove::kCopies);
constexpr auto kByKernel = static_cast<std::uint32_t>(LinkMove::kKernel);

// The default is one of the values, whatever the device.
void add_default(Values& values, std::uint32_t value) {
    if (std::find(values.begin(), values.end(), value) == values.end())
        values.insert(std::lower_bound(values.begin(), values.end(), value), value);
}

std::string value_text(const Knob& knob, std::uint32_t value) {
    if (knob.value == &TunedValues::local_words) return value ? "yes" : "no";
    if (knob.value == &TunedValues::link_exchange && value)
        return static_cast<LinkMove>(value) == LinkMove::kKernel ? "kernel" : "copies";
    return value ? std::to_string(value) : "own";
}

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

const char* Knob::name() const {
    return std::find_if(kTunedNames.begin(), kTunedNames.end(), [this](const auto& n) { return n.second == value; })
        ->first;
}

std::size_t Space::size() const {
    std::size_t product = 1;
    for (const Knob& knob : knobs) product *= knob.values.size();
    return product;
}

TunedValues Space::values_of(const Candidate& candidate) const {
    TunedValues values = defaults;
    for (std::size_t k = 0; k < knobs.size(); ++k) values.*knobs[k].value = knobs[k].values[candidate[k]];
    return values;
}

void for_each_candidate(const Space& space, const std::function<void(const Candidate&)>& visit) {
    Candidate candidate(space.knobs.size(), 0);
    for (;;) {
        visit(candidate);
        std::size_t k = 0;
        while (k < candidate.size() && ++candidate[k] == space.knobs[k].values.size()) candidate[k++] = 0;
        if (k == candidate.size()) return;
    }
}

Space space_of(const DeviceInfo& device, const TunedFor& what) {
    Space space{.knobs = {}, .defaults = default_values(device, what), .start = {}};
    const bool cpu = device.type == "cpu", all_objects = what.accel == RAYA_ACCEL_NONE;
    const auto add = [&](std::uint32_t TunedValues::*value, Values values) {
        add_default(values, space.defaults.*value);
        const auto at = std::find(values.begin(), values.end(), space.defaults.*value);
        space.start.push_back(static_cast<std::size_t>(at - values.begin()));
        space.knobs.push_back({value, std::move(values)});
    };
    const std::uint32_t most = most_group_size(device);
    const bool llvmpipe = device.loop_turns > 0;  // vectors of work-items; minutes and gigabytes for several lanes
    add(&TunedValues::lanes, llvmpipe ? Values{1} : Values{1, 4, 8, 16});
    // A CPU's torus nodes keep their default, which keeps the order of packets (docs/packets.md).
    const std::uint32_t most_on_cpu = what.torus ? space.defaults.group : std::min(llvmpipe ? 16u : 4u, most);
    add(&TunedValues::group, cpu ? group_sizes(1, most_on_cpu) : group_sizes(16, most));
    if (takes_register_limit(device)) add(&TunedValues::registers, {0, 64, 96, 128, 168});
    if (all_objects) add(&TunedValues::local_words, {0, 1});
    if (all_objects && what.fp32 && !what.torus)
        add(&TunedValues::batch, cpu ? Values{0, 8, 16} : Values{0, 4, 8, 16, 32});
    if (what.accel == RAYA_ACCEL_GRID) {
        add(&TunedValues::trees, {0, 1, 2, 4, 8});
        add(&TunedValues::beams, {0, 1, 2, 4, 8});
    }
    // A CPU's own choice is the kernel.
    if (what.torus) add(&TunedValues::link_exchange, cpu ? Values{0, kByCopies} : Values{0, kByCopies, kByKernel});
    return space;
}

std::string change_text(const Space& space, const TunedValues& from, const TunedValues& to) {
    std::string text;
    for (const Knob& knob : space.knobs) {
        std::string name = knob.name();
        std::replace(name.begin(), name.end(), '_', ' ');
        text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, value_text(knob, from.*knob.value));
        if (from.*knob.value != to.*knob.value) text += " -> " + value_text(knob, to.*knob.value);
    }
    return text;
}

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
