#include "host/tune/tune.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>

#include "host/base/child_process.hpp"
#include "host/base/clock.hpp"
#include "host/base/json.hpp"
#include "host/error.hpp"
#include "host/version.hpp"

namespace raya {
namespace {

// Builds a Trial from the lines that the trial's process writes.
class TrialReader {
  public:
    TrialReader(const TrialRequest& request, const std::string& expected_check)
        : request_(request), expected_check_(expected_check) {
        trial_.values = request.candidates.back();
    }

    void take_line(const Json& line) {
        if (const Json* error = line.find("error")) {
            if (line.at("kind").text() == "user") throw UserError(error->text());
            end(failure_status(), error->text());
        }
        if (const Json* built = line.find("built")) built_candidates_ = built->integer() + 1;
        if (line.find("check")) take_check(line);
        if (const Json* samples = line.find("samples")) take_samples(*samples);
    }

    // Ends the trial with the first line of `error`, unless the trial has already ended.
    void end(TrialStatus status, const std::string& error) {
        if (ended_) return;
        ended_ = true;
        trial_.status = status;
        trial_.error = error.substr(0, error.find('\n'));
    }

    // Returns the status of a trial that fails now: kCompile until all kernels are built, then kRuntime.
    TrialStatus failure_status() const {
        return built_candidates_ < request_.candidates.size() ? TrialStatus::kCompile : TrialStatus::kRuntime;
    }
    bool ended() const { return ended_; }
    Trial trial() const { return trial_; }

  private:
    void take_check(const Json& line) {
        trial_.build_s = line.at("build_s").number();
        trial_.check = line.at("check").text();
        if (!expected_check_.empty() && trial_.check != expected_check_)
            end(TrialStatus::kCorrectness, fmt::format("image is {}; expected {}", trial_.check, expected_check_));
    }

    void take_samples(const Json& samples) {
        for (const Json& candidate_samples : samples.elements()) {
            trial_.samples.emplace_back();
            for (const Json& seconds : candidate_samples.elements()) trial_.samples.back().push_back(seconds.number());
        }
        end(TrialStatus::kCorrect, "");
    }

    const TrialRequest& request_;
    const std::string& expected_check_;  // empty: accept any check
    Trial trial_;
    std::size_t built_candidates_ = 0;  // number of candidates built so far
    bool ended_ = false;
};

// Runs a trial in a child process, because drivers may crash or hang, and ends the process after `limit_s` seconds.
// `expected_check`: the expected Trial::check; empty: accept any check. Throws UserError if the process reports a user
// error.
Trial supervise_trial(const TrialRequest& request, double limit_s, const std::string& expected_check,
                      const TrialProgress& progress) {
    const Clock::time_point start = Clock::now();
    TrialReader reader(request, expected_check);
    ChildProcess process(kTrialTask, to_json(request));
    while (!reader.ended()) {
        std::string line;
        const ChildProcess::Read read = process.read(line, std::chrono::milliseconds(200));
        if (read == ChildProcess::Read::kLine) reader.take_line(Json::parse(line, {"the trial's process"}));
        if (read == ChildProcess::Read::kEnd)
            reader.end(reader.failure_status(), "ended by " + ending_text(process.wait()));
        if (read == ChildProcess::Read::kNothing) progress(request.candidates.back(), seconds_since(start));
        if (seconds_since(start) > limit_s)
            reader.end(TrialStatus::kTimeout, fmt::format("not done in {:.0f} s", limit_s));
    }
    Trial trial = reader.trial();  // ~ChildProcess() ends the process if it still runs
    trial.wall_s = seconds_since(start);
    trial.ended_at = utc_text("%Y-%m-%dT%H:%M:%SZ");
    return trial;
}

constexpr std::uint32_t kSamples = 5, kFinalSamples = 9;  // samples per candidate: search; final comparison
constexpr double kLimitFactor = 10;  // factor of limit_s for the first trial of the defaults and for final comparisons

class Tuner {
  public:
    Tuner(const DeviceInfo& device, const Workload& workload, const TuneSettings& settings,
          const TrialProgress& progress)
        : settings_(settings), progress_(progress) {
        result_.workload = workload;
        result_.space = space_of(device, workload.key());
    }

    Tuning run() {
        check_ = measure_defaults().check;
        const ShouldStop time_is_over = [this] { return elapsed_s() >= settings_.seconds; };
        const MeasureRatio ratio = [this](const Candidate& best, const Candidate& candidate) {
            return measure(best, candidate, remaining_s());
        };
        const SearchResult found = search(result_.space, ratio, time_is_over);
        result_.complete = found.complete;
        result_.seconds = elapsed_s();
        confirm(result_.space.values_of(found.best));
        if (settings_.exhaustive)
            measure_all_candidates(result_.best == result_.space.defaults ? result_.space.start : found.best);
        return std::move(result_);
    }

  private:
    double elapsed_s() const { return seconds_since(start_); }

    // Returns the time left for a candidate in seconds. It is at least 2, so that the last candidate can finish
    // although the time of the search is over.
    double remaining_s() const { return std::max(2.0, settings_.seconds - elapsed_s()); }

    Trial run_trial_of(const std::vector<TunedValues>& candidates, std::uint32_t samples, double limit_s,
                       bool stop_early) {
        const TrialRequest request{settings_.render, result_.workload, candidates, samples, stop_early};
        return supervise_trial(request, limit_s, check_, progress_);
    }

