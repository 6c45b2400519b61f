// Detection of an MPI launcher, number of threads of a rank, and check that all ranks have the same arguments.
#include <catch2/catch.hpp>
#include <map>

#include "host/error.hpp"
#include "host/ranks/launch.hpp"
#include "tests/ranks/thread_ranks.hpp"

namespace raya {
namespace {

std::optional<Launch> launch_in(const std::map<std::string, std::string>& environment) {
    return launch_from([&](const char* name) {
        const auto found = environment.find(name);
        return found == environment.end() ? std::string() : found->second;
    });
}

}  // namespace

TEST_CASE("launchers are detected by their environment variables", "[ranks]") {
    CHECK(!launch_in({}));
    CHECK(!launch_in({{"OMPI_COMM_WORLD_SIZE", "4"}, {"SLURM_NTASKS", "4"}}));  // a shell under Slurm, not a rank
    CHECK(!launch_in({{"PMI_RANK", ""}}));
    CHECK(!launch_in({{"PMI_RANK", "two"}}));
    const auto open_mpi = launch_in({{"OMPI_COMM_WORLD_RANK", "2"}, {"OMPI_COMM_WORLD_SIZE", "4"}, {"PMIX_RANK", "9"}});
    REQUIRE(open_mpi);
    CHECK(open_mpi->rank == 2);
    CHECK(open_mpi->count == 4u);
    const auto mpich = launch_in({{"PMI_RANK", "0"}, {"PMI_SIZE", "1"}});
    REQUIRE(mpich);
    CHECK(mpich->count == 1u);
    const auto pmix = launch_in({{"PMIX_RANK", "3"}});
    REQUIRE(pmix);
    CHECK(pmix->rank == 3);
    CHECK(!pmix->count);
}

TEST_CASE("a bound rank has one thread per bound core, an unbound rank an equal part of the host's cores", "[ranks]") {
    CHECK(threads_of_rank(1, 8, 2) == 1);
    CHECK(threads_of_rank(3, 8, 2) == 3);
    CHECK(threads_of_rank(8, 8, 1) == 8);
    CHECK(threads_of_rank(8, 8, 3) == 2);
    CHECK(threads_of_rank(2, 2, 8) == 1);
}

TEST_CASE("check_same_program() throws only in the rank whose arguments differ from rank 0's", "[ranks]") {
    for (const std::uint32_t different_rank : {1u, 3u}) {
        const auto arguments = [&](std::uint32_t rank) {
            return std::vector<std::string>{"render", rank == different_rank ? "b.nff" : "a.nff"};
        };
        std::mutex mutex;
        std::vector<std::uint32_t> refused;
        on_ranks(4, [&](Ranks& ranks) {
            try {
                check_same_program(ranks, arguments(ranks.rank()));
            } catch (const UserError& error) {
                const std::lock_guard lock(mutex);
                refused.push_back(ranks.rank());
                if (std::string(error.what()).find("other arguments than rank 0") == std::string::npos) throw;
            }
        });
        CHECK(refused == std::vector<std::uint32_t>{different_rank});
    }
}

}  // namespace raya
