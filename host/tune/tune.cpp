#include "host/tune/tune.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>

#include "host/error.hpp"

namespace raya {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::uint32_t kSamples = 5, kFinalSamples = 9;
constexpr double kPatience = 10;  // limits that the defaults, and a comparison in the end, may take

class Tuner {
  public:
    Tuner(const DeviceInfo& device, const Workload& workload, const TuneSettings& settings, const TuneSink& sink)
        : settings_(settings), sink_(sink) {
        result_.workload = workload;
        result_.space = space_of(device, workload.what());
    }

    Tuning run() {
        check_ = defaults().check;
        const SearchEnd out_of_time = [this] { return seconds() >= settings_.seconds; };
        const Judge judge = [this](const Candidate& best, const Candidate& candidate) {
            return judged(best, candidate, out_of_seconds());
        };
        const SearchResult found = search(result_.space, judge, out_of_time);
        result_.complete = found.ended;
        result_.seconds = seconds();
        hold_against_defaults(result_.space.values_of(found.best));
        if (settings_.exhaustive) try_all(result_.best == result_.space.defaults ? result_.space.start : found.best);
        return std::move(result_);
    }

  private:
    double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

    // What is left, of which a candidate that has begun may take a little more.
    double out_of_seconds() const { return std::max(2.0, settings_.seconds - seconds()); }

    Trial trial(const std::vector<TunedValues>& candidates, std::uint32_t samples, double limit_s, bool stop_early) {
        const TrialOrder order{result_.workload, candidates, samples, stop_early};
        const auto running = [&](double s) {
            if (sink_.running) sink_.running(candidates.back(), s);
        };
        return supervise_trial(settings_.arguments, order, limit_s, check_, running);
    }

    Trial defaults() {
        const Trial first = trial({result_.space.defaults}, 1, kPatience * settings_.limit_s, false);
        if (first.fate == Fate::kCorrect) return first;
        throw DeviceError(
            fmt::format("{}: the defaults cannot be measured: {}; remedy: raya verify tells what is wrong",
                        result_.workload.name(), first.told));
    }

    std::optional<double> judged(const Candidate& best, const Candidate& candidate, double most_s) {
        const Space& space = result_.space;
        const double limit = std::min(settings_.limit_s, most_s);
        Trial t = trial({space.values_of(best), space.values_of(candidate)}, kSamples, limit, true);
        if (t.fate == Fate::kTimeout && limit < settings_.limit_s) t.fate = Fate::kUnfinished;
        if (sink_.finished) sink_.finished(t);
        result_.trials.push_back(t);
        return t.fate == Fate::kCorrect ? std::optional(ratio_of(t)) : std::nullopt;
    }

    // The least of many samples is less than it should be: the winner is measured once more.
    void hold_against_defaults(const TunedValues& found) {
        result_.best = result_.space.defaults;
        if (found == result_.best) return;
        const Trial last = trial({result_.best, found}, kFinalSamples, kPatience * settings_.limit_s, false);
        if (!wins_surely(last)) return;
        result_.best = found;
        result_.ratio = median_ratio(last.samples[1], last.samples[0]);
    }

    void try_all(const Candidate& from) {
        const Tuning searched = result_;
        const Judge judge = [this](const Candidate& best, const Candidate& candidate) {
            return judged(best, candidate, settings_.limit_s);
        };
        const SearchResult all = search_all(result_.space, from, judge, [] { return false; });
        result_ = searched;  // whose trials are its own
        result_.tried_all = all.tried;
        result_.best_all = result_.space.values_of(all.best);
        if (*result_.best_all == result_.best) return;
        const Trial last =
            trial({*result_.best_all, result_.best}, kFinalSamples, kPatience * settings_.limit_s, false);
        if (last.fate == Fate::kCorrect) result_.ratio_all = median_ratio(last.samples[1], last.samples[0]);
    }

    const TuneSettings& settings_;
    const TuneSink& sink_;
    const Clock::time_point start_ = Clock::now();
    std::string check_;
    Tuning result_;
};

}  // namespace

std::size_t Tuning::count(Fate fate) const {
    return static_cast<std::size_t>(
        std::count_if(trials.begin(), trials.end(), [&](const Trial& t) { return t.fate == fate; }));
}

std::size_t Tuning::dropped() const { return trials.size() - count(Fate::kCorrect) - count(Fate::kUnfinished); }

Tuning tune(const DeviceInfo& device, const Workload& workload, const TuneSettings& settings, const TuneSink& sink) {
    return Tuner(device, workload, settings, sink).run();
}

}  // namespace raya
