#include "host/tune/tune.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>

#include "host/base/clock.hpp"
#include "host/base/json.hpp"
#include "host/base/own_process.hpp"
#include "host/error.hpp"
#include "host/version.hpp"

namespace raya {
namespace {

// What a process has told of a trial.
class Told {
  public:
    Told(const TrialOrder& order, const std::string& check) : order_(order), check_(check) {
        trial_.values = order.candidates.back();
    }

    void take(const Json& line) {
        if (const Json* error = line.find("error")) {
            if (line.at("kind").text() == "user") throw UserError(error->text());
            end(failure(), error->text());
        }
        if (const Json* built = line.find("built")) built_ = built->whole() + 1;
        if (line.find("check")) take_check(line);
        if (const Json* samples = line.find("samples")) take_samples(*samples);
    }

    void end(Fate fate, const std::string& told) {
        if (ended_) return;
        ended_ = true;
        trial_.fate = fate;
        trial_.told = told.substr(0, told.find('\n'));
    }

    Fate failure() const { return built_ < order_.candidates.size() ? Fate::kCompile : Fate::kRuntime; }
    bool ended() const { return ended_; }
    Trial trial() const { return trial_; }

  private:
    void take_check(const Json& line) {
        trial_.build_s = line.at("build_s").number();
        trial_.check = line.at("check").text();
        if (!check_.empty() && trial_.check != check_)
            end(Fate::kCorrectness, fmt::format("another image: {}, not {}", trial_.check, check_));
    }

    void take_samples(const Json& samples) {
        for (const Json& of_one : samples.elements()) {
            trial_.samples.emplace_back();
            for (const Json& seconds : of_one.elements()) trial_.samples.back().push_back(seconds.number());
        }
        end(Fate::kCorrect, "");
    }

