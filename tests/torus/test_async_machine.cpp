// Simulation of the asynchronous torus: times computed by hand, lower and upper bounds, and freedom from deadlock.
#include <catch2/catch.hpp>
#include <numeric>
#include <string>

#include "host/torus/async_machine.hpp"
#include "tests/thorough.hpp"
#include "tests/torus/random_history.hpp"

namespace raya {
namespace {

// Times in ms. kCycle: one cycle. kRayEnd, kReturnEnd: a processor's work for a ray or a return at one end of a link.
// kRay, kReturn: transfer of a ray or a return over a link with traffic in one direction. kRayBoth: transfer of a ray
// over a link with traffic in both directions.
constexpr double kCycle = 40e-6, kRayEnd = 51 * kCycle, kReturnEnd = 35 * kCycle;
constexpr double kRay = 64 / 1.7e3, kReturn = 32 / 1.7e3, kRayBoth = 64 / 1.2e3;

Approx about(double value) { return Approx(value).epsilon(1e-9); }

raya_torus torus_of(std::uint32_t nodes) { return make_torus({nodes, 1, 1}, Links::kTorus3d); }

double total(const std::vector<AsyncNode>& nodes, double AsyncNode::*time_ms) {
    return std::accumulate(nodes.begin(), nodes.end(), 0.0,
                           [&](double sum, const AsyncNode& node) { return sum + node.*time_ms; });
}

TEST_CASE("a ray crosses the links of its route one after another, and so does its return", "[torus]") {
    const std::uint32_t hops = GENERATE(0u, 1u, 2u, 3u);
    HistoryBuilder h;
    h.add_task(0, 1000);
    h.add_task(hops, 2000, h.add_ray(hops));
    h.add_return();
    const AsyncResult r = simulate(torus_of(7), h.history);
    const double transfer_ms = hops * (2 * kRayEnd + kRay) + hops * (2 * kReturnEnd + kReturn);
    CHECK(r.finish_ms == about(3000 * kCycle + transfer_ms));
    CHECK(r.delivered == 2);
    CHECK(r.links[0].messages == (hops > 0));
    CHECK(total(r.nodes, &AsyncNode::compute_ms) == about(3000 * kCycle));
    CHECK(total(r.nodes, &AsyncNode::messages_ms) == Approx(hops * 2 * (kRayEnd + kReturnEnd)));
}

TEST_CASE("a link carries one message at a time in each direction, and both directions share its rate", "[torus]") {
    HistoryBuilder one_way;
    one_way.add_task(1, 500);
    const std::uint32_t first = one_way.add_ray(2), second = one_way.add_ray(2);
    one_way.add_task(2, 10, first);
    one_way.add_task(2, 20, second);
    // The input thread holds one ray, so the transfer of the second ray starts when the first has been received.
    CHECK(simulate(torus_of(4), one_way.history).finish_ms == about(520 * kCycle + 4 * kRayEnd + 2 * kRay));

    HistoryBuilder both;
    both.add_task(1, 500);
    const std::uint32_t up = both.add_ray(2);
    both.add_task(2, 500);
    const std::uint32_t down = both.add_ray(1);
    both.add_task(2, 10, up);
    both.add_task(1, 10, down);
    CHECK(simulate(torus_of(4), both.history).finish_ms == about(510 * kCycle + 2 * kRayEnd + kRayBoth));
    // The second transfer starts when half of the first is done. Both transfers continue at the lower rate until the
    // first is done; then the second continues alone.
    const auto delay_cycles = static_cast<std::uint64_t>(kRay / 2 / kCycle);
    both.history.tasks[1].cycles = 500 + delay_cycles;
    const double first_ms = static_cast<double>(delay_cycles) * kCycle, both_ms = (1 - first_ms / kRay) * kRayBoth;
    const double second_ms = (1 - both_ms / kRayBoth) * kRay;
    CHECK(simulate(torus_of(4), both.history).finish_ms ==
          about(510 * kCycle + 2 * kRayEnd + first_ms + both_ms + second_ms));
}

TEST_CASE("messages preempt the main task and delay its end by their processor time", "[torus]") {
    HistoryBuilder h;
    h.add_task(1, 100'000);  // runs during all other tasks
    h.add_task(0, 10);
    h.add_task(2, 10, h.add_ray(2));  // this ray passes through node 1
    h.add_task(3, 10);
    h.add_return();  // from node 3 through node 4 to the root
    const AsyncResult r = simulate(torus_of(5), h.history);
    CHECK(r.finish_ms == about(100'000 * kCycle + 2 * kRayEnd));
    CHECK(r.nodes[1].messages_ms == about(2 * kRayEnd));
}

TEST_CASE("a full port makes the main task wait", "[torus]") {
    constexpr std::uint32_t kRays = 12;
    HistoryBuilder h;
    std::vector<std::uint32_t> sent;
    h.add_task(1, 0);
    for (std::uint32_t i = 0; i < kRays; ++i) sent.push_back(h.add_ray(2));
    for (const std::uint32_t message : sent) h.add_task(2, 0, message);
    h.add_task(1, 1000);
    const AsyncMachine machine{.buffer = 5};
    const AsyncResult r = simulate(torus_of(4), h.history, machine);
    // A ray enters the port if two of the port's five slots are free. So four rays enter at once, and each further ray
    // enters when a ray has left the port.
    CHECK(r.nodes[1].port_ms == about((kRays - 4) * (2 * kRayEnd + kRay) - kRayEnd));
    CHECK(r.finish_ms == about(kRays * (2 * kRayEnd + kRay)));
    CHECK(r.nodes[2].queue_max == 1);
    const AsyncResult large_buffer = simulate(torus_of(4), h.history, {.buffer = kRays + 1});
    CHECK(large_buffer.nodes[1].port_ms == 0);
    CHECK(large_buffer.finish_ms == r.finish_ms);
    CHECK_THROWS_AS(simulate(torus_of(4), h.history, {.buffer = 1}), UserError);
}

// Every node sends many rays to the opposite node, and each ray waits for a free slot in the next node's port.
TEST_CASE("a torus deadlocks if all its ports may fill up, but not if one slot of each port stays free", "[torus]") {
    const raya_torus torus = torus_of(6);
    HistoryBuilder h;
    std::vector<std::uint32_t> sent;
    for (std::uint32_t node = 0; node < 6; ++node) {
        h.add_task(node, 0);
        for (int i = 0; i < 30; ++i) sent.push_back(h.add_ray((node + 3) % 6));
    }
    for (const std::uint32_t message : sent) h.add_task(h.history.messages[message].destination, 0, message);
    for (const std::uint32_t buffer : {2u, 3u, 8u}) {
        CAPTURE(buffer);
        CHECK_THROWS_WITH(simulate(torus, h.history, {.buffer = buffer, .entry_slots = 1}),
                          Catch::Contains("deadlock") && Catch::Contains("of 180 messages"));
        CHECK(simulate(torus, h.history, {.buffer = buffer}).delivered == 180);
    }
}

TEST_CASE("random histories: every message is delivered once, within the time bounds, for any buffer size", "[torus]") {
    constexpr std::uint64_t kSeed = 1995;
    const unsigned cases = quick_cases(200, 4000);
    for (std::uint64_t i = 0; i < cases; ++i) {
        SplitMix random(kSeed + i);
        const raya_torus torus = random_torus(random, 6);
        const History history = random_history(random, torus, 4 + random_below(random, 600));
        AsyncMachine machine;
        machine.buffer = 2 + random_below(random, 6);
        CAPTURE(kSeed, i, torus_text(torus), history.tasks.size(), machine.buffer);
        const AsyncResult r = simulate(torus, history, machine);
        REQUIRE(r.delivered == history.messages.size());
        const TorusResult traffic = traffic_of(torus, history);
        const TorusTime bound = torus_time(torus, traffic);
        CHECK(r.finish_ms >= bound.overlapped_ms * (1 - 1e-9));
        // Sum of the busy times of all nodes and links: an upper bound, because some node or link is always busy.
        double sum_ms = 0;
        for (std::size_t link = 0; link < r.links.size(); ++link) {
            CHECK(r.links[link].words == traffic.link_words[link]);
            CHECK(r.links[link].messages == traffic.link_packets[link]);
            CHECK(r.links[link].busy_ms <= r.finish_ms * (1 + 1e-9));
            sum_ms += 4e3 * static_cast<double>(traffic.link_words[link]) / 1.2e6;
        }
        for (std::size_t node = 0; node < r.nodes.size(); ++node) {
            const AsyncNode& n = r.nodes[node];
            CHECK(n.compute_ms == Approx(kCycle * static_cast<double>(traffic.load.per_pe[node])));
            CHECK(n.compute_ms + n.messages_ms <= r.finish_ms * (1 + 1e-9));
            sum_ms += n.compute_ms + n.messages_ms;
        }
        CHECK(r.finish_ms <= sum_ms * (1 + 1e-9));
        const AsyncMachine no_messages{.message_cycles = 0, .word_cycles = 0, .one_way = 0, .both_ways = 0};
        const AsyncResult undelayed = simulate(torus, history, no_messages);
        CHECK(total(undelayed.nodes, &AsyncNode::messages_ms) == 0);
        CHECK(undelayed.finish_ms >= bound.compute_ms * (1 - 1e-9));
    }
}

}  // namespace
}  // namespace raya
