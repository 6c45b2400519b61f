// How packets come over the links of a device: by a kernel or by copies, whichever takes less time there.
#include <algorithm>
#include <chrono>
#include <limits>

#include "host/torus/node_array.hpp"

namespace raya {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::uint32_t kPackets = 32;  // in each box of a measurement
constexpr int kTimes = 5;               // of which the shortest counts

}  // namespace

// On CPUs the kernel was faster, or as fast (docs/tuning.md has figures): there nothing is measured.
void NodeArray::choose_link_move(Kernels& kernels) {
    const LinkMove wanted = settings_.kernels.link_move;
    const bool cpu = session_.device().type == "cpu";
    links_origin_ = wanted != LinkMove::kOfDevice ? settings_.kernels.link_origin : cpu ? "defaults" : "measured";
    if (wanted == LinkMove::kCopies) return;
    const auto kernel = kernels.get<ExchangeKernel>();
    if (wanted == LinkMove::kKernel || cpu) return use_kernel(kernel);
    const double by_copies = exchange_seconds();
    use_kernel(kernel);
    if (exchange_seconds() < by_copies) return;
    rays_.use_copies();
    homeward_.use_copies();
    links_by_kernel_ = false;
}

void NodeArray::use_kernel(const ExchangeKernel& kernel) {
    rays_.use_kernel(kernel, options_.group_size, status_);
    homeward_.use_kernel(kernel, options_.group_size, status_);
    links_by_kernel_ = true;
}

// Of an exchange over all links, with some packets in every outbox. What is counted and moved is forgotten by clear().
double NodeArray::exchange_seconds() {
    const std::uint32_t packets = std::min(kPackets, buffers_.box);
    NodeStatus status(raya_nodes(settings_.torus));
    for (std::uint32_t node = 0; node < raya_nodes(settings_.torus); ++node) {
        const auto put = [&](std::uint32_t word) {
            status.words[std::size_t{node} * RAYA_STATUS_WORDS + word] = packets;
        };
        for (std::uint32_t link = 0; link < RAYA_LINKS; ++link)
            if (settings_.torus.sides[link / 2] > 1) put(RAYA_STATUS_OUTBOX + link);
        if (node != RAYA_ROOT) put(RAYA_STATUS_RETURN_OUTBOX + raya_home_link(settings_.torus, node));
    }
    for (std::uint32_t slot = 0; slot < nodes_; ++slot)
        session_.write(
            "measure links", status_,
            std::span(status.words).subspan(std::size_t{share_.own()[slot]} * RAYA_STATUS_WORDS, RAYA_STATUS_WORDS),
            std::size_t{slot} * RAYA_STATUS_WORDS);
    rays_.clear();
    homeward_.clear();
    std::vector<std::uint64_t> words(std::size_t{raya_nodes(settings_.torus)} * RAYA_LINKS);
    double least = std::numeric_limits<double>::max();
    for (int i = 0; i <= kTimes; ++i) {
        session_.finish();
        const Clock::time_point start = Clock::now();
        rays_.exchange(status, words);
        homeward_.exchange(status, words);
        session_.finish();
        const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
        if (i > 0) least = std::min(least, seconds);  // the first one may build the kernel
    }
    return least;
}

}  // namespace raya
