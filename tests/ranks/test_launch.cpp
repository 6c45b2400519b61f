// Detection of an MPI launcher, and number of threads of a rank.
#include <catch2/catch.hpp>
#include <cstdlib>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host/ranks/ranks.hpp"

namespace raya {

TEST_CASE("launchers are detected by their environment variables", "[ranks]") {
    struct Row {
        std::vector<std::pair<const char*, const char*>> variables;
        std::optional<std::uint32_t> rank{}, count{};
    };
    const Row rows[] = {{{}},
                        {{{"OMPI_COMM_WORLD_SIZE", "4"}, {"SLURM_NTASKS", "4"}}},  // a shell under Slurm, not a rank
                        {{{"PMI_RANK", ""}}},
                        {{{"PMI_RANK", "two"}}},
                        {{{"OMPI_COMM_WORLD_RANK", "2"}, {"OMPI_COMM_WORLD_SIZE", "4"}, {"PMIX_RANK", "9"}}, 2, 4},
                        {{{"PMI_RANK", "0"}, {"PMI_SIZE", "1"}}, 0, 1},
                        {{{"PMIX_RANK", "3"}}, 3}};
    for (const Row& row : rows) {
        for (const auto& [name, value] : row.variables) ::setenv(name, value, 1);
        const std::optional<Launch> launch = find_launch();
        for (const auto& [name, value] : row.variables) ::unsetenv(name);
        CAPTURE(&row - rows);
        CHECK(launch.has_value() == row.rank.has_value());
        if (!launch || !row.rank) continue;
        CHECK(launch->rank == *row.rank);
        CHECK(launch->count == row.count);
    }
}

TEST_CASE("a bound rank has one thread per bound core, an unbound rank an equal part of the host's cores", "[ranks]") {
    CHECK(threads_of_rank(1, 8, 2) == 1);
    CHECK(threads_of_rank(3, 8, 2) == 3);
    CHECK(threads_of_rank(8, 8, 1) == 8);
    CHECK(threads_of_rank(8, 8, 3) == 2);
    CHECK(threads_of_rank(2, 2, 8) == 1);
}

}  // namespace raya
