#include "host/tune/supervisor.hpp"

#include <fmt/core.h>

#include <chrono>

#include "host/base/json.hpp"
#include "host/base/own_process.hpp"
#include "host/base/utc_time.hpp"
#include "host/error.hpp"

namespace raya {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

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

}  // namespace

Trial supervise_trial(const std::vector<std::string>& arguments, const TrialOrder& order, double limit_s,
                      const std::string& check, const TrialSink& running) {
    std::vector<std::string> all = arguments;
    all.push_back(order.text());
    const Clock::time_point start = Clock::now();
    Told told(order, check);
    OwnProcess process(all);
    while (!told.ended()) {
        std::string line;
        const OwnProcess::Read read = process.read(line, std::chrono::milliseconds(200));
        if (read == OwnProcess::Read::kLine) told.take(Json::parse(line, {"the trial's process"}));
        if (read == OwnProcess::Read::kEnd) told.end(told.failure(), "ended by " + ending_text(process.wait()));
        if (read == OwnProcess::Read::kNothing && running) running(seconds_since(start));
        if (seconds_since(start) > limit_s) told.end(Fate::kTimeout, fmt::format("not done in {:.0f} s", limit_s));
    }
    Trial trial = told.trial();  // a process that is not done ends with `process`
    trial.wall_s = seconds_since(start);
    trial.when = utc_text("%Y-%m-%dT%H:%M:%SZ");
    return trial;
}

}  // namespace raya
