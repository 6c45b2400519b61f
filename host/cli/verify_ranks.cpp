#include "host/cli/verify_ranks.hpp"

#include <fmt/core.h>

#include <chrono>
#include <functional>
#include <future>
#include <map>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "host/base/log.hpp"
#include "host/cli/verify_output.hpp"
#include "host/error.hpp"

namespace raya {
namespace {

constexpr auto kRound = std::chrono::milliseconds(200);  // time between two exchanges among the ranks

/// Lines that a thread has printed and that have not been sent to rank 0 yet.
class UnsentLines {
  public:
    void add(const std::string& lines) {
        const std::lock_guard lock(mutex_);
        text_ += lines;
    }
    std::string take() {
        const std::lock_guard lock(mutex_);
        return std::exchange(text_, {});
    }

  private:
    std::mutex mutex_;
    std::string text_;
};

// Returns a device whose only check has failed, because the rank has no device.
DeviceChecks missing_device(const DeviceError& error, const PrintLines& print) {
    DeviceChecks device{"no device", "", "", ""};
    device.checks.push_back(run_check("device", "choice", [&]() -> Verdict { throw DeviceError(error); }));
    print(check_lines(device.checks.front()));
    return device;
}

// Runs the collective calls while the checks run in a thread, so that no rank waits longer than kRound for another one.
// Returns the results of this rank.
DeviceChecks exchange_lines(Ranks& ranks, std::future<DeviceChecks>& checks, UnsentLines& lines) {
    std::optional<DeviceChecks> own;
    for (std::size_t finished = 0; finished < ranks.count();) {
        if (own) std::this_thread::sleep_for(kRound);
        if (!own && checks.wait_for(kRound) == std::future_status::ready) own = checks.get();
        for (const std::string& text : ranks.gather(lines.take())) {
            if (!text.empty()) clear_status();
            fmt::print("{}", text);
        }
        std::fflush(stdout);
        finished = 0;
        for (const std::uint8_t has_finished : ranks.all_gather(std::uint8_t{own.has_value()}))
            finished += has_finished;
        if (ranks.is_first() && shows_progress())
            show_status(fmt::format("{} of {} ranks have finished", finished, ranks.count()));
    }
    if (ranks.is_first()) clear_status();
    return *std::move(own);
}

// Adds a failed check for each GPU that two ranks of a host share: the host has fewer GPUs than ranks.
void fail_shared_devices(std::vector<DeviceChecks>& devices) {
    std::map<std::pair<std::string, std::string>, std::uint32_t> first_ranks;  // [host, PCI address]
    for (DeviceChecks& device : devices) {
        if (device.pci_address.empty()) continue;
        const auto [first, is_new] = first_ranks.try_emplace({device.host, device.pci_address}, *device.rank);
        if (is_new) continue;
        const Verdict verdict =
            failed(fmt::format("rank {} has checked the same device", first->second),
                   {.where = "a device of " + device.host + " is missing, or the host has too many ranks",
                    .remedies = {"raya devices lists the devices of the host; start as many ranks"}});
        device.checks.push_back({"device", "of this rank only", 0, verdict});
        fmt::print("rank {} on {}: {}", *device.rank, device.host, check_lines(device.checks.back()));
    }
}

DeviceChecks check_device(const std::string& device, const VerifySettings& settings, std::uint32_t rank_on_host,
                          const PrintLines& print) {
    DeviceOutput output(settings, print);
    const SupervisorSink sink{.finished = std::bind_front(&DeviceOutput::finished, &output)};
    try {
        DeviceChecks result = supervise(device, rank_on_host, settings, sink);
        output.ended(result);
        return result;
    } catch (const DeviceError& error) {
        return missing_device(error, print);
    }
}

}  // namespace

std::vector<DeviceChecks> verify_on_ranks(const std::string& device, const VerifySettings& settings, Ranks& ranks) {
    UnsentLines lines;
    const std::string prefix = fmt::format("rank {} on {}: ", ranks.rank(), ranks.host());
    std::future<DeviceChecks> checks = std::async(std::launch::async, [&] {
        return check_device(device, settings, ranks.rank_on_host(),
                            [&](const std::string& text) { lines.add(prefix + text); });
    });
    try {
        DeviceChecks own = exchange_lines(ranks, checks, lines);
        own.rank = ranks.rank();
        own.host = ranks.host();
        std::vector<DeviceChecks> all;
        for (const std::string& text : ranks.gather(Json{{"device", to_json(own)}, {"names", own.names}}.dump())) {
            const Json result = Json::parse(text, {"the results of a rank"});
            all.push_back(device_checks_of(result.at("device")));
            all.back().names = result.at("names").strings();
        }
        fail_shared_devices(all);
        return all;
    } catch (const RankFailure& failure) {
        ranks.fail(failure);  // ends the process, because the destructor of `checks` would wait for the thread
        throw;
    }
}

}  // namespace raya
