#include "host/verify/reproduce.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <map>
#include <tuple>
#include <vector>

#include "host/base/temporary_folder.hpp"
#include "host/base/whole_file.hpp"
#include "host/cl/device.hpp"
#include "host/error.hpp"
#include "host/verify/case_files.hpp"
#include "host/verify/rerun.hpp"

namespace raya {
namespace {

namespace fs = std::filesystem;

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
    all.back().environment["RAYA_BUILD_OPTIONS"] = with_build_option("-cl-opt-disable");
    for (std::size_t i = 0; i < all_devices().size(); ++i) {
        all.push_back(failing);
        all.back().selector = std::to_string(i);
        all.back().name = device_info(all_devices()[i]).name;
    }
    return all;
}

[[noreturn]] void no_case(const Check& check, const std::string& reason) {
    throw UserError(fmt::format("--reproduce: no case of '{} {}': {}", check.layer, check.name, reason));
}

// Copies the outputs of the reference's step to NAME.expected, unless the captured outputs are equal.
void take_expected(const fs::path& folder, const fs::path& reference,
                   const std::map<std::string, std::string>& stable) {
    for (const auto& [name, hash] : stable) {
        const std::string right = read_file(reference / (name + ".out"));
        if (right != read_file(folder / (name + ".out"))) write_whole_file(folder / (name + ".expected"), right);
    }
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
        std::map<std::string, std::string> stable;
        for (const auto& [name, hash] : first.steps[step - 1].outputs)
            if (second.steps[step - 1].outputs.at(name) == hash) stable[name] = hash;
        take_expected(folder, scratch.path(), stable);
        return {step, reference.name};
    }
    no_case(check, any_passes
                       ? "every kernel launch gives the results of the reference, so the fault is in a transfer"
                       : "the check fails with every reference: raya's own kernels, -cl-opt-disable and the other "
                         "devices of this computer; start with a failing check of number or geometry");
}

// Returns the nearest existing folder in which the folder is, or would be.
fs::path existing_folder_above(const fs::path& folder) {
    fs::path above = fs::absolute(folder / "").parent_path().parent_path();
    while (!fs::exists(above)) above = above.parent_path();
    return above;
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
    const CheckRun failing{"", selector, settings_of_one(settings, check.layer + " " + check.name)};
    const TemporaryFolder scratch((existing_folder_above(folder) / "raya-case").string());
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
    return fmt::format("{}: a case of '{} {}', {}; make -C {} && {}/repro\n", folder.string(), check.layer, check.name,
                       seen.steps.at(step - 1).name, folder.string(), folder.string());
}

}  // namespace raya
