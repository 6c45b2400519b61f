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
    Values sizes;
    for (std::uint32_t size = minimum; size <= maximum; size *= 2) sizes.push_back(size);
    if (sizes.empty()) sizes.push_back(maximum);
    return sizes;
}

constexpr auto kCopyExchange = static_cast<std::uint32_t>(LinkMove::kCopies);
constexpr auto kKernelExchange = static_cast<std::uint32_t>(LinkMove::kKernel);

// Inserts the default value if `values` does not contain it.
void add_default(Values& values, std::uint32_t value) {
    if (std::find(values.begin(), values.end(), value) == values.end())
        values.insert(std::lower_bound(values.begin(), values.end(), value), value);
}

std::string value_text(const TuningParameter& parameter, std::uint32_t value) {
    if (parameter.value == &TunedValues::local_words) return value ? "yes" : "no";
    if (parameter.value == &TunedValues::link_exchange && value)
        return static_cast<LinkMove>(value) == LinkMove::kKernel ? "kernel" : "copies";
    return value ? std::to_string(value) : "default";
}

constexpr double kDroppedCost = std::numeric_limits<double>::infinity();  // cost of a candidate that failed

// Limits for a candidate's time divided by the best time. Phases 1, 2 and 3 are those of search() in search.hpp.
constexpr double kStopRatio = 1.25;  // above this measured ratio, phase 1 tries no further values in that direction
constexpr double kMaxPredictedRatio = 1.12;  // phase 2 tries candidates with a predicted ratio below this limit
constexpr double kMaxPairRatio = 1.5;        // phase 3 tries neighbours with a predicted ratio below this limit

class CoordinateDescent {
  public:
    CoordinateDescent(const Space& space, const MeasureRatio& measure, const ShouldStop& stop)
        : space_(space),
          measure_(measure),
          stop_(stop),
          parameter_order_(space.parameters.size()),
          result_{.best = space.start} {
        costs_[space.start] = 1;
        std::iota(parameter_order_.begin(), parameter_order_.end(), std::size_t{0});
        std::stable_sort(parameter_order_.begin(), parameter_order_.end(), [&space](std::size_t a, std::size_t b) {
            return space.parameters[a].values.size() < space.parameters[b].values.size();
        });
    }

    SearchResult run() {
        descend();
        while (result_.complete) {
            Candidate next = most_promising_candidate();
            if (next.empty()) next = most_promising_neighbour();
            if (next.empty()) break;
            if (try_candidate(next)) descend();
        }
        return result_;
    }

  private:
    // Measures a candidate. Returns true if it is the new best.
    bool try_candidate(const Candidate& candidate) {
        if (costs_.contains(candidate)) return false;
        if (stop_()) {
            result_.complete = false;
            return false;
        }
        const std::optional<double> ratio = measure_(result_.best, candidate);
        ++result_.tried;
        const double cost = ratio ? *ratio * result_.cost : kDroppedCost;
        costs_[candidate] = cost;
        if (!ratio || *ratio > kMaxWinRatio) return false;
        result_.best = candidate;
        result_.cost = cost;
        return true;
    }

    // Varies one parameter after another until no change helps. Begins with the parameters that have the fewest values,
    // so that the search has varied as many parameters as possible if its time ends.
    void descend() {
        for (bool improved = true; improved && result_.complete;) {
            improved = false;
            for (const std::size_t parameter : parameter_order_) improved |= try_values(parameter);
        }
    }

    // Tries values of the parameter larger than the best candidate's; if none of them helps, tries smaller values.
    // Returns true if a value helps.
    bool try_values(std::size_t parameter) {
        const Candidate start = result_.best;
        return try_direction(start, parameter, +1) || try_direction(start, parameter, -1);
    }

    bool try_direction(Candidate candidate, std::size_t parameter, int direction) {
        bool improved = false;
        const std::size_t count = space_.parameters[parameter].values.size();
        for (std::size_t& index = candidate[parameter]; result_.complete;) {
            index += static_cast<std::size_t>(direction);  // wraps below 0
            if (index >= count) break;
            improved |= try_candidate(candidate);
            if (!result_.complete || costs_[candidate] > kStopRatio * result_.cost) break;
        }
        return improved;
    }

    // Returns [parameter][value]: the minimum cost measured with that value.
    std::vector<std::vector<double>> minimum_costs() const {
        std::vector<std::vector<double>> costs;
        for (const TuningParameter& parameter : space_.parameters)
            costs.emplace_back(parameter.values.size(), kDroppedCost);
        for (const auto& [candidate, cost] : costs_)
            for (std::size_t k = 0; k < candidate.size(); ++k)
                costs[k][candidate[k]] = std::min(costs[k][candidate[k]], cost);
        return costs;
    }

    // Finds the candidate with the lowest predicted cost among the untried candidates passed to offer(). The prediction
    // is that of phase 2 of search().
    class LowestPrediction {
      public:
        LowestPrediction(const CoordinateDescent& search, double max_ratio)
            : search_(search), minimum_costs_(search.minimum_costs()), lowest_cost_(max_ratio * search.result_.cost) {}

        void offer(const Candidate& candidate) {
            const double best = search_.result_.cost;
            double predicted = best;
            for (std::size_t k = 0; k < candidate.size(); ++k) predicted *= minimum_costs_[k][candidate[k]] / best;
            if (predicted >= lowest_cost_ || search_.costs_.contains(candidate)) return;
            lowest_cost_ = predicted;
            candidate_ = candidate;
        }
        const Candidate& lowest_candidate() const { return candidate_; }

      private:
        const CoordinateDescent& search_;
        std::vector<std::vector<double>> minimum_costs_;
        double lowest_cost_;
        Candidate candidate_;  // empty: every prediction is above max_ratio
    };

