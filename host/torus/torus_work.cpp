#include "host/torus/torus_work.hpp"

#include <numeric>
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

struct Hops {
    std::uint64_t rays, returns;
};

// Packets over links, by their words: W = 16 rays + 8 returns, N = rays + returns.
Hops hops_of(const TorusResult& r) {
    static_assert(RAYA_PACKET_WORDS == 2 * RAYA_RETURN_WORDS);
    const std::uint64_t words = std::accumulate(r.link_words.begin(), r.link_words.end(), std::uint64_t{0});
    const std::uint64_t rays = words / RAYA_RETURN_WORDS - r.hops;
    return {rays, r.hops - rays};
}

}  // namespace

std::vector<KernelWork> torus_kernel_work(const TorusSettings& settings, const TorusResult& r) {
    const std::uint64_t pixels = std::uint64_t{settings.width} * settings.height;
    EventCounts primary{}, others = r.events;
    primary[RAYA_PRIMARY] = std::exchange(others[RAYA_PRIMARY], 0);
    PacketCounts rays{}, followers = r.made;
    rays[RAYA_KIND_PRIMARY] = std::exchange(followers[RAYA_KIND_PRIMARY], 0);
    const Hops hops = hops_of(r);
    const auto opened = [&](const char* label) { return launches_of(r, label) * kWordBytes * r.copied_words; };

    KernelWork inject = work_of("inject", primary), trace = work_of("trace_voxel", others);
    inject.bytes = opened("inject") + packet_bytes(rays);
    trace.bytes =
        opened("trace_voxel") + kWordBytes * RAYA_PACKET_WORDS * r.events[RAYA_STEPS] + packet_bytes(followers);
    trace.rays += primary[RAYA_PRIMARY];  // it traces those, too
    KernelWork route, accept, compose;
    route.label = "route";
    route.bytes = opened("route") +
                  2 * kWordBytes * (hops.rays * RAYA_PACKET_WORDS + r.made[RAYA_KIND_RETURN] * RAYA_RETURN_WORDS);
    accept.label = "accept";
    accept.bytes = 2 * kWordBytes * (hops.rays * RAYA_PACKET_WORDS + hops.returns * RAYA_RETURN_WORDS);
    compose.label = "compose";  // of each contribution three multiply-adds
    compose.operations = 3 * r.contributions;
    compose.bytes = r.contributions * 4 * sizeof(float) + kWordBytes * (pixels + 1) + 3 * sizeof(float) * pixels;
    return {inject, trace, route, accept, compose};
}

}  // namespace raya