    const TrialOrder& order_;
    const std::string& check_;
    Trial trial_;
    std::size_t built_ = 0;  // candidates
    bool ended_ = false;
};

// Runs a trial in a process of its own, for `limit_s` seconds, after which it is ended: a driver that crashes or hangs
// takes that process with it, and no other. `check` is what the candidates' images must be; empty: anything. UserError
// as the process met it.
Trial supervise_trial(const TrialOrder& order, double limit_s, const std::string& check, const TrialWatch& running) {
    const Clock::time_point start = Clock::now();
    Told told(order, check);
    OwnProcess process(kTrialTask, to_json(order));
    while (!told.ended()) {
        std::string line;
        const OwnProcess::Read read = process.read(line, std::chrono::milliseconds(200));
        if (read == OwnProcess::Read::kLine) told.take(Json::parse(line, {"the trial's process"}));
        if (read == OwnProcess::Read::kEnd) told.end(told.failure(), "ended by " + ending_text(process.wait()));
        if (read == OwnProcess::Read::kNothing) running(order.candidates.back(), seconds_since(start));
        if (seconds_since(start) > limit_s) told.end(Fate::kTimeout, fmt::format("not done in {:.0f} s", limit_s));
    }
    Trial trial = told.trial();  // a process that is not done ends with `process`
    trial.wall_s = seconds_since(start);
    trial.when = utc_text("%Y-%m-%dT%H:%M:%SZ");
    return trial;
}

constexpr std::uint32_t kSamples = 5, kFinalSamples = 9;
constexpr double kLimitFactor = 10;  // limits that the defaults, and a comparison in the end, may take

class Tuner {
  public:
    Tuner(const DeviceInfo& device, const Workload& workload, const TuneSettings& settings, const TrialWatch& running)
        : settings_(settings), running_(running) {
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
    double seconds() const { return seconds_since(start_); }

    // What is left, of which a candidate that has begun may take a little more.
    double out_of_seconds() const { return std::max(2.0, settings_.seconds - seconds()); }

    Trial trial(const std::vector<TunedValues>& candidates, std::uint32_t samples, double limit_s, bool stop_early) {
        const TrialOrder order{settings_.render, result_.workload, candidates, samples, stop_early};
        return supervise_trial(order, limit_s, check_, running_);
    }

    Trial defaults() {
        const Trial first = trial({result_.space.defaults}, 1, kLimitFactor * settings_.limit_s, false);
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
        result_.trials.push_back(t);
        return t.fate == Fate::kCorrect ? std::optional(ratio_of(t)) : std::nullopt;
    }

    // The least of many samples is less than it should be: the winner is measured once more.
    void hold_against_defaults(const TunedValues& found) {
        result_.best = result_.space.defaults;
        if (found == result_.best) return;
        const Trial last = trial({result_.best, found}, kFinalSamples, kLimitFactor * settings_.limit_s, false);
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
            trial({*result_.best_all, result_.best}, kFinalSamples, kLimitFactor * settings_.limit_s, false);
        if (last.fate == Fate::kCorrect) result_.ratio_all = median_ratio(last.samples[1], last.samples[0]);
    }

    const TuneSettings& settings_;
    const TrialWatch& running_;
    const Clock::time_point start_ = Clock::now();
    std::string check_;
    Tuning result_;
};

constexpr const char* kSchemaVersion = "1.0.0";

const char* invalidity(Fate fate) {
    switch (fate) {
        case Fate::kCompile:
            return "compile";
        case Fate::kRuntime:
            return "runtime";
        case Fate::kCorrectness:
            return "correctness";
        case Fate::kTimeout:
            return "timeout";
        default:
            return "correct";
    }
}

Json measurement(const char* name, double value, const char* unit) {
    return {{"name", name}, {"value", value}, {"unit", unit}};
}

Json result_json(const Tuning& tuning, const Trial& trial) {
    Json configuration = Json::object();
    for (const Knob& knob : tuning.space.knobs) configuration[knob.name()] = trial.values.*knob.value;
    configuration["workload"] = tuning.workload.name();
    const bool correct = trial.fate == Fate::kCorrect;
    Json runtimes = Json::list(), measurements = Json::list();
    if (correct) {
        const std::vector<double>& seconds = trial.samples.back();
        for (const double s : seconds) runtimes.push_back(1e3 * s);
        measurements.push_back(measurement("time", 1e3 * *std::min_element(seconds.begin(), seconds.end()), "ms"));
        measurements.push_back(measurement("ratio", ratio_of(trial), ""));
    }
    return {{"timestamp", trial.when},
            {"configuration", configuration},
            {"objectives", std::vector<std::string>{"time"}},
            {"times",
             {{"compilation_time", 1e3 * trial.build_s},
              {"runtimes", runtimes},
              {"framework", 1e3 * trial.wall_s},
              {"search_algorithm", 0},
              {"validation", 0}}},
            {"invalidity", invalidity(trial.fate)},
            {"correctness", trial.fate == Fate::kCorrectness ? 0 : 1},
            {"measurements", measurements}};
}

}  // namespace

std::size_t Tuning::count(Fate fate) const {
    return static_cast<std::size_t>(
        std::count_if(trials.begin(), trials.end(), [&](const Trial& t) { return t.fate == fate; }));
}

std::size_t Tuning::dropped() const { return trials.size() - count(Fate::kCorrect) - count(Fate::kUnfinished); }

Tuning tune(const DeviceInfo& device, const Workload& workload, const TuneSettings& settings,
            const TrialWatch& running) {
    return Tuner(device, workload, settings, running).run();
}

std::string t4_text(const DeviceInfo& device, const std::vector<Tuning>& tunings) {
    Json results = Json::list();
    for (const Tuning& tuning : tunings)
        for (const Trial& trial : tuning.trials)
            if (trial.fate != Fate::kUnfinished) results.push_back(result_json(tuning, trial));
    return Json{{"schema_version", kSchemaVersion},
                {"metadata",
                 {{"timeunit", "milliseconds"},
                  {"program", name_and_version()},
                  {"device", device.name},
                  {"platform", device.platform},
                  {"driver", device.driver}}},
                {"results", results}}
               .dump(1) +
           "\n";
}

}  // namespace raya
