// The best offset: what the study recommends is the least of all that it lists.
#include <fmt/core.h>

#include <catch2/catch.hpp>
#include <limits>
#include <map>

#include "host/ring/schedule.hpp"
#include "host/study/arrays.hpp"
#include "host/study/ensemble.hpp"
#include "host/study/rows.hpp"
#include "host/study/spa_times.hpp"
#include "host/study/studies.hpp"
#include "tests/document.hpp"
#include "tests/study/study_cases.hpp"

namespace raya {
namespace {

constexpr std::uint32_t kSize = 24;

using Key = std::pair<double, std::string>;  // PEs, anti-aliasing

// Totals of every offset, from the long table.
std::map<Key, std::vector<double>> totals_of(const StudyPage& page, const std::string& scene) {
    std::map<Key, std::vector<double>> totals;
    const StudyTable& table = page.table("best-offset-all");
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
        if (table.at(row, "scene").text() != scene) continue;
        const auto figure = [&](const char* label) { return table.at(row, label).number(); };
        auto& list = totals[{figure("PEs"), table.at(row, "anti-aliasing").text()}];
        CHECK(figure("p") == static_cast<double>(list.size()));
        CHECK(figure("total") ==
              Approx(figure("first pass") + figure("neighbours' arithmetic") + figure("supersampling") + figure("ring"))
                  .epsilon(1e-12));
        list.push_back(figure("total"));
    }
    return totals;
}

std::size_t first_least(const std::vector<double>& list, std::size_t count) {
    return static_cast<std::size_t>(std::min_element(list.begin(), list.begin() + static_cast<std::ptrdiff_t>(count)) -
                                    list.begin());
}

TEST_CASE("what is recommended takes least of all offsets", "[study][slow]") {
    Session session(choose_device(""));
    Laboratory lab(session, kSize);
    const LabelledScene scene = embedded_scene("mirrors");
    const StudyPage page = study_best_offset(lab, {scene, embedded_scene("centre")});
    check_page(page);
    const auto totals = totals_of(page, "mirrors");
    REQUIRE(totals.size() == 9);  // 24, 256 and 64 PEs, three ways of anti-aliasing
    const StudyTable& table = page.table("best-offset");
    REQUIRE(table.rows.size() == 18);
    for (std::size_t i = 0; i < 9; ++i) {
        const auto figure = [&](const char* label) { return table.at(i, label).number(); };
        const auto pes = static_cast<std::uint32_t>(figure("PEs"));
        const std::vector<double>& list = totals.at({pes, table.at(i, "anti-aliasing").text()});
        REQUIRE(list.size() == kSize);
        const std::size_t best = first_least(list, kSize), root = std::size_t(std::lround(std::sqrt(pes))) % kSize;
        CHECK(figure("best p") == static_cast<double>(best));
        CHECK(figure("time") == list[best]);
        CHECK(figure("best p of 0..sqrt(P)") == static_cast<double>(first_least(list, root + 1)));
        CHECK(figure("p = sqrt(P)") == list[root]);
        CHECK(figure("p = 0") == list[0]);
        const raya_mapping m = cyclic(kSize, kSize, pes, static_cast<std::uint32_t>(best));
        CHECK(figure("u, first pass") == Approx(static_load(lab.costs(scene, kSize).trace, m).imbalance).epsilon(1e-9));
    }
    // The best for each factor of 1 to 8, with nothing to bring from neighbours, is the same.
    CHECK(table.at(0, "best p, factors 1 to 8").text() == fmt::format("{}", table.at(0, "best p").number()));
    for (std::size_t i = 0; i < 9; ++i) {  // that of the clock's factor lies between the others
        const auto pes = static_cast<std::uint32_t>(table.at(i, "PEs").number());
        const std::string name = table.at(i, "anti-aliasing").text(),
                          all = table.at(i, "best p, factors 1 to 8").text();
        const auto method = name == "none"     ? AntialiasMethod::kNone
                            : name == "filter" ? AntialiasMethod::kFilter
                                               : AntialiasMethod::kSupersample;
        std::string expected;
        for (int factor = 1; factor <= 8; ++factor) {
            const auto times =
                offset_times(lab.costs(scene, kSize, AntialiasMethod::kSupersample), pes, method, factor);
            const std::string one = fmt::format("{}", least(times, &OffsetTime::total_ms).offset);
            if (("," + expected + ",").find("," + one + ",") == std::string::npos)
                expected += (expected.empty() ? "" : ",") + one;
        }
        std::string compact = all;
        std::erase(compact, ' ');
        CHECK(compact == expected);
    }
    const auto best = [&](const char* method) { return first_least(totals.at({kSize, method}), kSize); };
    CHECK(page.findings.front() ==
          fmt::format("Use --offset {} without anti-aliasing, --offset {} with --antialias filter, --offset {} with "
                      "--antialias supersample: mirrors at 24 x 24 pixels on 24 PEs.",
                      best("none"), best("filter"), best("supersample")));
}

TEST_CASE("offsets are chosen by half of the views and judged by the others", "[study]") {
    constexpr std::uint32_t kSide = 65;
    Session session(choose_device(""));
    Laboratory lab(session, kSide);
    const LabelledScene scene = embedded_scene("spheres");
    const StudyPage page = study_best_offset(lab, {scene});
    const StudyTable& table = page.table("best-offset-views");
    const Ensemble ensemble = ensemble_of(lab, scene, kSide, AntialiasMethod::kSupersample, 40);
    const double factor = machine_factor().value;
    std::vector<double> sums(kSide), best, zero;  // 65 PEs, the filter
    const auto ms_of = [&](std::size_t view) {
        return each(offset_times(*ensemble.views[view], kSide, AntialiasMethod::kFilter, factor),
                    &OffsetTime::total_ms);
    };
    for (std::size_t view = 0; view < ensemble.views.size(); view += 2) {
        const auto ms = ms_of(view);
        for (std::size_t p = 0; p < kSide; ++p) sums[p] += ms[p];
    }
    const std::size_t chosen = first_least(sums, kSide);
    for (std::size_t view = 1; view < ensemble.views.size(); view += 2) {
        const auto ms = ms_of(view);
        best.push_back(ms[chosen]);
        zero.push_back(100 * (ms[0] / ms[chosen] - 1));
    }
    CHECK(table.at(1, "anti-aliasing").text() == "filter");
    CHECK(table.at(1, "best p").number() == static_cast<double>(chosen));
    CHECK(table.at(1, "best p of 0..sqrt(P)").number() == static_cast<double>(first_least(sums, 9)));
    CHECK(table.at(1, "time").number() == Approx(estimate_of(best).mean));
    CHECK(table.at(1, "time, +-").number() == Approx(estimate_of(best).half_width));
    CHECK(table.at(1, "p = 0 takes longer").number() == Approx(estimate_of(zero).mean));
    CHECK(table.at(1, "p = 0, +-").number() == Approx(estimate_of(zero).half_width));
    // 64 PEs and an offset of 64 = n^2: on 65 columns the shear does not come round to the same PEs.
    CHECK(page.claims[1].verdict == ClaimVerdict::kNotReproduced);
}

TEST_CASE("rotations make a distant offset dear", "[study]") {
    // Every pixel costs the same: no offset balances better, so with the ring the shortest way is best.
    Costs costs;
    costs.trace = {64, 64, std::vector<std::uint64_t>(64 * 64, 1000)};
    const auto filtered = offset_times(costs, 64, AntialiasMethod::kFilter, 1);
    CHECK(least(filtered, &OffsetTime::total_ms).offset == 0);
    CHECK(filtered[32].total_ms() > filtered[16].total_ms());
    CHECK(filtered[16].total_ms() == filtered[48].total_ms());
    CHECK(least(offset_times(costs, 64, AntialiasMethod::kNone, 1), &OffsetTime::total_ms).offset == 0);
}

TEST_CASE("best-offset takes the scene's own size, and centre where none is named", "[study]") {
    Session session(choose_device(""));
    Laboratory lab(session, 0);
    LabelledScene scene = embedded_scene("spheres");
    scene.scene.view.width = scene.scene.view.height = 40;
    CHECK(read_back(study_best_offset(lab, {scene}).settings)["scenes"][0]["size"] == 40);
    Laboratory small(session, 16);
    const StudyPage page = study_best_offset(small, {});
    check_page(page);
    REQUIRE(page.claims.size() == 2);
    CHECK(page.claims[1].verdict == ClaimVerdict::kCannotTell);  // no number of PEs has an offset n^2 below 16
    CHECK(read_back(page.settings)["scenes"][0]["scene"] == "centre");
    CHECK(read_back(page.settings)["scenes"][0]["size"] == 16);
}

}  // namespace
}  // namespace raya
