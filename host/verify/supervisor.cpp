#include "host/verify/supervisor.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <optional>

#include "host/base/child_process.hpp"
#include "host/base/json.hpp"
#include "host/base/log.hpp"
#include "host/cl/capture.hpp"
#include "host/error.hpp"

namespace raya {
namespace {

// Calls visit(name, member) for the members that the process of the checks needs.
template <class Settings, class Visit>
void for_each_setting(Settings& s, const Visit& visit) {
    visit("depth", s.depth);
    visit("kernel_dir", s.sources.folder);
    visit("build_options", s.sources.more_options);
    visit("filter", s.filter);
    visit("only", s.only);
    visit("skip", s.skip);
    visit("shard", s.shard);
    visit("shards", s.shards);
    visit("repeat", s.repeat);
    visit("soak_s", s.soak_s);
    visit("seed", s.seed);
    visit("random", s.random);
    visit("random_first", s.random_first);
    visit("random_changes", s.random_changes);
    visit("lanes", s.lanes);
    visit("done", s.done);
}

// --- Functions of the child process

struct SelectedDevices {
    std::vector<cl::Device> devices;
    std::vector<std::string> left_out;  // one line for each unusable device
};

// Selects devices as described at supervise(). Throws DeviceError if no device matches.
SelectedDevices selected_devices(const std::string& selector, std::size_t index) {
    if (selector != "all") return {{choose_device(selector, index)}, {}};
    SelectedDevices selected;
    for (const cl::Device& device : all_devices()) {
        const DeviceInfo info = device_info(device);
        if (const std::string reason = unusable_reason(info); reason.empty())
            selected.devices.push_back(device);
        else
            selected.left_out.push_back(fmt::format("{} ({}): skipped: {}", info.name, info.platform, reason));
    }
    if (selected.devices.empty()) choose_device("");  // throws DeviceError with a remedy
    return selected;
}

// Throws UserError if --only selects no check.
void refuse_empty_selection(const cl::Device& device, const VerifySettings& settings) {
    if (!check_ids(device, settings).empty()) return;
    if (!settings.filter.empty() || !settings.skip.empty() || settings.shards > 1)
        throw UserError(fmt::format(
            "--gtest_filter, --only, --skip and --shard select no check of {}; --list prints the selected checks",
            device_info(device).name));
    throw UserError(fmt::format(
        "--only \"{}\": no check of {} has this text in its ID; the layers are number, geometry, machine and image; "
        "raya verify --list prints the IDs{}",
        settings.only, device_info(device).name, settings.depth == Depth::kFull ? "" : ", and --full has more"));
}

// --- In the parent process

// Runs the checks of one device, in as many processes as needed.
class Supervision {
  public:
    Supervision(const VerifySettings& settings, const SupervisorSink& sink) : settings_(settings), sink_(sink) {}

    /// Runs the remaining checks in a new process. Returns true if another process should continue.
    bool run_remaining(const std::string& selector, std::size_t index) {
        const std::size_t done_before = settings_.done;
        ended_ = false;
        VerifySettings remaining = settings_;
        if (settings_.soak_s > 0)
            remaining.soak_s = std::max(1e-3, settings_.soak_s - seconds_since(supervision_start_));
        const auto status = run_child(kVerifyTask, settings_json(remaining, selector, index), [&](const Json& line) {
            if (!line.is_null())
                take(line);
            else if (sink_.running && running_)
                sink_.running(running_->id(), check_seconds());
            return !running_ || settings_.timeout_s <= 0 || check_seconds() <= settings_.timeout_s;
        });
        if (!status) {
            finish(stopped_check(fmt::format("no result after {:.0f} s, so the process was ended", check_seconds())));
            return true;
        }
        if (ended_ && *status == 0) return false;
        refuse_without_device(*status);
        finish(stopped_check("ended by " + ending_text(*status)));
        return !ended_ && settings_.done > done_before;
    }

    DeviceChecks take_checks() { return std::move(all_); }

  private:
    double check_seconds() const { return seconds_since(start_); }

