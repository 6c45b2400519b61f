#include "host/tune/search.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>

namespace raya {
namespace {

using Values = std::vector<std::uint32_t>;

// Returns the powers of two in minimum..maximum, or `maximum` if there are none; `minimum` is a power of two.
Values group_sizes(std::uint32_t minimum, std::uint32_t maximum) {
    Values all;
    for (std::uint32_t size = minimum; size <= maximum; size *= 2) all.push_back(size);
    if (all.empty()) all.push_back(maximum);
    return all;
}

constexpr auto kByCopies = static_cast<std::uint32_t>(LinkMove::kCopies);
constexpr auto kByKernel = static_cast<std::uint32_t>(LinkMove::kKernel);

// Inserts the default value if `values` does not contain it.
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

constexpr double kDropped = std::numeric_limits<double>::infinity();
// Limits for a candidate's time divided by the best time.
constexpr double kSteep = 1.25;  // measured time: beyond it, further values of the knob are unlikely to be better
constexpr double kNear = 1.12;   // predicted time: interactions of knobs may make up for this much
constexpr double kFar = 1.5;     // predicted time of neighbours that differ in two knobs

class CoordinateDescent {
  public:
    CoordinateDescent(const Space& space, const MeasureRatio& measure, const ShouldStop& stop)
        : space_(space), measure_(measure), stop_(stop), order_(space.knobs.size()), result_{.best = space.start} {
        costs_[space.start] = 1;
        std::iota(order_.begin(), order_.end(), std::size_t{0});
        std::stable_sort(order_.begin(), order_.end(), [&space](std::size_t a, std::size_t b) {
            return space.knobs[a].values.size() < space.knobs[b].values.size();
        });
    }

    SearchResult run() {
        descend();
        while (result_.ended) {
            Candidate next = most_promising();
            if (next.empty()) next = best_step_of_two();
            if (next.empty()) break;
            if (try_one(next)) descend();
        }
        return result_;
    }

  private:
    // Measures a candidate. Returns true if it is the new best.
    bool try_one(const Candidate& candidate) {
        if (costs_.contains(candidate)) return false;
        if (stop_()) {
            result_.ended = false;
            return false;
        }
        const std::optional<double> ratio = measure_(result_.best, candidate);
        ++result_.tried;
        const double cost = ratio ? *ratio * result_.cost : kDropped;
        costs_[candidate] = cost;
        if (!ratio || *ratio > kMaxWinRatio) return false;
        result_.best = candidate;
        result_.cost = cost;
        return true;
    }

    // Varies one knob after another until no change helps. Knobs with few values come first, so that most knobs have
    // been varied if time runs out.
    void descend() {
        for (bool gained = true; gained && result_.ended;) {
            gained = false;
            for (const std::size_t knob : order_) gained |= try_values(knob);
        }
    }

    // Tries larger values than the best candidate's, and smaller ones if no larger one helps.
    bool try_values(std::size_t knob) {
        const Candidate from = result_.best;
        return try_direction(from, knob, +1) || try_direction(from, knob, -1);
    }

    bool try_direction(Candidate candidate, std::size_t knob, int direction) {
        bool gained = false;
        const std::size_t count = space_.knobs[knob].values.size();
        for (std::size_t& index = candidate[knob]; result_.ended;) {
            index += static_cast<std::size_t>(direction);  // wraps below 0
            if (index >= count) break;
            gained |= try_one(candidate);
            if (!result_.ended || costs_[candidate] > kSteep * result_.cost) break;
        }
        return gained;
    }

    // Returns [knob][value]: the minimum cost measured with that value.
    std::vector<std::vector<double>> least_costs() const {
        std::vector<std::vector<double>> least;
        for (const Knob& knob : space_.knobs) least.emplace_back(knob.values.size(), kDropped);
        for (const auto& [candidate, cost] : costs_)
            for (std::size_t k = 0; k < candidate.size(); ++k)
                least[k][candidate[k]] = std::min(least[k][candidate[k]], cost);
        return least;
    }

