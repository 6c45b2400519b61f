#include "host/verify/supervisor.hpp"

#include <fmt/core.h>
#include <sys/wait.h>

#include <chrono>
#include <csignal>
#include <optional>

#include "host/base/json.hpp"
#include "host/base/own_process.hpp"
#include "host/error.hpp"

namespace raya {
namespace {

using Clock = std::chrono::steady_clock;

std::vector<std::string> remedies(const std::string& full_name, int status, const VerifySettings& settings) {
    std::vector<std::string> all;
    const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
    if (signal == SIGKILL) all.emplace_back("is memory short? the system ends what takes most: see dmesg");
    if (signal == SIGILL)
        all.emplace_back("kernels are compiled for another processor than this: look for an option of the driver");
    if (!full_name.empty() && settings.only != full_name)
        all.push_back(fmt::format("raya verify --only \"{}\": does it end by itself too?", full_name));
    if (settings.lanes != 1) all.emplace_back("raya verify --lanes 1: compilers end less often with one lane");
    for (const std::string& remedy : compiler_remedies()) all.push_back(remedy);
    return all;
}

// The checks of one device, of as many processes as it takes.
class Supervision {
  public:
    Supervision(const VerifySettings& settings, const SupervisorSink& sink) : settings_(settings), sink_(sink) {}

    /// Runs the checks that are left. Whether another process may end more of them.
    bool run_rest(std::vector<std::string> arguments, std::size_t index) {
        arguments.insert(arguments.end(), {"--worker-device", std::to_string(index), "--worker-done"});
        arguments.push_back(std::to_string(done_));
        const std::size_t before = done_;
        ended_ = false;
        OwnProcess process(arguments);
        for (std::string line;;) {
            const OwnProcess::Read read = process.read(line, std::chrono::seconds(1));
            if (read == OwnProcess::Read::kEnd) break;
            if (read == OwnProcess::Read::kLine)
                take(Json::parse(line, {"the process of the checks"}));
            else if (sink_.running && running_)
                sink_.running(running_->layer, running_->name, seconds());
        }
        const int status = process.wait();
        if (ended_ && status == 0) return false;
        finish(broken(status));
        return !ended_ && done_ > before;
    }

    DeviceChecks take_checks() { return std::move(all_); }
    std::size_t devices() const { return devices_; }

  private:
    struct Running {
        std::string layer, name;
    };

    double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

    void take(const Json& line) {
        if (const Json* error = line.find("error")) refuse(line.at("kind").text(), error->text());
        if (line.find("devices")) take_device(line);
        if (const Json* started = line.find("started")) {
            running_ = Running{started->at("layer").text(), started->at("name").text()};
            start_ = Clock::now();
        }
        if (const Json* check = line.find("check")) finish(check_of(*check));
        ended_ = ended_ || line.find("ended");
    }

    [[noreturn]] static void refuse(const std::string& kind, const std::string& error) {
        if (kind == "user") throw UserError(error);
        if (kind == "device") throw DeviceError(error);
        throw std::runtime_error(error);
    }

    void take_device(const Json& line) {
        if (devices_ > 0) return;  // of the processes after the first
        devices_ = line.at("devices").whole();
        all_.name = line.at("name").text();
        all_.platform = line.at("platform").text();
        all_.version = line.at("version").text();
        all_.driver = line.at("driver").text();
        if (sink_.device) sink_.device(all_, line.at("left_out").texts());
    }

    void finish(Check check) {
        if (!settings_.sources.folder.empty())
            check.verdict.fault.remedies = {
                "raya verify without --kernel-dir: does it pass? then these kernels are wrong"};
        done_ += running_.has_value();
        running_.reset();
        all_.seconds += check.seconds;
        all_.checks.push_back(check);
        if (sink_.finished) sink_.finished(check);
    }

    // The check that a process which has ended too soon takes with it.
    Check broken(int status) const {
        const std::string told = "ended by " + ending_text(status);
        if (devices_ == 0 && WIFEXITED(status) && WEXITSTATUS(status) == kNotStarted)
            throw std::runtime_error("this program cannot be started again for the checks: is there a /proc?");
        if (devices_ == 0)
            throw DeviceError(fmt::format(
                "looking for devices: a driver has ended the program by {}; remedy: leave it out (OCL_ICD_VENDORS), or "
                "a newer one",
                ending_text(status)));
        Check check{"device", ended_ ? "the end of the program" : "between checks", 0, {}};
        std::string where = "in the driver, with no check running", full_name;
        if (running_) {
            check = {running_->layer, running_->name, seconds(), {}};
            full_name = check.layer + " " + check.name;
            where = "in the driver or its compiler, while this check ran";
        }
        check.verdict = failed(told, {.where = where, .remedies = remedies(full_name, status, settings_)});
        return check;
    }

    const VerifySettings& settings_;
    const SupervisorSink& sink_;
    DeviceChecks all_;
    std::size_t devices_ = 0, done_ = 0;
    std::optional<Running> running_;
    Clock::time_point start_;
    bool ended_ = false;  // the process has told the end
};

}  // namespace

DeviceChecks supervise(const std::vector<std::string>& arguments, std::size_t index, const VerifySettings& settings,
                       const SupervisorSink& sink, std::size_t& devices) {
    Supervision supervision(settings, sink);
    while (supervision.run_rest(arguments, index)) continue;
    devices = supervision.devices();
    return supervision.take_checks();
}

}  // namespace raya
