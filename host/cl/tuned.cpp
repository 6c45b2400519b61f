#include "host/cl/tuned.hpp"

#include <fmt/core.h>

#include "host/error.hpp"

namespace raya {
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
            .batch = ring_without_accel && key.fp32 && is_llvmpipe(device) ? kSphereBatch : 0};
}

KernelChoice with_values(KernelChoice kernels, const TunedValues& values) {
    constexpr auto kMaxLinkMove = static_cast<std::uint32_t>(LinkMove::kKernel);
    if (values.link_exchange > kMaxLinkMove)
        throw UserError(fmt::format("link exchange {}: must be 0..{}", values.link_exchange, kMaxLinkMove));
    kernels.lanes = values.lanes;
    kernels.group_size = values.group;
    kernels.local_words = kernels.local_words && values.local_words != 0;
    kernels.tuning = {values.batch, values.trees, values.beams, values.registers};
    if (kernels.link_move == LinkMove::kAutomatic) kernels.link_move = static_cast<LinkMove>(values.link_exchange);
    return kernels;
}

ScopedTunedSource::ScopedTunedSource(TunedSource source) : previous_source_(std::move(current_source())) {
    current_source() = std::move(source);
}
ScopedTunedSource::~ScopedTunedSource() { current_source() = std::move(previous_source_); }

KernelChoice chosen_kernels(KernelChoice kernels, const DeviceInfo& device, const TuningKey& key, std::uint32_t pes) {
    const bool user_set_link_move = kernels.link_move != LinkMove::kAutomatic;
    kernels.link_origin = user_set_link_move ? "options" : "";
    if (kernels.lanes == 0 && kernels.group_size == 0) {
        const auto tuned = current_source() ? current_source()(device, key) : std::nullopt;
        kernels = with_values(kernels, tuned ? tuned->values : default_values(device, key, pes));
        kernels.origin = tuned ? tuned->origin : "defaults";
        if (!user_set_link_move && kernels.link_move != LinkMove::kAutomatic) kernels.link_origin = kernels.origin;
        return kernels;
    }
    const TunedValues defaults = default_values(device, key, pes);
    if (!kernels.lanes) kernels.lanes = defaults.lanes;
    if (!kernels.group_size) kernels.group_size = defaults.group;
    if (!kernels.tuning.sphere_batch) kernels.tuning.sphere_batch = defaults.batch;
    kernels.origin = "options";
    return kernels;
}

}  // namespace raya
