// The modelled times of a report: they equal times computed here from the report's counts.
#include <numeric>

#include "tests/cli/render_files.hpp"
#include "tests/document.hpp"

namespace raya {
namespace {

// Adds 6 cycles per division, 8 per square root and 3 per branch (host/model/budget.hpp).
std::uint64_t cycles_of(const Document& budget) {
    return budget["multiply_accumulates"].get<std::uint64_t>() + 6 * budget["divisions"].get<std::uint64_t>() +
           8 * budget["roots"].get<std::uint64_t>() + budget["moves"].get<std::uint64_t>() +
           3 * budget["branches"].get<std::uint64_t>();
}

std::uint64_t sum_of_loads(const Document& load) {
    const auto per_pe = load["per_pe"].get<std::vector<std::uint64_t>>();
    return std::accumulate(per_pe.begin(), per_pe.end(), std::uint64_t{0});
}

Approx about(double value) { return Approx(value).epsilon(1e-9); }

TEST_CASE("report: the cycles of the budget equal the sum of the loads", "[cli]") {
    const std::string scene = GENERATE("glass", "polygons", "cones");
    CAPTURE(scene);
    const Document report = RenderFiles(scene, {"--pes", "5", "--antialias", "supersample"}).report();
    CHECK(cycles_of(report["budget"]) == sum_of_loads(report["load"]));
}

TEST_CASE("report: modelled times follow from counted cycles and words", "[cli]") {
    const std::string antialias = GENERATE("none", "filter", "supersample");
    CAPTURE(antialias);
    const Document report = RenderFiles("centre", {"--pes", "8", "--offset", "3", "--antialias", antialias}).report();
    const Document &time = report["modelled_ms"], &words = report["communication"], &load = report["load"];
    INFO(time.dump());
    const bool filter = antialias == "filter", supersample = antialias == "supersample";
    const double share = 3 * 12;          // pixels of the busiest PE: 3 of 20 columns, 12 rows
    const double host = 140 / 196'608.0;  // ms per word between host and PEs
    CHECK(time["filter"] == about(filter ? 42e-4 * share : 0));
    CHECK(time["compare"] == about(supersample ? 121e-4 * share : 0));
    double busiest = load["trace"]["max"];
    if (supersample) busiest += load["supersample"]["max"].get<double>();
    CHECK(time["compute"] == about(1e-4 * busiest + time["filter"].get<double>() + time["compare"].get<double>()));
    CHECK(time["objects"] == about(host * words["broadcast_words"].get<double>()));
    CHECK(time["image"] == about(host * words["gather_words"].get<double>()));
    CHECK(time["communication"] ==
          about(0.1845 * words["rotations"].get<double>() + words["rotation_words"].get<double>() / 8 / 6e3));
    CHECK((time["communication"] > 0) == (antialias != "none"));
    CHECK(time["total"] == about(time["objects"].get<double>() + time["compute"].get<double>() +
                                 time["communication"].get<double>() + time["image"].get<double>()));
    CHECK(time["factor"] == 1.0);
}

TEST_CASE("render: the summary has the modelled time if the machine has one", "[cli]") {
    const std::string line = "modelled time of ";
    const auto summary = [](const std::string& machine) {
        return RenderFiles("planes", {"--machine", machine, "--offset", "0"}).run().out;
    };
    CHECK_THAT(summary("spa"), Catch::Contains("model   objects") && Catch::Contains(line + "spa)"));
    CHECK_THAT(summary("grande"), Catch::Contains(line + "grande)"));
    CHECK_THAT(summary("links"), !Catch::Contains(line));
    CHECK(RenderFiles("planes", {"--machine", "links", "--offset", "0"}).report()["modelled_ms"].is_null());
}

}  // namespace
}  // namespace raya
