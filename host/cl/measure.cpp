#include "host/cl/measure.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <stdexcept>

#include "kernels/shared/chains.h"

namespace raya {
namespace {

// Returns the number of work-items of a launch: two groups per compute unit on a CPU; elsewhere 2048 work-items per
// compute unit, which is enough to hide latencies.
std::size_t work_items(const DeviceInfo& device, std::uint32_t group) {
    return std::size_t{device.compute_units} * (device.type == "cpu" ? 2 * group : 2048);
}

constexpr int kSamples = 2;  // number of samples of each rate in a measurement
constexpr std::size_t kMultiplyAdd = 2, kDivide = 3, kSquareRoot = 4;  // indices into kOperations

// Returns the size in bytes of each of the two buffers of a copy. Together they take at most an eighth of the device's
// memory.
std::uint64_t copied_bytes(const DeviceInfo& device) {
    constexpr std::uint64_t kMaxBytes = 256u << 20;
    return std::min({kMaxBytes, device.max_allocation_bytes, device.global_memory_bytes / 16});
}

double copy_bytes_per_s(Session& session, const Buffer<std::uint8_t>& source, Buffer<std::uint8_t>& target) {
    session.clear_profile();
    for (int i = 0; i < kSamples; ++i) session.copy("peak", source, 0, target, 0, source.size());
    const std::uint64_t min_ns = session.profile().summary().front().min_ns;
    // 2e9: a copy reads and writes each byte, and a second has 1e9 ns.
    return min_ns > 0 ? 2e9 * static_cast<double>(source.size()) / static_cast<double>(min_ns) : 0;
}

}  // namespace

OperationRates::OperationRates(Session& session, const NumberFormat& format, std::uint32_t lanes)
    : session_(session),
      group_size_(default_group_size(session.device())),
      work_items_(work_items(session.device(), group_size_)),
      lanes_(lanes),
      kernels_(session, {.lanes = lanes, .group_size = group_size_, .format = format}),
      chains_(kernels_.get<Chains>()),
      results_(session.buffer<float>("results of operations", work_items_ * lanes)) {}

double OperationRates::launch_seconds(std::size_t kind) {
    session_.clear_profile();
    session_.launch("operations", chains_, work_items_ / group_size_, group_size_,
                    Uint<"kind">{static_cast<cl_uint>(kind)}, Uint<"rounds">{rounds_[kind]}, 1.0f, results_);
    const double ns = static_cast<double>(session_.profile().summary().back().total_ns);
    session_.clear_profile();
    return ns * 1e-9;
}

void OperationRates::find_rounds(std::size_t kind) {
    rounds_[kind] = 1000;
    launch_seconds(kind);  // PoCL compiles in the first launch
    while (launch_seconds(kind) < 0.01 && rounds_[kind] < 100'000'000) rounds_[kind] *= 4;
}

double OperationRates::measure(std::size_t kind, int samples) {
    if (rounds_[kind] == 0) find_rounds(kind);
    const double operations = static_cast<double>(work_items_ * lanes_) * RAYA_CHAINS * rounds_[kind];
    double highest_rate = 0;
    for (int i = 0; i < samples; ++i) {
        const double elapsed_s = launch_seconds(kind);
        if (elapsed_s > 0) highest_rate = std::max(highest_rate, operations / elapsed_s);
    }
    return highest_rate;
}

DevicePeak device_peak(const cl::Device& device, const NumberFormat& format, std::uint32_t lanes) {
    constexpr int kMeasurements = 3;
    DevicePeak highest{.format = format_name(format)};
    Session session(device);
    if (!session.profile().timed()) return highest;
    OperationRates rates(session, format, lanes);
    std::optional<OperationRates> default_rates;
    const std::uint32_t default_lanes = raya::default_lanes(session.device());
    if (!format.is_fp32() || lanes != default_lanes) default_rates.emplace(session, NumberFormat{}, default_lanes);
    highest.copy_bytes = copied_bytes(session.device());
    Buffer<std::uint8_t> source = session.buffer<std::uint8_t>("peak, from", highest.copy_bytes),
                         target = session.buffer<std::uint8_t>("peak, to", highest.copy_bytes);
    session.fill("peak", source, 1);  // pages that were never written may not be allocated yet
    session.fill("peak", target, 2);
    double lowest_fp32_per_s = std::numeric_limits<double>::infinity();
    const auto raise = [](double& to, double rate) { to = std::max(to, rate); };
    for (int i = 0; i < kMeasurements; ++i) {
        const double multiply_per_s = rates.measure(kMultiplyAdd, kSamples);
        const double fp32_per_s = default_rates ? default_rates->measure(kMultiplyAdd, kSamples) : multiply_per_s;
        lowest_fp32_per_s = std::min(lowest_fp32_per_s, fp32_per_s);
        raise(highest.fp32_per_s, fp32_per_s);
        raise(highest.multiply_per_s, multiply_per_s);
        raise(highest.divide_per_s, rates.measure(kDivide, kSamples));
        raise(highest.sqrt_per_s, rates.measure(kSquareRoot, kSamples));
        raise(highest.copy_bytes_per_s, copy_bytes_per_s(session, source, target));
    }
    highest.scatter = highest.fp32_per_s > 0 ? 1 - lowest_fp32_per_s / highest.fp32_per_s : 0;
    return highest;
}

ClockOffset clock_offset_of(std::uint64_t before, std::uint64_t queued, std::uint64_t after) {
    if (before <= queued && queued <= after) return {};
    const std::uint64_t half_ns = (after - before) / 2;
    return {.same_clock = false,
            .offset_ns = static_cast<std::int64_t>(before + half_ns) - static_cast<std::int64_t>(queued),
            .uncertainty_ns = half_ns + (after - before) % 2};
}

ClockOffset measure_clock_offset(Session& session) {
    if (!session.profile().timed())
        throw std::logic_error("measure_clock_offset: the device does not time its commands");
    constexpr int kCommands = 16;
    Buffer<std::uint32_t> word = session.buffer<std::uint32_t>("clock offset", 1);
    std::uint64_t shortest_ns = ~std::uint64_t{0};
    ClockOffset offset;
    for (int i = 0; i < kCommands; ++i) {
        session.clear_profile();
        const std::uint64_t before = host_clock_ns();
        session.fill("clock offset", word, 0);
        const std::uint64_t after = host_clock_ns();
        const std::uint64_t queued = session.profile().commands().back().queued;
        if (after - before >= shortest_ns) continue;
        shortest_ns = after - before;
        offset = clock_offset_of(before, queued, after);
    }
    session.clear_profile();
    return offset;
}

}  // namespace raya