    Candidate most_promising_candidate() const {
        LowestPrediction prediction(*this, kMaxPredictedRatio);
        for_each_candidate(space_, [&](const Candidate& candidate) { prediction.offer(candidate); });
        return prediction.lowest_candidate();
    }

    // Returns the most promising neighbour that differs in two parameters. If two parameters share a resource, such as
    // registers, a gain may require a change of both.
    Candidate most_promising_neighbour() const {
        LowestPrediction prediction(*this, kMaxPairRatio);
        for (std::size_t a = 0; a < space_.parameters.size(); ++a)
            for (std::size_t b = 0; b < a; ++b)
                for (const int signs : {0, 1, 2, 3}) {  // bits 0 and 1: signs of the steps of a and b
                    Candidate candidate = result_.best;
                    candidate[a] += signs & 1 ? 1 : -1;  // wraps below 0
                    candidate[b] += signs & 2 ? 1 : -1;
                    if (candidate[a] < space_.parameters[a].values.size() &&
                        candidate[b] < space_.parameters[b].values.size())
                        prediction.offer(candidate);
                }
        return prediction.lowest_candidate();
    }

    const Space& space_;
    const MeasureRatio& measure_;
    const ShouldStop& stop_;
    std::vector<std::size_t> parameter_order_;  // parameter indices in the order in which the search varies them
    SearchResult result_;
    std::map<Candidate, double> costs_;  // time divided by the time of Space::start, or kDroppedCost
};

}  // namespace

const char* TuningParameter::name() const {
    return std::find_if(kTunedNames.begin(), kTunedNames.end(), [this](const auto& n) { return n.second == value; })
        ->first;
}

std::size_t Space::size() const {
    std::size_t product = 1;
    for (const TuningParameter& parameter : parameters) product *= parameter.values.size();
    return product;
}

TunedValues Space::values_of(const Candidate& candidate) const {
    TunedValues values = defaults;
    for (std::size_t k = 0; k < parameters.size(); ++k)
        values.*parameters[k].value = parameters[k].values[candidate[k]];
    return values;
}

void for_each_candidate(const Space& space, const std::function<void(const Candidate&)>& visit) {
    Candidate candidate(space.parameters.size(), 0);
    for (;;) {
        visit(candidate);
        std::size_t k = 0;
        while (k < candidate.size() && ++candidate[k] == space.parameters[k].values.size()) candidate[k++] = 0;
        if (k == candidate.size()) return;
    }
}

Space space_of(const DeviceInfo& device, const TuningKey& key) {
    Space space{.parameters = {}, .defaults = default_values(device, key), .start = {}};
    const bool cpu = device.type == "cpu", tests_all_objects = key.accel == RAYA_ACCEL_NONE;
    const auto add = [&](std::uint32_t TunedValues::*value, Values values) {
        add_default(values, space.defaults.*value);
        const auto at = std::find(values.begin(), values.end(), space.defaults.*value);
        space.start.push_back(static_cast<std::size_t>(at - values.begin()));
        space.parameters.push_back({value, std::move(values)});
    };
    const std::uint32_t max_group = max_group_size_of(device);
    // Only llvmpipe limits loop iterations. It vectorises over work-items, so one lane suffices, and it needs minutes
    // and gigabytes of memory to compile kernels with several lanes.
    const bool llvmpipe = device.max_loop_iterations > 0;
    add(&TunedValues::lanes, llvmpipe ? Values{1} : Values{1, 4, 8, 16});
    // Torus nodes on a CPU keep their default group size, which preserves the order of packets (docs/packets.md).
    const std::uint32_t max_cpu_group = key.torus ? space.defaults.group : std::min(llvmpipe ? 16u : 4u, max_group);
    add(&TunedValues::group, cpu ? group_sizes(1, max_cpu_group) : group_sizes(16, max_group));
    if (supports_register_limit(device)) add(&TunedValues::registers, {0, 64, 96, 128, 168});
    if (tests_all_objects) add(&TunedValues::local_words, {0, 1});
    if (tests_all_objects && key.fp32 && !key.torus)
        add(&TunedValues::batch, cpu ? Values{0, 8, 16} : Values{0, 4, 8, 16, 32});
    if (key.accel == RAYA_ACCEL_GRID) {
        add(&TunedValues::trees, {0, 1, 2, 4, 8});
        add(&TunedValues::beams, {0, 1, 2, 4, 8});
    }
    // On a CPU the default value 0 already selects the exchange kernel.
    if (key.torus)
        add(&TunedValues::link_exchange, cpu ? Values{0, kCopyExchange} : Values{0, kCopyExchange, kKernelExchange});
    return space;
}

std::string change_text(const Space& space, const TunedValues& old_values, const TunedValues& new_values) {
    std::string text;
    for (const TuningParameter& parameter : space.parameters) {
        std::string name = parameter.name();
        std::replace(name.begin(), name.end(), '_', ' ');
        text +=
            fmt::format("{}{} {}", text.empty() ? "" : ", ", name, value_text(parameter, old_values.*parameter.value));
        if (old_values.*parameter.value != new_values.*parameter.value)
            text += " -> " + value_text(parameter, new_values.*parameter.value);
    }
    return text;
}

SearchResult search(const Space& space, const MeasureRatio& measure, const ShouldStop& stop) {
    return CoordinateDescent(space, measure, stop).run();
}

SearchResult search_all(const Space& space, const Candidate& start, const MeasureRatio& measure,
                        const ShouldStop& stop) {
    SearchResult result{.best = start};
    for_each_candidate(space, [&](const Candidate& candidate) {
        if (candidate == start || !result.complete) return;
        if (stop()) {
            result.complete = false;
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
