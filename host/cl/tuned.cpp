#include "host/cl/tuned.hpp"

#include <fmt/core.h>

#include "host/error.hpp"

namespace raya {
namespace {

TunedSource& source_in_use() {
    static TunedSource source;
    return source;
}

}  // namespace

TunedValues default_values(const DeviceInfo& device, const TuningKey& key) {
    constexpr std::uint32_t kSphereBatch = 16;  // fastest on llvmpipe (docs/tuning.md)
    const bool ring_of_all = !key.torus && key.accel == RAYA_ACCEL_NONE;
    return {.lanes = default_lanes(device),
            .group = default_group_size(device, key.torus),
            .batch = ring_of_all && key.fp32 && device.max_loop_iterations > 0 ? kSphereBatch : 0};
}

KernelChoice with_values(KernelChoice kernels, const TunedValues& values) {
    constexpr auto kLast = static_cast<std::uint32_t>(LinkMove::kKernel);
    if (values.link_exchange > kLast)
        throw UserError(fmt::format("link exchange {}: must be 0..{}", values.link_exchange, kLast));
    kernels.lanes = values.lanes;
    kernels.group_size = values.group;
    kernels.local_words = kernels.local_words && values.local_words != 0;
    kernels.more = {values.batch, values.trees, values.beams, values.registers};
    if (kernels.link_move == LinkMove::kAutomatic) kernels.link_move = static_cast<LinkMove>(values.link_exchange);
    return kernels;
}

ScopedTunedSource::ScopedTunedSource(TunedSource source) : before_(std::move(source_in_use())) {
    source_in_use() = std::move(source);
}
ScopedTunedSource::~ScopedTunedSource() { source_in_use() = std::move(before_); }

KernelChoice chosen(KernelChoice kernels, const DeviceInfo& device, const TuningKey& key) {
    const bool links_named = kernels.link_move != LinkMove::kAutomatic;
    kernels.link_origin = links_named ? "options" : "";
    if (kernels.lanes == 0 && kernels.group_size == 0) {
        const auto tuned = source_in_use() ? source_in_use()(device, key) : std::nullopt;
        kernels = with_values(kernels, tuned ? tuned->values : default_values(device, key));
        kernels.origin = tuned ? tuned->origin : "defaults";
        if (!links_named && kernels.link_move != LinkMove::kAutomatic) kernels.link_origin = kernels.origin;
        return kernels;
    }
    const TunedValues defaults = default_values(device, key);
    if (!kernels.lanes) kernels.lanes = defaults.lanes;
    if (!kernels.group_size) kernels.group_size = defaults.group;
    if (!kernels.more.sphere_batch) kernels.more.sphere_batch = defaults.batch;
    kernels.origin = "options";
    return kernels;
}

}  // namespace raya
