#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <map>
#include <sstream>
#include <tuple>
#include <utility>
#include <vector>

#include "host/base/child_process.hpp"
#include "host/base/json.hpp"
#include "host/base/log.hpp"
#include "host/base/whole_file.hpp"
#include "host/cl/device.hpp"
#include "host/cl/kernel_source.hpp"
#include "host/embedded.hpp"
#include "host/error.hpp"
#include "host/verify/random_kernel.hpp"
#include "host/verify/supervisor.hpp"
#include "host/version.hpp"

namespace raya {
namespace {

namespace fs = std::filesystem;

// How to run a check in a child process.
struct CheckRun {
    std::string name;         // for people: "-cl-opt-disable"
    std::string selector;     // of the device, as in choose_device()
    VerifySettings settings;  // select one check
};

// A build or a launch of a run; see Capture (host/cl/capture.hpp).
struct Step {
    std::string name;
    bool done = false;
    std::map<std::string, std::string> outputs{};  // hashes by argument
};

// One run of a check.
struct Observation {
    std::vector<Step> steps;   // steps[n - 1] is step n
    std::size_t expected = 0;  // step of which the check gave the correct words; 0: none
    bool passed = false;
    std::string result = "no result in time";  // of the check, or how its process ended
};

void take_line(Observation& seen, const Json& line) {
    if (find_member(line, "step")) seen.steps.push_back({json_text(line.at("name"))});
    if (find_member(line, "expected")) seen.expected = json_integer(line.at("expected"));
    if (const Json* check = find_member(line, "check")) {
        seen.passed = from_json<Check>(*check).verdict.outcome == Outcome::kPass;
        seen.result = from_json<Check>(*check).verdict.result;
    }
    if (!find_member(line, "done") || seen.steps.empty()) return;
    seen.steps.back().done = true;
    const Json& outputs = line.at("outputs");
    for (const auto& [name, hash] : outputs.items()) seen.steps.back().outputs[name] = json_text(hash);
}

// Runs the check of `v`. Captures step number `step`, if not 0, in `folder`. Ends the run after settings.timeout_s, or,
// if `ends_at_step`, when the inputs of the step have been captured.
Observation observe(const CheckRun& v, std::size_t step = 0, const std::filesystem::path& folder = {},
                    bool ends_at_step = false) {
    Json request = settings_json(v.settings, v.selector, 0);
    request["capture"] = {{"step", step}, {"folder", folder.string()}};
    Observation seen;
    const Clock::time_point start = Clock::now();
    try {
        const auto status = run_child(kVerifyTask, request, [&](const Json& line) {
            if (!line.is_null()) take_line(seen, line);
            const bool is_late = v.settings.timeout_s > 0 && seconds_since(start) > v.settings.timeout_s;
            return !is_late && !(ends_at_step && seen.steps.size() == step);
        });
        if (status && *status != 0) seen.result = ending_text(*status);
    } catch (const std::runtime_error&) {  // the run ends without a passed check
    }
    return seen;
}

// Moves options "-DNAME=VALUE" from `options` to the returned lines "#define NAME VALUE".
std::string take_definitions(std::string& options) {
    std::string lines, others;
    std::istringstream in(options);
    for (std::string option; in >> option;) {
        const std::size_t equals = option.find('=');
        if (!option.starts_with("-D")) {
            others += (others.empty() ? "" : " ") + option;
        } else if (equals == std::string::npos) {
            lines += fmt::format("#define {} 1\n", option.substr(2));
        } else {
            lines += fmt::format("#define {} {}\n", option.substr(2, equals - 2), option.substr(equals + 1));
        }
    }
    options = others;
    return lines;
}

std::string case_header(const Json& launch, const std::string& options, const std::string& device) {
    const bool is_build = find_member(launch, "kernel") == nullptr;
    std::string rows;
    if (!is_build)
        for (const Json& a : json_array(launch.at("arguments")))
            rows += fmt::format("    {{\"{}\", '{}', {}}},\n", json_text(a.at("name")), json_text(a.at("kind"))[0],
                                json_integer(a.at("bytes")));
    if (rows.empty()) rows = "    {\"\", 'l', 1},\n";
    return fmt::format(
        "#define KERNEL \"{}\"\n#define OPTIONS \"{}\"\n#define DEFAULT_DEVICE {}\n#define BUILD_FAILS {}\n"
        "#define GROUPS {}\n#define GROUP_SIZE {}\n\n"
        "/* The kernel's arguments. kind: 'b' buffer, 'v' value, 'l' local memory */\n"
        "static const struct argument {{\n    const char* name;\n    char kind;\n    size_t bytes;\n}} arguments[] = "
        "{{\n{}}};\n",
        is_build ? "" : json_text(launch.at("kernel")), options, json_dump(device), is_build ? 1 : 0,
        is_build ? 1 : json_integer(launch.at("groups")), is_build ? 1 : json_integer(launch.at("group_size")), rows);
}

// Returns the number of the first step whose outputs differ from those of the reference; 0: none. Ignores outputs that
// differ between two runs of the reference.
std::size_t first_difference(const Observation& failing, const Observation& reference, const Observation& repeated) {
    const std::size_t steps = std::min({failing.steps.size(), reference.steps.size(), repeated.steps.size()});
    for (std::size_t n = 0; n < steps; ++n)
        for (const auto& [name, hash] : reference.steps[n].outputs) {
            const auto got = failing.steps[n].outputs.find(name), again = repeated.steps[n].outputs.find(name);
            if (got == failing.steps[n].outputs.end() || again == repeated.steps[n].outputs.end()) continue;
            if (again->second == hash && got->second != hash) return n + 1;
        }
    return 0;
}

std::vector<CheckRun> references(const CheckRun& failing) {
    std::vector<CheckRun> all;
    if (!failing.settings.sources.folder.empty()) {
        all.push_back(failing);
        all.back().name = "raya's own kernels";
        all.back().settings.sources.folder.clear();
    }
    all.push_back(failing);
    all.back().name = "-cl-opt-disable";
    all.back().settings.sources.more_options.emplace_back(all.back().name);
    for (std::size_t i = 0; i < all_devices().size(); ++i) {
        all.push_back(failing);
        all.back().selector = std::to_string(i);
        all.back().name = device_info(all_devices()[i]).name;
    }
    return all;
}

[[noreturn]] void no_case(const Check& check, const std::string& reason) {
    throw UserError(fmt::format("--reproduce: no case of {}: {}", check.id(), reason));
}

// Captures the first step with wrong outputs in `folder`. Returns the number of the step and the name of the reference.
std::pair<std::size_t, std::string> capture_wrong_step(const CheckRun& failing, const Observation& seen,
                                                       const Check& check, const fs::path& folder) {
    if (seen.expected != 0) {
        observe(failing, seen.expected, folder);
        return {seen.expected, "the check's known results"};
    }
    const TemporaryFolder scratch("raya-reference");
    bool any_passes = false;
    for (const CheckRun& reference : references(failing)) {
        const Observation first = observe(reference), second = observe(reference);
        if (!first.passed || !second.passed) continue;
        any_passes = true;
        const std::size_t step = first_difference(seen, first, second);
        if (step == 0) continue;
        observe(failing, step, folder);
        observe(reference, step, scratch.path());
        for (const auto& [name, hash] : first.steps[step - 1].outputs) {
            if (second.steps[step - 1].outputs.at(name) != hash) continue;
            const std::string right = read_file(scratch.path() / (name + ".out"));
            if (right != read_file(folder / (name + ".out"))) write_whole_file(folder / (name + ".expected"), right);
        }
        return {step, reference.name};
    }
    no_case(check, any_passes
                       ? "every kernel launch gives the results of the reference, so the fault is in a transfer"
                       : "the check fails with every reference: raya's own kernels, -cl-opt-disable and the other "
                         "devices of this computer; start with a failing check of number or geometry");
}

// Makes the run of a check of random kernels that of one kernel, reduced as long as it fails in the same way.
void reduce_random_kernel(CheckRun& failing, const Check& check) {
    VerifySettings& s = failing.settings;
    std::uint32_t end = 0;
    if (std::sscanf(check.name.c_str(), "seed_%" SCNu64 "_kernels_%" SCNu32 "_to_%" SCNu32, &s.seed, &s.random_first,
                    &end) != 3)
        return;
    s.filter.clear();
    Observation first;
    for (std::uint32_t n = s.random_first; n <= end && (first.steps.empty() || first.passed); ++n) {
        s.random_first = n;
        s.random = n + 1;
        first = observe(failing);
    }
    if (first.passed || first.result == Observation{}.result) return;  // each trial would take the whole time limit
    log_message(kDefaultVerbosity, fmt::format("reducing kernel {} ({}) ...", s.random_first, first.result));
    const RandomKernel kernel = random_kernel(s.seed, s.random_first);
    const Clock::time_point start = Clock::now();
    const auto changes = reducing_changes(kernel, [&](const auto& tried, const RandomKernel&) {
        s.random_changes = tried;
        return observe(failing).result == first.result;
    });
    s.random_changes = changes;
    log_message(kDefaultVerbosity,
                fmt::format("reduced from {} to {} statements and expressions in {:.0f} s", size_of(kernel),
                            size_of(random_kernel(s.seed, s.random_first, changes)), seconds_since(start)));
}

// Returns the nearest existing folder in which the folder is, or would be.
fs::path existing_folder_above(const fs::path& folder) {
    fs::path above = fs::absolute(folder / "").parent_path().parent_path();
    while (!fs::exists(above)) above = above.parent_path();
    return above;
}

/// Adds the host program, its header, Makefile and README to the captured files in `folder`. `step`: name of the
/// captured step; `reference`: source of the expected words; `kernels`: folder of the kernels, empty for raya's own.
/// With other kernels, also writes raya's own kernel, right.cl. Throws UserError.
void write_case(const fs::path& folder, const DeviceChecks& device, const Check& check, const std::string& step,
                const std::string& reference, const fs::path& kernels) {
    const Json launch = parse_json(read_file(folder / "launch.json"), {"launch.json"});
    std::string options = json_text(launch.at("options"));
    remove_il_option(options);  // the case builds the source
    const std::string definitions = take_definitions(options), program = json_text(launch.at("program"));
    if (!kernels.empty() && embedded_files().contains("kernels/" + program))
        write_whole_file(folder / "right.cl", kernel_source(program));
    for (const char* const name : {"kernel.cl", "right.cl"})
        if (fs::exists(folder / name)) write_whole_file(folder / name, definitions + read_file(folder / name));
    write_whole_file(folder / "case.h", case_header(launch, options, device.platform + ": " + device.name));
    for (const char* const name : {"repro.c", "Makefile", "reduce.sh"})
        write_whole_file(folder / name, embedded_files().at(std::string("host/verify/case/") + name));
    const std::string right = fs::exists(folder / "right.cl")
                                  ? " right.cl: raya's own kernel; `./repro right.cl` ends with exit code 0."
                                  : "";
    write_whole_file(
        folder / "README.md",
        fmt::format(R"(# {}: a case for a bug report

{}

| | |
|---|---|
| device | {} ({}) |
| version, driver | {}, {} |
| step of the check | {} |
| build options | `{}` |
| source of the expected words | {} |
| made by | {} |

    make && ./repro          exit code 0: right; 1: wrong; 125: cannot tell (no such device, the build fails, ...)
    git bisect run sh -c 'BUILD-THE-DRIVER && CASE/repro'       finds the commit of a driver that broke it
    make reduce              reduced.cl: a smaller kernel that still fails; needs cvise and oclgrind

kernel.cl: the kernel with its included files. NAME.in: inputs; NAME.expected: correct outputs, compared where NAME.mask,
if there is one, is not 0 (2: every NaN is correct); NAME.out: outputs of the failing device. NAME is argN_BUFFER for
argument N. case.h: work-groups and sizes.{}
)",
                    check.id(), check.verdict.result, device.name, device.platform, device.version, device.driver, step,
                    json_text(launch.at("options")), reference, name_and_version(), right));
    fs::remove(folder / "launch.json");
}

}  // namespace

