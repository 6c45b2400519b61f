// The network that is fitted to a ping-pong, what a ping-pong tells, and how ranks are started.
#include <catch2/catch.hpp>
#include <mutex>

#include "host/ranks/mpirun.hpp"
#include "host/ranks/ping.hpp"
#include "tests/ranks/thread_ranks.hpp"

namespace raya {
namespace {

TEST_CASE("alpha and beta of messages that follow them exactly, and of some that do not", "[ranks]") {
    const MessageTime exact[] = {{1, 2e-6 + 1e-9}, {1000, 3e-6}, {1'000'000, 1.002e-3}};
    const Network network = fitted_network(exact);
    CHECK(network.alpha_s == Approx(2e-6));
    CHECK(network.beta_s == Approx(1e-9));
    CHECK(network.seconds(500) == Approx(2.5e-6));
    // Of two lengths both times are met, unless that takes a number below 0: what falls with the length has no beta,
    // and alpha is then the mean of 2 and 1 by weights of 1/4 and 1, (1/2 + 1) / (1/4 + 1).
    const MessageTime falling[] = {{0, 2}, {10, 1}};
    CHECK(fitted_network(falling).alpha_s == Approx(1.2));
    CHECK(fitted_network(falling).beta_s == 0);
    // What grows by more than the length has no alpha: beta of 1 and 3 a byte by equal weights of b/t,
    // (1 + 2/6) / (1 + 1/9).
    const MessageTime steep[] = {{1, 1}, {2, 6}};
    CHECK(fitted_network(steep).alpha_s == 0);
    CHECK(fitted_network(steep).beta_s == Approx(1.2));
}

TEST_CASE("a ping-pong tells of every rank, and its document reads back", "[ranks]") {
    PingReport report;
    on_ranks(
        3,
        [&](Ranks& ranks) {
            PingReport own = ping(ranks);
            if (ranks.first()) report = std::move(own);
        },
        2);
    CHECK(report.library == "threads");
    CHECK(report.partner == 2);  // of another host than ranks 0 and 1
    REQUIRE(report.ranks.size() == 3);
    CHECK(report.ranks[1].host == "host0");
    CHECK(report.ranks[2].host == "host1");
    CHECK(report.ranks[0].threads >= 1);
    REQUIRE(report.messages.size() > 4);
    for (const MessageTime& time : report.messages) CHECK(time.seconds > 0);
    for (const MessageTime& time : report.gathers) CHECK(time.seconds > 0);
    CHECK(report.network.seconds(1) > 0);

    const PingReport read = PingReport::of(Json::parse(report.json().dump(), {"report"}));
    CHECK(read.json().dump() == report.json().dump());
    CHECK_THROWS_AS(PingReport::of(Json::parse("{\"library\": \"x\"}", {"report"})), JsonError);
}

TEST_CASE("cores that ranks use, and whether they share some", "[ranks]") {
    const std::vector<RankPlace> one = {{"a", 4, 4}}, even = {{"a", 2, 4}, {"a", 2, 4}, {"b", 3, 4}},
                                 crowded = {{"a", 1, 2}, {"a", 1, 2}, {"a", 1, 2}, {"b", 1, 2}};
    CHECK(cores_of(one) == 4);
    CHECK(cores_of(even) == 7);
    CHECK(cores_of(crowded) == 3);
    CHECK_FALSE(share_cores(even));
    CHECK(share_cores(crowded));
}

TEST_CASE("how ranks are started: words of one's own, threads, what they say", "[ranks]") {
    const auto tail_of = [](std::vector<std::string> words, const std::string& first) {
        return std::vector<std::string>(std::find(words.begin(), words.end(), first), words.end());
    };
    using Words = std::vector<std::string>;
    CHECK(tail_of(Mpirun(nullptr, "/x/raya").command(2, {}, {"ping"}), "mpirun") ==
          Words{"mpirun", "--bind-to", "none", "-n", "2", "/x/raya", "ping"});
    CHECK(tail_of(Mpirun(" srun  --mpi=pmix ", "/x/raya").command(3, 1, {"render", "a b"}), "srun") ==
          Words{"srun", "--mpi=pmix", "-n", "3", "env", "POCL_MAX_PTHREAD_COUNT=1", "/x/raya", "render", "a b"});
    CHECK_THROWS_WITH(Mpirun("  ", "raya"), Catch::Contains("RAYA_MPIRUN") && Catch::Contains("unset"));
    CHECK(telling_line("----\nraya: rank 1 on a: no room\nmpirun has exited\n----\n") == "rank 1 on a: no room");
    CHECK(telling_line("first\nlast.\n") == "last");
    CHECK(telling_line("") == "");
    CHECK_THROWS_WITH(Mpirun("false", "raya").run(2, {}, {}), "2 ranks: exit code 1");
    const std::string lack = Mpirun("no-such-launcher", "raya").lack();  // or MPI is not in this build
    CHECK_THAT(lack, Catch::Contains("remedy: install"));
}

}  // namespace
}  // namespace raya
