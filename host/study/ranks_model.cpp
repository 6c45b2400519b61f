#include "host/study/ranks_model.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <utility>

#include "host/torus/node_share.hpp"

namespace raya {
namespace {

constexpr double kWordBytes = 4;

// Of what all ranks have, the part that comes from others.
double from_others(std::uint32_t ranks) { return 1 - 1.0 / ranks; }

}  // namespace

std::uint32_t rounds_of(std::uint32_t ranks) { return static_cast<std::uint32_t>(std::bit_width(ranks - 1)); }

RankParts predict_ring(const MeasuredWork& one, const RingPart& part, const Network& network, double processors) {
    RankParts parts{.compute_s = (one.trace_s * (1 + part.imbalance) + one.spread_s) / processors,
                    .host_s = one.host_s};
    if (part.ranks == 1) return parts;
    parts.exchange_s = static_cast<double>(part.rotations) * network.seconds(part.block_bytes);
    parts.collect_s =
        2 * (part.ranks - 1.0) * network.alpha_s + network.beta_s * part.image_bytes * from_others(part.ranks);
    parts.broadcast_s = rounds_of(part.ranks) * network.seconds(part.scene_bytes);
    return parts;
}

RankParts predict_torus(const MeasuredWork& one, const TorusPart& part, const Network& network, double processors) {
    const double busiest = one.trace_s * part.cycles / part.all_cycles + one.spread_s * part.most_nodes / part.nodes;
    RankParts parts{.compute_s = busiest * part.ranks / processors, .host_s = one.host_s * part.host_times};
    if (part.ranks == 1) return parts;
    parts.exchange_s = part.messages * network.alpha_s + part.bytes * network.beta_s;
    parts.collect_s = part.supersteps * (rounds_of(part.ranks) * network.alpha_s +
                                         network.beta_s * part.status_bytes * from_others(part.ranks));
    parts.broadcast_s =
        (part.ranks - 1.0) * network.alpha_s + network.beta_s * part.scene_bytes * from_others(part.ranks);
    return parts;
}

TorusPart cut_further(const TorusPart& part, std::uint32_t times) {
    const double side = std::cbrt(static_cast<double>(times));
    TorusPart cut = part;
    cut.ranks *= times;
    cut.nodes *= times;
    cut.supersteps *= side;
    cut.cycles /= times;
    cut.messages *= side;
    cut.bytes /= side * side;
    cut.status_bytes *= times;
    cut.host_times *= side * times;
    return cut;
}

BrickCounter::BrickCounter(const raya_torus& torus, std::uint32_t ranks)
    : torus_(torus), rank_of_(ranks_of_nodes(torus, ranks)) {
    std::vector<std::uint32_t> nodes(ranks);
    for (const std::uint32_t rank : rank_of_) nodes[rank] += 1;
    part_.ranks = ranks;
    part_.nodes = raya_nodes(torus);
    part_.most_nodes = std::ranges::max(nodes);
}

// What the nodes of a brick send over one of their links to the same rank is one message.
void BrickCounter::add(const std::vector<std::uint64_t>& cycles, const std::vector<std::uint64_t>& link_words) {
    std::vector<double> computed(part_.ranks);
    std::vector<Traffic> sent(part_.ranks), received(part_.ranks);
    std::vector<std::pair<std::uint64_t, std::uint64_t>> faces;  // of both ranks and the link, and the words
    for (std::uint32_t node = 0; node < part_.nodes; ++node) {
        computed[rank_of_[node]] += static_cast<double>(cycles[node]);
        for (std::uint32_t link = 0; link < RAYA_LINKS; ++link) {
            const std::uint64_t words = link_words[std::size_t{node} * RAYA_LINKS + link];
            const std::uint64_t from = rank_of_[node], to = rank_of_[raya_link_end(torus_, node, link)];
            if (words > 0 && from != to) faces.emplace_back((from * part_.ranks + to) * RAYA_LINKS + link, words);
        }
    }
    std::ranges::sort(faces);
    for (std::size_t i = 0; i < faces.size(); ++i) {
        const std::uint64_t face = faces[i].first, pair = face / RAYA_LINKS;
        for (Traffic* traffic : {&sent[pair / part_.ranks], &received[pair % part_.ranks]}) {
            traffic->messages += i == 0 || faces[i - 1].first != face;
            traffic->bytes += kWordBytes * static_cast<double>(faces[i].second);
        }
    }
    const auto most = [&](double Traffic::*figure) {
        double value = 0;
        for (std::uint32_t rank = 0; rank < part_.ranks; ++rank)
            value = std::max({value, sent[rank].*figure, received[rank].*figure});
        return value;
    };
    part_.supersteps += 1;
    part_.cycles += std::ranges::max(computed);
    part_.all_cycles += std::accumulate(computed.begin(), computed.end(), 0.0);
    part_.messages += most(&Traffic::messages);
    part_.bytes += most(&Traffic::bytes);
}

std::uint32_t half_at(std::span<const std::uint32_t> ranks, std::span<const RankParts> parts) {
    const auto found = std::ranges::find_if(parts, [](const RankParts& p) { return p.share() >= 0.5; });
    return found == parts.end() ? 0 : ranks[static_cast<std::size_t>(found - parts.begin())];
}

}  // namespace raya
