// Modelled times of a torus, compared with times computed by hand.
#include <catch2/catch.hpp>
#include <cstdint>

#include "host/torus/topology.hpp"
#include "host/torus/torus_result.hpp"

namespace raya {
namespace {

// Link rates: 1.7 MB/s in one direction, 2.4 MB/s in both directions together.
constexpr double kCycleMs = 40e-6, kWordMs = 1 / 425., kBothWaysWordMs = 1 / 300.;

TorusResult result_of(const raya_torus& torus) {
    TorusResult result;
    const std::size_t nodes = raya_nodes(torus);
    result.load = load_of(std::vector<std::uint64_t>(nodes));
    result.link_words.resize(nodes * RAYA_LINKS);
    result.link_packets.resize(nodes * RAYA_LINKS);
    return result;
}

void send(TorusResult& result, std::uint32_t node, std::uint32_t link, std::uint64_t packets, std::uint64_t words) {
    result.link_packets[node * RAYA_LINKS + link] += packets;
    result.link_words[node * RAYA_LINKS + link] += packets * words;
}

Approx about_ms(double value) { return Approx(value).epsilon(1e-12); }

TEST_CASE("a node's processor time is the time for computing, sending and receiving", "[torus]") {
    const raya_torus torus = make_torus({4, 1, 1}, Links::kTorus3d);
    TorusResult result = result_of(torus);
    result.load = load_of({1'000'000, 2'000'000, 0, 0});
    send(result, 0, 0, 1000, 16);  // to node 1
    send(result, 3, 0, 500, 8);    // to node 0, over the wrap-around link
    const TorusTime time = torus_time(torus, result);
    CHECK(time.compute_ms == about_ms(2'000'000 * kCycleMs));
    CHECK(time.messages_ms == about_ms((1000 * 51 + 500 * 35) * kCycleMs));    // node 0
    CHECK(time.processor_ms == about_ms((2'000'000 + 1000 * 51) * kCycleMs));  // node 1
    CHECK(time.links_ms == about_ms(16'000 * kWordMs));
    CHECK(time.overlapped_ms == time.processor_ms);
    result.supersteps = {{1000, 16, 0}, {5000, 0, 0}, {0, 320, 0}};
    CHECK(torus_time(torus, result).stepwise_ms == about_ms(6000 * kCycleMs + 336 * kBothWaysWordMs));
}

TEST_CASE("both directions share a link, wrap-around links included", "[torus]") {
    const raya_torus torus = make_torus({2, 3, 1}, Links::kTorus3d);
    TorusResult result = result_of(torus);
    const std::uint32_t last_row_node = raya_node_of(torus, 0, 2, 0), first_row_node = raya_node_of(torus, 0, 0, 0);
    send(result, last_row_node, 2, 100, 16);   // up along y from the last row to the first
    send(result, first_row_node, 3, 100, 16);  // in the opposite direction over the same link
    CHECK(torus_time(torus, result).links_ms == about_ms(1600 * kBothWaysWordMs));
    send(result, first_row_node, 2, 90, 16);  // from the first row to the second
    CHECK(torus_time(torus, result).links_ms == about_ms(1600 * kBothWaysWordMs));
    send(result, last_row_node, 2, 100, 16);
    CHECK(torus_time(torus, result).links_ms == about_ms(1600 * kBothWaysWordMs + 1600 * kWordMs));
    // Two links join two nodes along x, one in each direction round the side. The links do not share bandwidth.
    TorusResult two_nodes = result_of(torus);
    send(two_nodes, 0, 0, 100, 16);
    send(two_nodes, 1, 0, 100, 16);
    CHECK(torus_time(torus, two_nodes).links_ms == about_ms(1600 * kWordMs));
    send(two_nodes, 1, 1, 100, 16);
    CHECK(torus_time(torus, two_nodes).links_ms == about_ms(1600 * kBothWaysWordMs));
}

}  // namespace
}  // namespace raya
