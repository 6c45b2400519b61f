#include "host/verify/rerun.hpp"

#include <chrono>
#include <cstdlib>
#include <list>
#include <optional>

#include "host/base/child_process.hpp"
#include "host/base/clock.hpp"

namespace raya {
namespace {

// Sets an environment variable of this process, and so of its children, as long as the object exists.
class EnvironmentVariable {
  public:
    EnvironmentVariable(std::string name, const std::string& value) : name_(std::move(name)) {
        if (const char* const old = std::getenv(name_.c_str())) old_ = old;
        ::setenv(name_.c_str(), value.c_str(), 1);
    }
    ~EnvironmentVariable() { old_ ? ::setenv(name_.c_str(), old_->c_str(), 1) : ::unsetenv(name_.c_str()); }
    EnvironmentVariable(const EnvironmentVariable&) = delete;
    EnvironmentVariable& operator=(const EnvironmentVariable&) = delete;

  private:
    std::string name_;
    std::optional<std::string> old_;
};

void take_line(Observation& seen, const Json& line) {
    if (line.find("step")) seen.steps.push_back({line.at("name").text()});
    if (line.find("expected")) seen.expected = line.at("expected").integer();
    if (const Json* check = line.find("check")) seen.passed = check_of(*check).verdict.outcome == Outcome::kPass;
    if (!line.find("done") || seen.steps.empty()) return;
    seen.steps.back().done = true;
    const Json& outputs = line.at("outputs");
    for (const std::string& name : outputs.keys()) seen.steps.back().outputs[name] = outputs.at(name).text();
}

}  // namespace

VerifySettings settings_of_one(VerifySettings settings, const std::string& full_name) {
    settings.only = full_name;
    settings.is_whole_name = true;
    settings.skip.clear();
    settings.shard = settings.shards = settings.repeat = 1;
    settings.done = 0;
    settings.soak_s = 0;
    return settings;
}

std::string with_build_option(const std::string& option) {
    const char* const options = std::getenv("RAYA_BUILD_OPTIONS");
    return options != nullptr ? std::string(options) + " " + option : option;
}

Observation observe(const CheckRun& v, std::size_t step, const std::filesystem::path& folder, bool ends_at_step) {
    std::list<EnvironmentVariable> environment;
    for (const auto& [name, value] : v.environment) environment.emplace_back(name, value);
    Json request = settings_json(v.settings, v.selector, 0);
    request["capture"] = {{"step", step}, {"folder", folder.string()}};
    ChildProcess process(kVerifyTask, request);
    Observation seen;
    const Clock::time_point start = Clock::now();
    for (std::string line;;) {
        const ChildProcess::Read read = process.read(line, std::chrono::seconds(1));
        if (read == ChildProcess::Read::kEnd) break;
        if (read == ChildProcess::Read::kLine) take_line(seen, Json::parse(line, {"the process of the checks"}));
        if (ends_at_step && seen.steps.size() == step) break;
        if (v.settings.timeout_s > 0 && seconds_since(start) > v.settings.timeout_s) break;
    }
    return seen;
}

}  // namespace raya