    Trial measure_defaults() {
        const Trial first = run_trial_of({result_.space.defaults}, 1, kLimitFactor * settings_.limit_s, false);
        if (first.status == TrialStatus::kCorrect) return first;
        throw DeviceError(fmt::format(
            "{}: the render with the default parameters failed: {}; remedy: run raya verify to find the error",
            result_.workload.name(), first.error));
    }

    // Runs a trial. Returns the candidate's time divided by the best's, or nullopt if the candidate is dropped.
    std::optional<double> measure(const Candidate& best, const Candidate& candidate, double max_s) {
        const Space& space = result_.space;
        const double limit = std::min(settings_.limit_s, max_s);
        Trial t = run_trial_of({space.values_of(best), space.values_of(candidate)}, kSamples, limit, true);
        if (t.status == TrialStatus::kTimeout && limit < settings_.limit_s) t.status = TrialStatus::kUnfinished;
        result_.trials.push_back(t);
        return t.status == TrialStatus::kCorrect ? std::optional(ratio_of(t)) : std::nullopt;
    }

    // Sets the result to `found` if a new comparison with the defaults confirms that `found` is faster. The search's
    // own measurement of `found` is biased: the best of many measurements is often a lucky one.
    void confirm(const TunedValues& found) {
        result_.best = result_.space.defaults;
        if (found == result_.best) return;
        const Trial comparison =
            run_trial_of({result_.best, found}, kFinalSamples, kLimitFactor * settings_.limit_s, false);
        if (!wins_significantly(comparison)) return;
        result_.best = found;
        result_.ratio = median_ratio(comparison.samples[1], comparison.samples[0]);
    }

    // Measures every candidate, and compares the best of them with the search's result.
    void measure_all_candidates(const Candidate& start) {
        const Tuning search_result = result_;
        const MeasureRatio ratio = [this](const Candidate& best, const Candidate& candidate) {
            return measure(best, candidate, settings_.limit_s);
        };
        const SearchResult all = search_all(result_.space, start, ratio, [] { return false; });
        result_ = search_result;  // discards the trials of search_all()
        result_.exhaustive_tried = all.tried;
        result_.exhaustive_best = result_.space.values_of(all.best);
        if (*result_.exhaustive_best == result_.best) return;
        const Trial comparison = run_trial_of({*result_.exhaustive_best, result_.best}, kFinalSamples,
                                              kLimitFactor * settings_.limit_s, false);
        if (comparison.status == TrialStatus::kCorrect)
            result_.exhaustive_ratio = median_ratio(comparison.samples[1], comparison.samples[0]);
    }

    const TuneSettings& settings_;
    const TrialProgress& progress_;
    const Clock::time_point start_ = Clock::now();
    std::string check_;  // Trial::check of the defaults
    Tuning result_;
};

constexpr const char* kSchemaVersion = "1.0.0";

const char* invalidity(TrialStatus status) {
    switch (status) {
        case TrialStatus::kCompile:
            return "compile";
        case TrialStatus::kRuntime:
            return "runtime";
        case TrialStatus::kCorrectness:
            return "correctness";
        case TrialStatus::kTimeout:
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
    for (const TuningParameter& parameter : tuning.space.parameters)
        configuration[parameter.name()] = trial.values.*parameter.value;
    configuration["workload"] = tuning.workload.name();
    const bool correct = trial.status == TrialStatus::kCorrect;
    Json runtimes = Json::array(), measurements = Json::array();
    if (correct) {
        const std::vector<double>& seconds = trial.samples.back();
        for (const double s : seconds) runtimes.push_back(1e3 * s);
        measurements.push_back(measurement("time", 1e3 * *std::min_element(seconds.begin(), seconds.end()), "ms"));
        measurements.push_back(measurement("ratio", ratio_of(trial), ""));
    }
    return {{"timestamp", trial.ended_at},
            {"configuration", configuration},
            {"objectives", std::vector<std::string>{"time"}},
            {"times",
             {{"compilation_time", 1e3 * trial.build_s},
              {"runtimes", runtimes},
              {"framework", 1e3 * trial.wall_s},
              {"search_algorithm", 0},
              {"validation", 0}}},
            {"invalidity", invalidity(trial.status)},
            {"correctness", trial.status == TrialStatus::kCorrectness ? 0 : 1},
            {"measurements", measurements}};
}

}  // namespace

std::size_t Tuning::count(TrialStatus status) const {
    return static_cast<std::size_t>(
        std::count_if(trials.begin(), trials.end(), [&](const Trial& t) { return t.status == status; }));
}

std::size_t Tuning::dropped() const {
    return trials.size() - count(TrialStatus::kCorrect) - count(TrialStatus::kUnfinished);
}

Tuning tune(const DeviceInfo& device, const Workload& workload, const TuneSettings& settings,
            const TrialProgress& progress) {
    return Tuner(device, workload, settings, progress).run();
}

std::string t4_text(const DeviceInfo& device, const std::vector<Tuning>& tunings) {
    Json results = Json::array();
    for (const Tuning& tuning : tunings)
        for (const Trial& trial : tuning.trials)
            if (trial.status != TrialStatus::kUnfinished) results.push_back(result_json(tuning, trial));
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