    // Finds the candidate with the lowest predicted cost among the untried candidates passed to offer(). The prediction
    // is the cost of the best multiplied, for each knob, by the loss of the candidate's value: the minimum cost
    // measured with this value divided by the cost of the best.
    class Prediction {
      public:
        Prediction(const CoordinateDescent& search, double near)
            : search_(search), least_(search.least_costs()), lowest_(near * search.result_.cost) {}

        void offer(const Candidate& candidate) {
            const double best = search_.result_.cost;
            double expected = best;
            for (std::size_t k = 0; k < candidate.size(); ++k) expected *= least_[k][candidate[k]] / best;
            if (expected >= lowest_ || search_.costs_.contains(candidate)) return;
            lowest_ = expected;
            found_ = candidate;
        }
        const Candidate& found() const { return found_; }

      private:
        const CoordinateDescent& search_;
        std::vector<std::vector<double>> least_;
        double lowest_;
        Candidate found_;  // empty: no prediction is near enough to the best
    };

    Candidate most_promising() const {
        Prediction prediction(*this, kNear);
        for_each_candidate(space_, [&](const Candidate& candidate) { prediction.offer(candidate); });
        return prediction.found();
    }

    // Returns the most promising neighbour that differs in two knobs. If two knobs share a resource, such as registers,
    // it may be necessary to change both.
    Candidate best_step_of_two() const {
        Prediction prediction(*this, kFar);
        for (std::size_t a = 0; a < space_.knobs.size(); ++a)
            for (std::size_t b = 0; b < a; ++b)
                for (const int corner : {0, 1, 2, 3}) {
                    Candidate candidate = result_.best;
                    candidate[a] += corner & 1 ? 1 : -1;  // wraps below 0
                    candidate[b] += corner & 2 ? 1 : -1;
                    if (candidate[a] < space_.knobs[a].values.size() && candidate[b] < space_.knobs[b].values.size())
                        prediction.offer(candidate);
                }
        return prediction.found();
    }

    const Space& space_;
    const MeasureRatio& measure_;
    const ShouldStop& stop_;
    std::vector<std::size_t> order_;  // order in which knobs are varied
    SearchResult result_;
    std::map<Candidate, double> costs_;  // time divided by that of the start, or kDropped
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
    const std::uint32_t max_group = largest_group_size(device);
    // llvmpipe vectorises over work-items. Compiling kernels with several lanes takes it minutes and gigabytes of
    // memory.
    const bool llvmpipe = device.max_loop_iterations > 0;
    add(&TunedValues::lanes, llvmpipe ? Values{1} : Values{1, 4, 8, 16});
    // Torus nodes on a CPU keep their default, which preserves the order of packets (docs/packets.md).
    const std::uint32_t max_on_cpu = what.torus ? space.defaults.group : std::min(llvmpipe ? 16u : 4u, max_group);
    add(&TunedValues::group, cpu ? group_sizes(1, max_on_cpu) : group_sizes(16, max_group));
    if (supports_register_limit(device)) add(&TunedValues::registers, {0, 64, 96, 128, 168});
    if (all_objects) add(&TunedValues::local_words, {0, 1});
    if (all_objects && what.fp32 && !what.torus)
        add(&TunedValues::batch, cpu ? Values{0, 8, 16} : Values{0, 4, 8, 16, 32});
    if (what.accel == RAYA_ACCEL_GRID) {
        add(&TunedValues::trees, {0, 1, 2, 4, 8});
        add(&TunedValues::beams, {0, 1, 2, 4, 8});
    }
    // On a CPU the default, 0, already selects the kernel.
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

SearchResult search(const Space& space, const MeasureRatio& measure, const ShouldStop& stop) {
    return CoordinateDescent(space, measure, stop).run();
}

SearchResult search_all(const Space& space, const Candidate& from, const MeasureRatio& measure,
                        const ShouldStop& stop) {
    SearchResult result{.best = from};
    for_each_candidate(space, [&](const Candidate& candidate) {
        if (candidate == from || !result.ended) return;
        if (stop()) {
            result.ended = false;
            return;
        }
        const std::optional<double> ratio = measure(result.best, candidate);
        ++result.tried;
        if (!ratio || *ratio > kMaxWinRatio) return;
        result.best = candidate;
        result.cost *= *ratio;
    });
    return result;
}

}  // namespace raya
