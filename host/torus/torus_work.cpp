#include "host/torus/torus_work.hpp"

#include <utility>

#include "kernels/shared/traffic.h"

namespace raya {
namespace {

constexpr std::uint64_t kWordBytes = sizeof(std::uint32_t);

std::uint64_t launches_of(const TorusResult& result, const std::string& label) {
    std::uint64_t launches = 0;
    for (const LabelSummary& c : result.commands)
        if (c.label == label && c.kind == "kernel") launches += c.launches;
    return launches;
}

// Bytes of the packets of these counts.
std::uint64_t packet_bytes(const PacketCounts& made) {
    std::uint64_t words = 0;
    for (std::uint32_t kind = RAYA_KIND_PRIMARY; kind < RAYA_KINDS; ++kind)
        words += made[kind] * raya_packet_words(kind);
    return kWordBytes * words;
}

}  // namespace

std::vector<KernelWork> torus_kernel_work(const TorusSettings& settings, const TorusResult& r) {
    const std::uint64_t pixels = std::uint64_t{settings.width} * settings.height;
    EventCounts primary{}, others = r.events;
    for (const std::size_t made : {RAYA_PRIMARY, RAYA_DISCARDED}) primary[made] = std::exchange(others[made], 0);
    PacketCounts rays{}, followers = r.made;
    rays[RAYA_KIND_PRIMARY] = std::exchange(followers[RAYA_KIND_PRIMARY], 0);
    const auto opened = [&](const char* label) { return launches_of(r, label) * kWordBytes * r.copied_words; };

    KernelWork inject = work_of("inject", primary), trace = work_of("trace_voxel", others);
    inject.bytes = opened("inject") + packet_bytes(rays);
    trace.bytes =
        opened("trace_voxel") + kWordBytes * RAYA_PACKET_WORDS * r.events[RAYA_STEPS] + packet_bytes(followers);
    trace.rays += primary[RAYA_PRIMARY];  // it traces those, too
    KernelWork route, accept, compose;
    route.label = "route";
    route.bytes = opened("route") +
                  2 * kWordBytes * (r.moved_rays * RAYA_PACKET_WORDS + r.made[RAYA_KIND_RETURN] * RAYA_RETURN_WORDS);
    accept.label = "accept";
    accept.bytes = 2 * kWordBytes * (r.moved_rays * RAYA_PACKET_WORDS + r.moved_returns * RAYA_RETURN_WORDS);
    compose.label = "compose";  // of each contribution three multiply-adds
    compose.operations = 3 * r.contributions;
    compose.bytes = r.contributions * 4 * sizeof(float) + kWordBytes * (pixels + 1) + 3 * sizeof(float) * pixels;
    return {inject, trace, route, accept, compose};
}

}  // namespace raya
