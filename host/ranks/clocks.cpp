#include "host/ranks/clocks.hpp"

#include <span>

namespace raya {
namespace {

constexpr int kTries = 16;

void answer(Ranks& ranks, std::uint32_t rank, const std::function<std::uint64_t()>& now) {
    for (int i = 0; i < kTries; ++i) {
        char asked = 0;
        ranks.receive(rank, std::span(&asked, 1));
        const std::uint64_t time = now();
        ranks.send(rank, std::span(&time, 1));
    }
}

RankClock ask(Ranks& ranks, const std::function<std::uint64_t()>& now) {
    RankClock best{0, UINT64_MAX};
    for (int i = 0; i < kTries; ++i) {
        const char question = 1;
        std::uint64_t time = 0;
        const std::uint64_t before = now();
        ranks.send(0, std::span(&question, 1));
        ranks.receive(0, std::span(&time, 1));
        const std::uint64_t half = (now() - before) / 2;
        if (half < best.uncertainty_ns) best = {static_cast<std::int64_t>(time - (before + half)), half};
    }
    return best;
}

}  // namespace

RankClock rank_clock(Ranks& ranks, const std::function<std::uint64_t()>& now) {
    if (!ranks.first()) return ask(ranks, now);
    for (std::uint32_t rank = 1; rank < ranks.count(); ++rank) answer(ranks, rank, now);
    return {};
}

}  // namespace raya
