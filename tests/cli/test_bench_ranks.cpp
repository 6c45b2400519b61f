// raya bench --ranks and raya ping: what they refuse, and one small run of each.
#include <cmath>

#include "host/cli/bench_ranks.hpp"
#include "host/ranks/mpirun.hpp"
#include "tests/cli/refusals.hpp"
#include "tests/document.hpp"
#include "tests/paths.h"

namespace raya {
namespace {

// By what is named in RAYA_MPIRUN no rank starts, so that a refusal comes before the work.
Surroundings without_mpirun() { return {.variables = {{"RAYA_MPIRUN", "/nowhere/mpirun"}}}; }

TEST_CASE("bench --ranks refuses what it cannot do in one line", "[cli]") {
    const ScratchFolder outputs;
    const auto refused = [&](Words more, const Words& message) {
        Words words = {"bench", "--ranks", "1,2"};
        words.insert(words.end(), more.begin(), more.end());
        check_refused(outputs, words, 2, message, without_mpirun());
    };
    refused({}, {"raya: --ranks: ", "remedy: install"});
    refused({"--ways", "none"}, {"--ways with --ranks"});
    refused({"--denormals"}, {"--denormals with --ranks"});
    refused({"--report", "/nowhere/r.json"}, {"/nowhere/r.json"});
    check_refused(outputs, {"bench", "--ranks", "0"}, 2, {"--ranks 0: must be 1..65536"});
    check_refused(outputs, {"bench", "--ranks", "two"}, 2, {"--ranks two: not a whole number"});
    check_refused(outputs, {"ping"}, 2, {"mpirun -n 2 raya ping"});
}

TEST_CASE("sizes for so many ranks have so many times the pixels, nearly", "[cli]") {
    const auto size = [](ImageSize one, std::uint32_t ranks) {
        const ImageSize all = size_for(one, ranks);
        return std::pair(all.width, all.height);
    };
    CHECK(size({256, 256}, 1) == std::pair(256u, 256u));
    CHECK(size({256, 128}, 4) == std::pair(512u, 256u));
    CHECK(size({100, 50}, 2) == std::pair(141u, 71u));  // 141.42, 70.71
}

TEST_CASE("bench --ranks renders one image on one rank and two, and tells of both", "[cli][slow]") {
    if (const std::string lack = Mpirun(nullptr, RAYA_PROGRAM).lack(); !lack.empty()) {
        WARN(lack);
        return;
    }
    const ScratchFolder folder;
    for (const std::string machine : {"grande", "torus"}) {
        const std::string file = folder / (machine + ".json");
        const RunOutcome run = run_raya({"bench", "--ranks", "1,2", scene_file("spheres"), "--machine", machine,
                                         "--size", "48x32", "--format", "fp32", "--samples", "1", "--report", file});
        INFO(run.told());
        REQUIRE(run.code == 0);
        const Document report = Document::parse(file_contents(file));
        CHECK(report["kind"] == "raya bench --ranks");
        CHECK(report["machine"] == machine);
        CHECK((report["others"].is_null() || (report["others"] >= 0.0 && report["others"] <= 1.0)));
        const bool cores = report["unit"] == "core";
        std::size_t strong = 0, weak = 0;
        double work = 0;
        for (const Document& row : report["rows"]) {
            const double ranks = row["ranks"];
            CHECK(row["ms"]["best"] > 0.0);
            CHECK(row["units"] >= 1);
            if (ranks == 1 && row["one_core"] == !cores) continue;
            CHECK(row["efficiency"] > 0.0);
            if (row["scaling"] == "strong") {
                CHECK(row["hash"] == report["rows"][0]["hash"]);
                CHECK(row["size"] == "48x32");
                work = row["work"];
                ++strong;
            } else if (ranks == 2) {
                CHECK(row["size"] == (machine == "torus" ? "48x32" : "68x45"));
                CHECK(row["objects"].get<int>() == (machine == "torus" ? 62 : 31));
                if (machine == "grande") CHECK(row["work"].get<double>() == Approx(2 * work).epsilon(0.1));
                ++weak;
            }
        }
        CHECK(strong >= 2);
        CHECK(weak == 1);
        CHECK_THAT(run.out, Catch::Contains("efficiency"));
    }
}

}  // namespace
}  // namespace raya
