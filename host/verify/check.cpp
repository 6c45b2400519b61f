#include "verify/check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <sstream>

#include "error.hpp"

namespace raya {
namespace {

Verdict verdict_of(const std::function<Verdict()>& body) {
    const auto broken = [](const std::string& message) {
        const std::size_t end = message.find('\n');
        Fault fault;
        if (end != std::string::npos) fault.where = message.substr(end + 1);
        fault.remedies = {"raya devices: is this the device that you mean?", "a newer driver"};
        return failed(message.substr(0, end), fault);
    };
    try {
        return body();
    } catch (const DeviceError& error) {
        return broken(error.what());
    } catch (const std::exception& error) {
        return broken(std::string("the check could not be done: ") + error.what());
    }
}

// "    label: text", the text's further lines below its first.
std::string indented(const std::string& label, const std::string& text) {
    constexpr int kLabel = 14;
    if (text.empty()) return {};
    std::string all, line, head = label;
    for (std::istringstream in(text); std::getline(in, line); head.clear())
        all += fmt::format("      {:<{}}{}\n", head, kLabel, line);
    return all;
}

}  // namespace

const char* outcome_name(Outcome outcome) {
    return outcome == Outcome::kPass ? "PASS" : outcome == Outcome::kFail ? "FAIL" : "SKIP";
}

Check run_check(const std::string& layer, const std::string& name, const std::function<Verdict()>& body) {
    using Clock = std::chrono::steady_clock;
    const Clock::time_point start = Clock::now();
    Check check{layer, name, 0, verdict_of(body)};
    check.seconds = std::chrono::duration<double>(Clock::now() - start).count();
    return check;
}

std::size_t count_of(const std::vector<Check>& checks, Outcome outcome) {
    return static_cast<std::size_t>(
        std::count_if(checks.begin(), checks.end(), [&](const Check& c) { return c.verdict.outcome == outcome; }));
}

std::string check_lines(const Check& c) {
    std::string lines = fmt::format("{}  {:<9} {:<46} {:6.2f} s  {}\n", outcome_name(c.verdict.outcome), c.layer,
                                    c.name, c.seconds, c.verdict.told);
    if (c.verdict.outcome != Outcome::kFail) return lines;
    const Fault& f = c.verdict.fault;
    lines += indented("where", f.where) + indented("expected", f.expected) + indented("got", f.got) +
             indented("build options", f.options);
    for (const std::string& remedy : f.remedies) lines += indented(&remedy == &f.remedies.front() ? "try" : "", remedy);
    return lines;
}

nlohmann::ordered_json to_json(const Check& c) {
    nlohmann::ordered_json json = {{"layer", c.layer},
                                   {"name", c.name},
                                   {"status", outcome_name(c.verdict.outcome)},
                                   {"seconds", c.seconds},
                                   {"told", c.verdict.told}};
    if (c.verdict.outcome != Outcome::kFail) return json;
    const Fault& f = c.verdict.fault;
    json["where"] = f.where;
    json["expected"] = f.expected;
    json["got"] = f.got;
    json["build_options"] = f.options;
    json["remedies"] = f.remedies;
    return json;
}

}  // namespace raya
