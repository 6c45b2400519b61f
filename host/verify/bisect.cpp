#include "host/verify/bisect.hpp"

#include <fmt/core.h>

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <list>
#include <optional>
#include <regex>
#include <utility>
#include <vector>

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
    if (find_member(line, "step")) seen.steps.push_back({json_text(line.at("name"))});
    if (find_member(line, "expected")) seen.expected = json_integer(line.at("expected"));
    if (const Json* check = find_member(line, "check"))
        seen.passed = check_of(*check).verdict.outcome == Outcome::kPass;
    if (!find_member(line, "done") || seen.steps.empty()) return;
    seen.steps.back().done = true;
    const Json& outputs = line.at("outputs");
    for (const auto& [name, hash] : outputs.items()) seen.steps.back().outputs[name] = json_text(hash);
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
        if (read == ChildProcess::Read::kLine) take_line(seen, parse_json(line, {"the process of the checks"}));
        if (ends_at_step && seen.steps.size() == step) break;
        if (v.settings.timeout_s > 0 && seconds_since(start) > v.settings.timeout_s) break;
    }
    return seen;
}

namespace {

struct Change {
    std::string text, variable{}, value{};  // an environment variable, or, if `variable` is empty:
    std::uint32_t lanes = 0, group = 0;     // numbers for VerifySettings; 0: unchanged
};

// Returns the name of the same check with one lane: "fp32, 1 lane" for "fp32, 16 lanes".
std::string name_with_one_lane(const std::string& name) {
    const std::string once = std::regex_replace(name, std::regex(R"(\b\d+ lanes)"), "1 lane");
    return std::regex_replace(once, std::regex(R"(, \d+x(\d+)$)"), ", 1x$1");
}

bool exists(const VerifySettings& settings, const std::string& selector, const std::string& name) {
    return !check_names(choose_device(selector), settings_of_one(settings, name)).empty();
}

class Bisector {
  public:
    Bisector(CheckRun failing, const std::string& name, bool is_pocl, std::function<void(const std::string&)> print)
        : failing_(std::move(failing)), name_(name), print_(std::move(print)) {
        for (const char* const option : {"-cl-opt-disable", kNoBuiltins, "-DRAYA_EXACT_DIVIDE=0", "-DRAYA_EXACT_FMA=0"})
            changes_.push_back({std::string("RAYA_BUILD_OPTIONS=") + option, "RAYA_BUILD_OPTIONS", option});
        changes_.push_back({.text = "groups of 1 work-item (--group 1)", .group = 1});
        VerifySettings one_lane = failing_.settings;
        one_lane.lanes = 1;
        if (failing_.settings.as.empty() && failing_.settings.lanes != 1 &&
            exists(one_lane, failing_.selector, name_with_one_lane(name_)))
            changes_.push_back({.text = "--lanes 1", .lanes = 1});
        if (!is_pocl) return;
        for (const auto& [variable, value] : {std::pair{"POCL_WORK_GROUP_METHOD", "loops"},
                                              {"POCL_MAX_PTHREAD_COUNT", "1"},
                                              {"POCL_CPU_MAX_CU_COUNT", "1"},
                                              {"POCL_WORK_GROUP_SPECIALIZATION", "0"}})
            changes_.push_back({std::string(variable) + "=" + value, variable, value});
    }

    void run() {
        if (!passes(changes_)) return print_(name_ + ": fails also with all of these changes");
        print_(fmt::format("{}: passes with {}", name_, text_of(minimal({}, changes_, false))));
    }

  private:
    using Changes = std::vector<Change>;

    static std::string text_of(const Changes& changes) {
        std::string text;
        for (const Change& change : changes) text += (text.empty() ? "" : ", ") + change.text;
        return text;
    }

    static Changes together(Changes a, const Changes& b) {
        a.insert(a.end(), b.begin(), b.end());
        return a;
    }

    // Returns a smallest part of `candidates` that, together with `given`, makes the check pass. `has_new`: `given` has
    // changes with which the check has not been tried.
    Changes minimal(const Changes& given, const Changes& candidates, bool has_new) {
        if (has_new && passes(given)) return {};
        if (candidates.size() == 1) return candidates;
        const auto middle = candidates.begin() + static_cast<std::ptrdiff_t>(candidates.size() / 2);
        const Changes first(candidates.begin(), middle), second(middle, candidates.end());
        const Changes of_second = minimal(together(given, first), second, !first.empty());
        const Changes of_first = minimal(together(given, of_second), first, !of_second.empty());
        return together(of_first, of_second);
    }

    bool passes(const Changes& changes) {
        const TemporaryFolder cache("raya-bisect");
        CheckRun variant = failing_;
        std::string name = name_, options;
        for (const Change& change : changes) {
            if (change.variable == "RAYA_BUILD_OPTIONS")
                options += (options.empty() ? "" : " ") + change.value;
            else if (!change.variable.empty())
                variant.environment[change.variable] = change.value;
            if (change.lanes != 0) name = name_with_one_lane(name);
            if (change.lanes != 0) variant.settings.lanes = change.lanes;
            if (change.group != 0) variant.settings.group_size = change.group;
        }
        if (!options.empty()) variant.environment["RAYA_BUILD_OPTIONS"] = with_build_option(options);
        variant.environment["POCL_CACHE_DIR"] = cache.path().string();
        variant.settings = settings_of_one(variant.settings, name);
        const bool passed = observe(variant).passed;
        print_(fmt::format("{}  {}", passed ? "PASS" : "FAIL", text_of(changes)));
        return passed;
    }

    CheckRun failing_;
    std::string name_;
    std::function<void(const std::string&)> print_;
    Changes changes_;
};

}  // namespace

void bisect(const std::string& selector, const DeviceChecks& device, const VerifySettings& settings,
            const std::string& full_name, const std::function<void(const std::string& line)>& print) {
    const bool is_pocl = device.platform == "Portable Computing Language";
    Bisector({"", selector, settings, {}}, full_name, is_pocl, print).run();
}

}  // namespace raya