    void take(const Json& line) {
        if (find_member(line, "devices") && devices_ == 0) {  // else already reported by the first process
            devices_ = json_integer(line.at("devices"));
            all_ = from_json<DeviceChecks>(line.at("device"));
            all_.ids = json_strings(line.at("ids"));
            if (sink_.device) sink_.device(all_, json_strings(line.at("left_out")), devices_);
        }
        if (const Json* started = find_member(line, "started")) {
            running_ = Check{json_text(started->at("layer")), json_text(started->at("name")), 0, {}};
            start_ = Clock::now();
            if (sink_.running) sink_.running(running_->id(), 0);
        }
        if (const Json* check = find_member(line, "check")) finish(from_json<Check>(*check));
        ended_ = ended_ || find_member(line, "ended");
    }

    void finish(Check check) {
        if (check.verdict.outcome == Outcome::kFail) check.verdict.fault.remedies = remedies_of(check, settings_);
        settings_.done += running_.has_value();
        running_.reset();
        apply_expectations(check, settings_.expected_failures);
        all_.seconds += check.seconds;
        all_.checks.push_back(check);
        if (sink_.finished) sink_.finished(check);
    }

    // Throws an exception if a process has ended with the exit status `status` before it has found a device.
    void refuse_without_device(int status) const {
        if (devices_ != 0) return;
        if (WIFEXITED(status) && WEXITSTATUS(status) == kNotStarted)
            throw std::runtime_error(
                "cannot start a process for the checks: /proc/self/exe is not available; mount /proc");
        throw DeviceError(
            fmt::format("looking for devices: a driver ended the program by {}; remedy: exclude the driver "
                        "(OCL_ICD_VENDORS), or install a newer one",
                        ending_text(status)));
    }

    // Returns a failure of the check that was running when its process ended, or else of the device.
    Check stopped_check(const std::string& result) const {
        Check check{"device", ended_ ? "end_of_program" : "between_checks", 0, {}};
        std::string where = "in the driver, with no check running";
        if (running_) {
            check = *running_;
            check.seconds = check_seconds();
            where = "in the driver or its compiler, while this check ran";
        }
        check.verdict = failed(result, {.where = where});
        return check;
    }

    VerifySettings settings_;  // settings_.done counts the finished checks
    const SupervisorSink& sink_;
    DeviceChecks all_;
    std::size_t devices_ = 0;  // number of selected devices
    std::optional<Check> running_;
    Clock::time_point supervision_start_ = Clock::now();
    Clock::time_point start_;  // of the running check
    bool ended_ = false;       // the process has written {"ended": true}
};

}  // namespace

Json settings_json(const VerifySettings& settings, const std::string& selector, std::size_t index) {
    Json json = {{"device", selector}, {"index", index}};
    for_each_setting(settings, [&](const char* name, const auto& value) { json[name] = value; });
    return json;
}

DeviceChecks supervise(const std::string& selector, std::size_t index, const VerifySettings& settings,
                       const SupervisorSink& sink) {
    Supervision supervision(settings, sink);
    while (supervision.run_remaining(selector, index)) continue;
    return supervision.take_checks();
}

void run_checks(int pipe, const Json& request) {
    VerifySettings settings;
    for_each_setting(settings, [&](const char* name, auto& value) { request.at(name).get_to(value); });
    const std::string& selector = json_text(request.at("device"));
    const std::size_t index = json_integer(request.at("index"));
    const SelectedDevices selected = selected_devices(selector, index);
    if (settings.done == 0)
        for (const cl::Device& device : selected.devices) refuse_empty_selection(device, settings);
    const cl::Device& device = selected.devices.at(selector == "all" ? index : 0);
    const VerifySettings full{.depth = Depth::kFull, .sources = settings.sources};
    const DeviceInfo info = device_info(device);
    const DeviceChecks unchecked{info.name, info.platform, info.version, info.driver, info.pci_address};
    send_line(pipe, {{"devices", selected.devices.size()},
                     {"left_out", selected.left_out},
                     {"device", to_json(unchecked)},
                     {"ids", check_ids(device, full)}});
    std::optional<Capture> capture;
    if (const Json* c = find_member(request, "capture"))
        capture.emplace(json_integer(c->at("step")), json_text(c->at("folder")),
                        [&](const Json& line) { send_line(pipe, line); });
    const CheckSink sink{.started =
                             [&](const std::string& layer, const std::string& name) {
                                 send_line(pipe, {{"started", {{"layer", layer}, {"name", name}}}});
                             },
                         .finished =
                             [&](const Check& check) {
                                 send_line(pipe, {{"check", to_json(check)}});
                             }};
    verify(device, settings, sink);
    send_line(pipe, {{"ended", true}});
}

}  // namespace raya
