#include "host/tune/t4_report.hpp"

#include <algorithm>

#include "host/base/json.hpp"
#include "host/version.hpp"

namespace raya {
namespace {

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
