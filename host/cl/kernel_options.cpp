#include "host/cl/kernel_options.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "host/error.hpp"

namespace raya {
namespace {

constexpr std::array<std::uint32_t, 4> kLanes = {1, 4, 8, 16};
constexpr std::uint32_t kMaxGroupSize = 1024;
constexpr std::uint32_t kMaxBounces = 31;  // the kernels store the pending rays of a tree as bits of one word

}  // namespace

void check_kernel_options(const KernelOptions& options, const DeviceInfo& device) {
    if (std::ranges::find(kLanes, options.lanes) == kLanes.end())
        throw UserError(fmt::format("--lanes {}: must be 1, 4, 8 or 16", options.lanes));
    const std::uint32_t max_size = max_group_size_of(device);
    if (options.group_size < 1 || options.group_size > max_size)
        throw UserError(
            fmt::format("--group {}: must be 1..{} work-items on {}", options.group_size, max_size, device.name));
    if (options.bounces > kMaxBounces)
        throw UserError(fmt::format("--bounces {}: must be 0..{}", options.bounces, kMaxBounces));
    if (options.sphere_batch > 32) throw UserError(fmt::format("sphere batch {}: must be 1..32", options.sphere_batch));
}

std::uint32_t max_group_size_of(const DeviceInfo& device) {
    return static_cast<std::uint32_t>(std::min<std::size_t>(kMaxGroupSize, device.max_group_size));
}

std::uint32_t default_lanes(const DeviceInfo& device) {
    if (device.type != "cpu" || device.ends_loops_early) return 1;
    std::uint32_t lanes = 4;
    for (const std::uint32_t width : kLanes)
        if (width <= device.native_float_width) lanes = std::max(lanes, width);
    return lanes;
}

std::uint32_t default_group_size(const DeviceInfo& device, bool torus, std::uint32_t pes) {
    constexpr std::size_t kGpuGroupSize = 128, kLlvmpipeGroupSize = 8, kWorkItemsPerUnit = 512;
    const bool cpu = device.type == "cpu";
    if (cpu && (torus || !device.ends_loops_early)) return 1;
    std::size_t group = cpu ? kLlvmpipeGroupSize : kGpuGroupSize;
    if (!cpu && pes > 0)
        group = std::clamp<std::size_t>(std::bit_floor(kWorkItemsPerUnit * device.compute_units / pes), 32, 256);
    return static_cast<std::uint32_t>(std::min(group, device.max_group_size));
}

bool filters_are_valid(const NumberFormat& format, double extent) {
    constexpr int kMinFractionBits = 10;
    // A quarter of the square root of the format's largest number.
    const double max_extent = std::ldexp(1.0, (1 << (format.exponent_bits - 2)) - 2);
    return !format.is_fp32() && format.fraction_bits >= kMinFractionBits && extent <= max_extent;
}

std::vector<std::string> build_options(const KernelOptions& options, const DeviceInfo& device) {
    check_kernel_options(options, device);
    const NumberFormat& format = options.format;
    const bool exact_divide = options.exact_divide && device.correctly_rounded_divide_sqrt;
    std::vector<std::string> all = {"-cl-std=CL1.2"};
    const auto define = [&](const char* name, std::uint32_t value) {
        all.push_back(fmt::format("-DRAYA_{}={}", name, value));
    };
    if (!format.is_fp32()) {
        define("EXPONENT_BITS", static_cast<std::uint32_t>(format.exponent_bits));
        define("FRACTION_BITS", static_cast<std::uint32_t>(format.fraction_bits));
        define("TRUNCATE", format.truncates);
    }
    define("EXACT_DIVIDE", exact_divide);
    define("EXACT_FMA", options.exact_fma && device.fused_multiply_add);
    if (exact_divide) all.emplace_back("-cl-fp32-correctly-rounded-divide-sqrt");
    define("LANES", options.lanes);
    define("GROUP", options.group_size);
    define("BOUNCES", options.bounces);
    define("WORDS_LOCAL", options.words_local);
#define RAYA_DEFINE_KIND(kind, kinds, KIND) define(#KIND "S", options.kinds);
    RAYA_SHAPE_LIST(RAYA_DEFINE_KIND)
    define("PATCHES", options.patches);
    if (options.accel != RAYA_ACCEL_NONE) define("ACCEL", options.accel);
    if (options.accel == RAYA_ACCEL_BVH) define("BVH_STACK", options.stack);
    if (options.filter) define("FILTER", 1);
    if (options.costs) define("COSTS", 1);
    if (options.packets) define("RAY_PACKETS", 1);
    if (options.sphere_batch) define("SPHERE_BATCH", options.sphere_batch);
    return all;
}

namespace {

TunedSource& current_source() {
    static TunedSource source;
    return source;
}

}  // namespace

TunedValues default_values(const DeviceInfo& device, const TuningKey& key, std::uint32_t pes) {
    constexpr std::uint32_t kSphereBatch = 16;  // fastest on llvmpipe (docs/tuning.md)
    const bool ring_without_accel = !key.torus && key.accel == RAYA_ACCEL_NONE;
    return {.lanes = default_lanes(device),
            .group = default_group_size(device, key.torus, ring_without_accel ? pes : 0),
            .batch = ring_without_accel && key.fp32 && device.ends_loops_early ? kSphereBatch : 0};
}

KernelChoice with_values(KernelChoice kernels, const TunedValues& values) {
    kernels.lanes = values.lanes;
    kernels.group_size = values.group;
    kernels.local_words = kernels.local_words && values.local_words != 0;
    kernels.sphere_batch = values.batch;
    return kernels;
}

ScopedTunedSource::ScopedTunedSource(TunedSource source) : previous_source_(std::move(current_source())) {
    current_source() = std::move(source);
}
ScopedTunedSource::~ScopedTunedSource() { current_source() = std::move(previous_source_); }

KernelChoice chosen_kernels(KernelChoice kernels, const DeviceInfo& device, const TuningKey& key, std::uint32_t pes) {
    if (kernels.lanes == 0 && kernels.group_size == 0) {
        const auto tuned = current_source() ? current_source()(device, key) : std::nullopt;
        kernels = with_values(kernels, tuned ? tuned->values : default_values(device, key, pes));
        kernels.origin = tuned ? tuned->origin : "defaults";
        return kernels;
    }
    const TunedValues defaults = default_values(device, key, pes);
    if (!kernels.lanes) kernels.lanes = defaults.lanes;
    if (!kernels.group_size) kernels.group_size = defaults.group;
    if (!kernels.sphere_batch) kernels.sphere_batch = defaults.batch;
    kernels.origin = "options";
    return kernels;
}

Kernels::Kernels(Session& session, const KernelOptions& options, const KernelSources& sources)
    : session_(session),
      options_(options),
      sources_(sources),
      build_options_(build_options(options, session.device())) {
    build_options_.insert(build_options_.end(), sources.more_options.begin(), sources.more_options.end());
}

Program Kernels::program(const std::string& file) const {
    const std::string source = kernel_source(file, sources_);
    std::vector<std::string> options = build_options_;
    // The driver's cache would not recognise a file that is built again with another value of a macro that it does not
    // contain.
    std::erase_if(options, [&](const std::string& option) {
        return option.starts_with("-DRAYA_") && source.find(option.substr(2, option.find('=') - 2)) == source.npos;
    });
    return session_.build(file, source, options);
}

Program Kernels::build(const std::string& name, const std::string& text) const {
    return session_.build(name, expand_kernel_source(text, name, sources_), build_options_);
}

}  // namespace raya
