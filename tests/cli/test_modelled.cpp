// The modelled times of a report: they equal times computed in this file from the report's counts.
#include <numeric>

#include "tests/cli/render_files.hpp"
#include "tests/document.hpp"

namespace raya {
namespace {

/// Returns the modelled cycles (host/model/budget.hpp): division 6, square root 8, branch 3, other operations 1.
std::uint64_t cycles_of(const Document& budget) {
    return budget["multiply_accumulates"].get<std::uint64_t>() + 6 * budget["divisions"].get<std::uint64_t>() +
           8 * budget["roots"].get<std::uint64_t>() + budget["moves"].get<std::uint64_t>() +
           3 * budget["branches"].get<std::uint64_t>();
}

std::uint64_t sum_of_loads(const Document& load) {
    const auto per_pe = load["per_pe"].get<std::vector<std::uint64_t>>();
    return std::accumulate(per_pe.begin(), per_pe.end(), std::uint64_t{0});
}

Approx approximately(double value) { return Approx(value).epsilon(1e-9); }

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
    const Document &modelled_ms = report["modelled_ms"], &communication = report["communication"],
                   &load = report["load"];
    INFO(modelled_ms.dump());
    const bool filter = antialias == "filter", supersample = antialias == "supersample";
    const double max_pixels = 3 * 12;  // number of pixels of the busiest PE: 3 of 20 columns, 12 rows
    const double setup_ms = 1.375, ms_per_word = (140 - setup_ms) / 196'608;  // of a transfer between host and PEs
    const double ms_per_cycle = 1e-4 * 7 / 1.0752;
    CHECK(modelled_ms["filter"] == approximately(filter ? 42 * ms_per_cycle * max_pixels : 0));
    CHECK(modelled_ms["compare"] == approximately(supersample ? 121 * ms_per_cycle * max_pixels : 0));
    double max_load = load["trace"]["max"];
    if (supersample) max_load += load["supersample"]["max"].get<double>();
    CHECK(modelled_ms["compute"] == approximately(ms_per_cycle * max_load + modelled_ms["filter"].get<double>() +
                                                  modelled_ms["compare"].get<double>()));
    CHECK(modelled_ms["objects"] ==
          approximately(setup_ms + ms_per_word * communication["broadcast_words"].get<double>()));
    CHECK(modelled_ms["image"] == approximately(setup_ms + ms_per_word * communication["gather_words"].get<double>()));
    CHECK(modelled_ms["display"] == approximately(1130 * 20 * 12 / 65'536.0));
    CHECK(modelled_ms["communication"] ==
          approximately((antialias != "none" ? setup_ms : 0) + 0.1845 * communication["rotations"].get<double>() +
                        communication["rotation_words"].get<double>() / 8 / 6e3));
    CHECK((modelled_ms["communication"] > 0) == (antialias != "none"));
    CHECK(modelled_ms["total"] ==
          approximately(modelled_ms["objects"].get<double>() + modelled_ms["compute"].get<double>() +
                        modelled_ms["communication"].get<double>() + modelled_ms["image"].get<double>() +
                        modelled_ms["display"].get<double>()));
    CHECK(modelled_ms["factor"] == approximately(7 / 1.0752));
}

TEST_CASE("render: the summary has the machine's modelled time", "[cli]") {
    const std::string line = "modelled time of ";
    const auto summary = [](const std::string& machine) {
        return RenderFiles("planes", {"--machine", machine, "--offset", "0"}).run().out;
    };
    CHECK_THAT(summary("spa"), Catch::Contains("model   objects") && Catch::Contains(line + "spa)"));
    CHECK_THAT(summary("grande"), Catch::Contains(line + "grande)"));
    CHECK_THAT(summary("links"), Catch::Contains(line + "links)"));
}

}  // namespace
}  // namespace raya