void check_case_folder(const fs::path& folder) {
    const bool exists = fs::exists(folder);
    if (exists && !(fs::is_directory(folder) && fs::is_empty(folder)))
        throw UserError(
            fmt::format("--reproduce {}: is not an empty folder; remedy: name a new folder", folder.string()));
    const fs::path above = existing_folder_above(folder);
    if (!fs::is_directory(above) || ::access(above.c_str(), W_OK | X_OK) != 0)
        throw UserError(fmt::format("--reproduce {}: cannot be made: no permission to write to '{}'", folder.string(),
                                    above.string()));
}

std::string reproduce(const std::string& selector, const DeviceChecks& device, const VerifySettings& settings,
                      const Check& check, const fs::path& folder) {
    check_case_folder(folder);
    CheckRun failing{"", selector, settings_of_one(settings, check.id())};
    const TemporaryFolder scratch((existing_folder_above(folder) / "raya-case").string());
    if (check.layer == "random") reduce_random_kernel(failing, check);
    const Observation seen = observe(failing);
    if (seen.passed) no_case(check, "it passes when it runs alone");
    if (seen.steps.empty()) no_case(check, "it fails before the first build of a kernel");
    std::size_t step = seen.steps.size();
    std::string reference = "none: the step fails";
    if (seen.steps.back().done)
        std::tie(step, reference) = capture_wrong_step(failing, seen, check, scratch.path());
    else
        observe(failing, step, scratch.path(), true);
    write_case(scratch.path(), device, check, seen.steps.at(step - 1).name, reference, settings.sources.folder);
    fs::permissions(scratch.path(), fs::perms::owner_all | fs::perms::group_read | fs::perms::group_exec |
                                        fs::perms::others_read | fs::perms::others_exec);
    fs::remove(folder);  // an empty folder
    fs::create_directories(fs::absolute(folder / "").parent_path().parent_path());
    fs::rename(scratch.path(), folder);
    return fmt::format("{}: a case of {}, {}; make -C {} && {}/repro\n", folder.string(), check.id(),
                       seen.steps.at(step - 1).name, folder.string(), folder.string());
}

}  // namespace raya
