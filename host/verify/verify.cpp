#include "host/verify/verify.hpp"

#include <fmt/core.h>
#include <fnmatch.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <sstream>
#include <utility>

#include "host/base/encoding.hpp"
#include "host/base/log.hpp"
#include "host/base/whole_file.hpp"
#include "host/cl/kernel_source.hpp"
#include "host/cl/program.hpp"
#include "host/error.hpp"
#include "host/scene/split_mix.hpp"
#include "host/version.hpp"

namespace raya {
namespace {

// Begins the result of a check that an exception other than DeviceError has stopped.
constexpr const char* kCheckStopped = "the check stopped with an error: ";

// Texts, and a remedy for failures whose result contains one of them.
const std::pair<std::vector<const char*>, const char*> kKnownCauses[] = {
    {{"allocating buffer", "allows", "local memory", "CL_MEM_OBJECT_ALLOCATION_FAILURE", "CL_OUT_OF_", "bad_alloc"},
     "out of memory: end other programs that use this device or this machine, and run verify again"},
    {{"SIGKILL"}, "the system may have run out of memory and ended the process: see dmesg"},
    {{"CL_DEVICE_NOT_AVAILABLE", "CL_CONTEXT_TERMINATED", "CL_COMMAND_TERMINATED", "CL_EXEC_STATUS_ERROR",
      "illegal read or write"},
     "the device was lost: check whether raya devices still lists it, and look for the cause in the system's log "
     "(dmesg); another program, or a limit on the run time of a kernel, may have caused it"},
    {{"building program", "CL_INVALID_BUILD_OPTIONS"},
     "see the build log above; report the error to the compiler's vendor"},
    {{"no result after"}, "--timeout SECONDS, if the device or its compiler is slow"},
    {{"SIGILL"}, "the kernels were compiled for another processor: look for an option of the driver"},
    {{kCheckStopped}, "if no earlier check fails, this is an internal error of raya: report it"}};

// Returns a line "      LABEL         TEXT" for each line of `text`; the label is only in the first line.
std::string indented(const std::string& label, const std::string& text) {
    constexpr int kLabel = 14;
    if (text.empty()) return {};
    std::string all, line, head = label;
    for (std::istringstream in(text); std::getline(in, line); head.clear())
        all += fmt::format("      {:<{}}{}\n", head, kLabel, line);
    return all;
}

// Returns the text in lower case, with _ for each run of other characters than letters, digits and *.
std::string id_text(const std::string& text) {
    std::string id;
    for (const char c : text)
        if (std::isalnum(static_cast<unsigned char>(c)) || c == '*')
            id += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
        else if (!id.ends_with('_'))
            id += '_';
    return id;
}

void visit_layers(Verification& verification) {
    if (verification.settings().random > 0) return verify_random(verification);
    verify_numbers(verification);
    verify_geometry(verification);
    verify_machines(verification);
    verify_images(verification);
}

// Runs random checks with random numbers of lanes for settings.soak_s seconds, without the first settings.done.
void verify_at_random(const cl::Device& device, const VerifySettings& settings, const CheckSink& sink) {
    std::vector<VerifySettings> choices;
    std::vector<std::uint32_t> lanes_choices = {1, 4, 8, 16};
    if (settings.lanes != 0) lanes_choices = {settings.lanes};
    for (const std::uint32_t lanes : lanes_choices) {
        VerifySettings all = settings;
        all.lanes = lanes;
        for (const std::string& id : check_ids(device, all)) choices.push_back(settings_of_one(all, id));
    }
    if (settings.only.empty() && settings.skip.empty()) {
        choices.push_back(settings_of_one(settings, ""));
        choices.back().random = kRandomBatch;
    }
    SplitMix random(settings.seed);
    const Clock::time_point start = Clock::now();
    for (std::size_t n = 0; seconds_since(start) < settings.soak_s; ++n) {
        VerifySettings one = choices[random.next() % choices.size()];
        if (one.random > 0) one.seed = random.next() % 1'000'000;
        if (n < settings.done) continue;
        verify(device, one, {.started = sink.started, .finished = [&](Check check) {
                                 if (one.lanes != 0) check.verdict.result += fmt::format(", --lanes {}", one.lanes);
                                 sink.finished(check);
                             }});
    }
}

}  // namespace

const char* outcome_name(Outcome outcome) {
    return std::array{"PASS", "FAIL", "SKIP", "XFAIL", "XPASS"}[static_cast<std::size_t>(outcome)];
}

bool id_matches(const std::string& id, const std::string& pattern) {
    return ::fnmatch(("*" + id_text(pattern) + "*").c_str(), id_text(id).c_str(), 0) == 0;
}

bool passes_filter(const std::string& id, const std::string& filter) {
    const auto any_matches = [&](const std::string& patterns) {
        return std::ranges::any_of(split(patterns, ':'), [&](const std::string& pattern) {
            return pattern.find('[') == pattern.npos && ::fnmatch(pattern.c_str(), id.c_str(), FNM_NOESCAPE) == 0;
        });
    };
    const std::size_t dash = filter.find('-');
    const std::string wanted = filter.substr(0, dash);
    return (wanted.empty() || any_matches(wanted)) && (dash == filter.npos || !any_matches(filter.substr(dash + 1)));
}

void apply_expectations(Check& check, const std::vector<ExpectedFailure>& expected_failures) {
    Verdict& v = check.verdict;
    if (v.outcome == Outcome::kSkip) return;
    for (const ExpectedFailure& e : expected_failures) {
        if (!id_matches(check.id(), e.pattern)) continue;
        const std::string why = e.link.empty() ? e.reason : e.reason + ", " + e.link;
        const bool passes = v.outcome == Outcome::kPass;
        v.outcome = passes ? Outcome::kUnexpectedPass : Outcome::kExpectedFail;
        v.result = passes ? fmt::format("passed, but --expect lists it as failing ({}): {}", why, v.result)
                          : fmt::format("{} (expected: {})", v.result, why);
        return;
    }
}

Check run_check(const std::string& layer, const std::string& name, const std::function<Verdict()>& body) {
    const Clock::time_point start = Clock::now();
    Check check{layer, name, 0, {}};
    const auto fail = [&](const std::string& message) {
        const std::size_t end = message.find('\n');
        check.verdict = failed(message.substr(0, end), {.where = end == message.npos ? "" : message.substr(end + 1)});
    };
    try {
        check.verdict = body();
    } catch (const DeviceError& error) {
        fail(error.what());
    } catch (const std::exception& error) {
        fail(std::string(kCheckStopped) + error.what());
    }
    check.seconds = seconds_since(start);
    return check;
}

std::vector<std::string> remedies_of(const Check& check, const VerifySettings& settings) {
    if (!settings.sources.folder.empty())
        return {"run raya verify without --kernel-dir; if it passes, these kernels are wrong"};
    std::vector<std::string> all;
    if (uses_il()) all.emplace_back("run raya verify without --il; if it passes, the SPIR-V is the cause");
    const auto is_in_result = [&](const char* text) { return check.verdict.result.find(text) != std::string::npos; };
    for (const auto& [texts, remedy] : kKnownCauses)
        if (std::ranges::any_of(texts, is_in_result)) all.emplace_back(remedy);
    if (check.layer != "number")
        all.emplace_back("start with the first check that fails: the others rely on what it checks");
    if (settings.lanes != 1) all.emplace_back("run raya verify --lanes 1; if it passes, render with --lanes 1");
    if (user_build_options().find("-cl-opt-disable") == std::string::npos)
        all.emplace_back("RAYA_BUILD_OPTIONS=-cl-opt-disable raya verify: compiles without optimisation");
    all.emplace_back("a newer driver, or another OpenCL implementation for this device (raya devices)");
    return all;
}

std::size_t count_of(const std::vector<Check>& checks, Outcome outcome) {
    const auto outcome_of = [](const Check& check) { return check.verdict.outcome; };
    return static_cast<std::size_t>(std::ranges::count(checks, outcome, outcome_of));
}

std::string check_lines(const Check& c) {
    std::string lines = fmt::format("{:<5} {:<50} {:6.2f} s  {}\n", outcome_name(c.verdict.outcome), c.id(), c.seconds,
                                    c.verdict.result);
    if (c.verdict.outcome != Outcome::kFail) return lines;
    const Fault& f = c.verdict.fault;
    lines += indented("where", f.where) + indented("expected", f.expected) + indented("got", f.got) +
             indented("build options", f.options);
    for (const std::string& remedy : f.remedies) lines += indented(&remedy == &f.remedies.front() ? "try" : "", remedy);
    return lines;
}

void members_of(Members& m, Check& c) {
    std::string status = outcome_name(c.verdict.outcome);
    m("layer", c.layer, "number, geometry, machine or image; `device` if it crashed while no check ran.");
    m("name", c.name, "Name of the check. Its ID is LAYER.NAME; `--only LAYER.NAME` runs it.");
    m("status", status,
      "`PASS`, `FAIL`, `SKIP`, or with --expect `XFAIL` (failed as listed), `XPASS` (passed although listed).");
    m("seconds", c.seconds, "Time of the check, including kernel builds, s.");
    m("result", c.verdict.result, "One line: what was compared, why it was skipped, or what is wrong.");
    for (const Outcome outcome : {Outcome::kFail, Outcome::kSkip, Outcome::kExpectedFail, Outcome::kUnexpectedPass})
        if (status == outcome_name(outcome)) c.verdict.outcome = outcome;
    const bool failed = c.verdict.outcome == Outcome::kFail || c.verdict.outcome == Outcome::kExpectedFail;
    Fault& f = c.verdict.fault;
    m.when(failed, "where", f.where, "Failed check: first wrong operation, ray, word or pixel, or empty.");
    m.when(failed, "expected", f.expected, "Bits of the expected result, and their meaning.");
    m.when(failed, "got", f.got, "Bits of the computed result, and their meaning.");
    m.when(failed, "build_options", f.options, "Options of the kernel compiler.");
    m.when(failed, "remedies", f.remedies, "Remedies to try, the most promising first.");
}

const char* depth_name(Depth depth) { return std::array{"brief", "quick", "full"}[static_cast<std::size_t>(depth)]; }

Verification::Verification(const cl::Device& device, const VerifySettings& settings, const CheckSink& sink, bool runs)
    : device_(device), info_(device_info(device)), settings_(settings), sink_(sink), runs_(runs) {
    check_patches(settings.sources);  // otherwise a patch that does not apply would look like a detected fault
}

void Verification::check(const std::string& layer, const std::string& text,
                         const std::function<Verdict(Session&)>& body, std::uint32_t group_size) {
    const std::string name = id_text(text), id = layer + "." + name;
    if (!passes_filter(id, settings_.filter) || !id_matches(id, settings_.only)) return;
    if (!settings_.skip.empty() && id_matches(id, settings_.skip)) return;
    if (selected_++ % settings_.shards != settings_.shard - 1) return;
    ids_.push_back(id);
    if (!runs_ || ids_.size() <= settings_.done) return;
    if (sink_.started) sink_.started(layer, name);
    checks_.push_back(run_check(layer, name, [&] {
        if (group_size > info_.max_group_size)
            return skipped(
                fmt::format("needs groups of {} work-items, the device allows {}", group_size, info_.max_group_size));
        for (std::uint32_t run = 1;; ++run) {
            Session session(device_);
            Verdict verdict = body(session);
            session.finish();
            if (settings_.repeat > 1 && verdict.outcome == Outcome::kFail)
                verdict.result += fmt::format(" (in run {} of {})", run, settings_.repeat);
            if (run == settings_.repeat || verdict.outcome != Outcome::kPass) return verdict;
        }
    }));
    if (sink_.finished) sink_.finished(checks_.back());
}

std::vector<std::uint32_t> Verification::lanes() const {
    if (full() && settings_.lanes == 0) return {1, 4, 8, 16};
    return {lanes_or_default()};
}

std::string Verification::lanes_text(std::uint32_t lanes_of_check) const {
    return lanes().size() > 1 ? ", " + counted(lanes_of_check, "lane") : "";
}

VerifySettings settings_of_one(VerifySettings settings, const std::string& id) {
    settings.filter = id;
    settings.only.clear();
    settings.skip.clear();
    settings.shard = settings.shards = settings.repeat = 1;
    settings.done = 0;
    settings.soak_s = 0;
    return settings;
}

std::vector<Check> verify(const cl::Device& device, const VerifySettings& settings, const CheckSink& sink) {
    if (settings.soak_s > 0) return verify_at_random(device, settings, sink), std::vector<Check>();
    Verification verification(device, settings, sink);
    visit_layers(verification);
    return verification.take_checks();
}

std::vector<std::string> check_ids(const cl::Device& device, const VerifySettings& settings) {
    Verification verification(device, settings, {}, false);
    visit_layers(verification);
    return verification.take_ids();
}

void members_of(Members& m, DeviceChecks& device) {
    const auto count = [&](Outcome outcome) { return count_of(device.checks, outcome); };
    device_members(m, device);
    m.when(!device.pci_address.empty(), "pci_address", device.pci_address, "With cl_khr_pci_bus_info.");
    m("right", device.all_passed(), "True if each check had the expected outcome.");
    m("passed", count(Outcome::kPass), "Number of passed checks.");
    m("failed", count(Outcome::kFail), "Number of failed checks.");
    m("skipped", count(Outcome::kSkip), "Number of checks that the device does not support.");
    m("failed_as_expected", count(Outcome::kExpectedFail), "Number of checks that failed as --expect says.");
    m("passed_unexpectedly", count(Outcome::kUnexpectedPass), "Number of passed checks that --expect lists.");
    m("seconds", device.seconds, "Sum of the times of all checks, s.");
    m("checks", device.checks, "Checks in the order of execution.");
}

void members_of(Members& m, const VerifyReport& report) {
    m("kind", kVerifyReportKind, "Identifies the report: `raya verify`.");
    m("program", name_and_version(), "raya and its version.");
    m("depth", depth_name(report.depth), "Extent of the checks: `brief`, `quick` or `full`.");
    m("devices", report.devices, "Checked devices.");
}

namespace {

std::string trimmed(const std::string& text) {
    const std::size_t first = text.find_first_not_of(" \t\r");
    return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

// Returns the text with XML's special characters replaced, and without what XML 1.0 does not allow: control characters
// and bytes that are not UTF-8, which Json::dump() replaces.
std::string xml_text(const std::string& text) {
    std::string all = json_text(parse_json(json_dump(text), {"a text"}));
    for (const auto& [character, entity] :
         {std::pair{"&", "&amp;"}, {"<", "&lt;"}, {">", "&gt;"}, {"\"", "&quot;"}, {"\n", "&#10;"}})
        all = replaced(all, character, entity);
    std::ranges::replace_if(
        all, [](unsigned char c) { return c < 0x20; }, ' ');
    return all;
}

std::string junit_case(const Check& check) {
    const Verdict& v = check.verdict;
    std::string text =
        fmt::format("    <testcase classname=\"raya\" name=\"{}\" time=\"{:.3f}\"", check.id(), check.seconds);
    if (is_unwanted(v.outcome))
        return text + fmt::format(">\n      <failure message=\"{}\">{}</failure>\n    </testcase>\n",
                                  xml_text(v.result), xml_text(check_lines(check)));
    if (v.outcome == Outcome::kSkip || v.outcome == Outcome::kExpectedFail)
        return text + fmt::format(">\n      <skipped message=\"{}\"/>\n    </testcase>\n", xml_text(v.result));
    return text + "/>\n";
}

std::string contents_of(const std::filesystem::path& path) {
    try {
        return path.empty() ? "" : read_input(path);
    } catch (const UnreadableFile& error) {
        throw UserError(fmt::format("--expect {}: cannot be read: {}", path.string(), error.what()));
    }
}

// Returns the number of checks with one of two outcomes.
std::size_t sum_of(const DeviceChecks& device, Outcome a, Outcome b) {
    return count_of(device.checks, a) + count_of(device.checks, b);
}

}  // namespace

std::vector<ExpectedFailure> read_expected_failures(const std::filesystem::path& path) {
    std::istringstream text(contents_of(path));
    std::vector<ExpectedFailure> failures;
    std::size_t number = 0;
    for (std::string line; std::getline(text, line);) {
        ++number;
        if (trimmed(line).empty() || trimmed(line).starts_with('#')) continue;
        std::vector<std::string> fields;
        for (const std::string& field : split(line, '|')) fields.push_back(trimmed(field));
        if (fields.size() < 2 || fields.size() > 3 || fields[0].empty() || fields[1].empty())
            throw UserError(
                fmt::format("{}:{}: expected PATTERN | REASON or PATTERN | REASON | LINK", path.string(), number));
        failures.push_back(
            {fmt::format("{}:{}", path.string(), number), fields[0], fields[1], fields.size() > 2 ? fields[2] : ""});
    }
    return failures;
}

std::vector<std::string> unmatched_patterns(const std::vector<ExpectedFailure>& failures,
                                            const std::vector<DeviceChecks>& devices) {
    std::vector<std::string> warnings;
    for (const ExpectedFailure& e : failures) {
        const auto is_matched = [&](const DeviceChecks& device) {
            return std::ranges::any_of(device.ids, [&](const auto& id) { return id_matches(id, e.pattern); }) ||
                   std::ranges::any_of(device.checks, [&](const Check& c) { return id_matches(c.id(), e.pattern); });
        };
        if (std::ranges::none_of(devices, is_matched))
            warnings.push_back(fmt::format("{}: \"{}\" matches no check", e.place, e.pattern));
    }
    return warnings;
}

std::string junit_report(const std::string& command, const std::vector<DeviceChecks>& devices) {
    std::string text =
        fmt::format("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites name=\"{}\">\n", xml_text(command));
    for (const DeviceChecks& device : devices) {
        text += fmt::format(
            "  <testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" errors=\"0\" skipped=\"{}\" time=\"{:.3f}\">\n"
            "    <properties>\n      <property name=\"platform\" value=\"{}\"/>\n"
            "      <property name=\"driver\" value=\"{}\"/>\n    </properties>\n",
            xml_text(device.name), device.checks.size(), sum_of(device, Outcome::kFail, Outcome::kUnexpectedPass),
            sum_of(device, Outcome::kSkip, Outcome::kExpectedFail), device.seconds, xml_text(device.platform),
            xml_text(device.driver));
        for (const Check& check : device.checks) text += junit_case(check);
        text += "  </testsuite>\n";
    }
    return text + "</testsuites>\n";
}

}  // namespace raya
