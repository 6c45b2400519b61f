// Checks that two renders, for example on one and on several ranks, give the same results bit for bit.
#pragma once
#include <catch2/catch.hpp>
#include <tuple>

#include "host/ring/ring_result.hpp"
#include "host/torus/torus_result.hpp"

namespace raya {

inline void check_same(const RingResult& single, const RingResult& distributed) {
    CHECK(single.image.rgb == distributed.image.rgb);
    CHECK(single.mask.rgb == distributed.mask.rgb);
    CHECK(single.recomputed == distributed.recomputed);
    CHECK(single.events == distributed.events);
    CHECK(single.load.per_pe == distributed.load.per_pe);
    CHECK(single.requests == distributed.requests);
    REQUIRE(single.phases.size() == distributed.phases.size());
    for (std::size_t i = 0; i < single.phases.size(); ++i) {
        CHECK(single.phases[i].events == distributed.phases[i].events);
        CHECK(single.phases[i].load.per_pe == distributed.phases[i].load.per_pe);
        CHECK(single.phases[i].turn_cycles == distributed.phases[i].turn_cycles);
        CHECK(single.phases[i].cost().cycles == distributed.phases[i].cost().cycles);
    }
    const Communication &a = single.communication, &b = distributed.communication;
    CHECK(std::tie(a.broadcasts, a.broadcast_words, a.rotations, a.rotation_words, a.gathers, a.gather_words,
                   a.transfers, a.transfer_words, a.pe_broadcasts, a.pe_broadcast_words) ==
          std::tie(b.broadcasts, b.broadcast_words, b.rotations, b.rotation_words, b.gathers, b.gather_words,
                   b.transfers, b.transfer_words, b.pe_broadcasts, b.pe_broadcast_words));
    CHECK(single.scale.exponent == distributed.scale.exponent);
    CHECK(single.pe_memory.bytes() == distributed.pe_memory.bytes());
}

inline void check_same(const TorusResult& a, const TorusResult& b) {
    CHECK(a.image.rgb == b.image.rgb);
    CHECK(a.events == b.events);
    CHECK(a.load.per_pe == b.load.per_pe);
    CHECK(a.made == b.made);
    CHECK(a.ended == b.ended);
    CHECK(a.returns == b.returns);
    CHECK(a.hops == b.hops);
    CHECK(a.link_words == b.link_words);
    CHECK(a.link_packets == b.link_packets);
    CHECK(a.queue_max == b.queue_max);
    CHECK(a.node_bytes == b.node_bytes);
    REQUIRE(a.supersteps.size() == b.supersteps.size());
    for (std::size_t i = 0; i < a.supersteps.size(); ++i) {
        CHECK(a.supersteps[i].max_node_cycles == b.supersteps[i].max_node_cycles);
        CHECK(a.supersteps[i].max_link_words == b.supersteps[i].max_link_words);
        CHECK(a.supersteps[i].live == b.supersteps[i].live);
    }
}

}  // namespace raya
