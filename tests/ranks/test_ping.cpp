// The report of a ping-pong, and the network model that is fitted to its times: time = alpha + beta * length.
#include <catch2/catch.hpp>
#include <mutex>

#include "host/ranks/ranks.hpp"
#include "tests/ranks/thread_ranks.hpp"

namespace raya {
namespace {

TEST_CASE("the network fit returns exact alpha and beta for exact times, and never negative values", "[ranks]") {
    const MessageTime exact[] = {{1, 2e-6 + 1e-9}, {1000, 3e-6}, {1'000'000, 1.002e-3}};
    const Network network = fitted_network(exact);
    CHECK(network.alpha_s == Approx(2e-6));
    CHECK(network.beta_s == Approx(1e-9));
    // The fit to two lengths is exact unless alpha or beta would be negative. If times decrease with the length, beta
    // is 0, and alpha is the mean of the times 2 and 1 with the weights 1/4 and 1: (1/2 + 1) / (1/4 + 1).
    const MessageTime falling[] = {{0, 2}, {10, 1}};
    CHECK(fitted_network(falling).alpha_s == Approx(1.2));
    CHECK(fitted_network(falling).beta_s == 0);
    // If times increase faster than the length, alpha is 0, and beta is the mean of 1 s and 3 s per byte with the
    // weights 1 and 1/9: (1 + 3/9) / (1 + 1/9).
    const MessageTime steep[] = {{1, 1}, {2, 6}};
    CHECK(fitted_network(steep).alpha_s == 0);
    CHECK(fitted_network(steep).beta_s == Approx(1.2));
}

TEST_CASE("a ping-pong measures messages to a rank on another host", "[ranks]") {
    PingReport report;
    on_ranks(
        3,
        [&](Ranks& ranks) {
            PingReport own_report = ping(ranks);
            if (ranks.is_first()) report = std::move(own_report);
        },
        2);
    CHECK(report.library == "threads");
    CHECK(report.partner == 2);  // on another host than ranks 0 and 1
    REQUIRE(report.messages.size() > 4);
    for (const MessageTime& time : report.messages) CHECK(time.seconds > 0);
    CHECK(report.network.alpha_s + report.network.beta_s > 0);
}

}  // namespace
}  // namespace raya
