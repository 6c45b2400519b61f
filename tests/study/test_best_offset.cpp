// The best offset: what the study recommends is the least of all that it lists.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <limits>
#include <map>

#include "host/ring/mapping.hpp"
#include "host/ring/schedule.hpp"
#include "host/study/offset_times.hpp"
#include "host/study/studies.hpp"
#include "tests/study/page_shape.hpp"

namespace raya {
namespace {

constexpr std::uint32_t kSize = 24;

using Key = std::pair<std::int64_t, std::string>;  // PEs, anti-aliasing

// Totals of every offset, from the long table.
std::map<Key, std::vector<double>> totals_of(const StudyPage& page, const std::string& scene) {
    std::map<Key, std::vector<double>> totals;
    for (const auto& row : table_of(page, "best-offset-all").rows) {
        if (std::get<std::string>(row[0]) != scene) continue;
        auto& list = totals[{std::get<std::int64_t>(row[1]), std::get<std::string>(row[2])}];
        CHECK(cell_number(row[3]) == static_cast<double>(list.size()));
        CHECK(cell_number(row[10]) ==
              Approx(cell_number(row[5]) + cell_number(row[6]) + cell_number(row[7]) + cell_number(row[9]))
                  .epsilon(1e-12));
        list.push_back(cell_number(row[10]));
    }
    return totals;
}

std::size_t least(const std::vector<double>& list, std::size_t count) {
    return static_cast<std::size_t>(std::min_element(list.begin(), list.begin() + static_cast<std::ptrdiff_t>(count)) -
                                    list.begin());
}

TEST_CASE("what is recommended takes least of all offsets", "[study]") {
    Session session(choose_device(""));
    Laboratory lab(session, kSize);
    const LabelledScene scene = embedded_scene("mirrors");
    const StudyPage page = study_best_offset(lab, {scene, embedded_scene("centre")});
    check_shape(page);
    const auto totals = totals_of(page, "mirrors");
    REQUIRE(totals.size() == 9);  // 24, 256 and 64 PEs, three ways of anti-aliasing
    const StudyTable& table = table_of(page, "best-offset");
    REQUIRE(table.rows.size() == 18);
    for (std::size_t i = 0; i < 9; ++i) {
        const auto& row = table.rows[i];
        const auto pes = std::get<std::int64_t>(row[2]);
        const std::vector<double>& list = totals.at({pes, std::get<std::string>(row[3])});
        REQUIRE(list.size() == kSize);
        const std::size_t best = least(list, kSize), root = std::size_t(std::lround(std::sqrt(pes))) % kSize;
        CHECK(cell_number(row[4]) == static_cast<double>(best));
        CHECK(cell_number(row[5]) == list[best]);
        CHECK(cell_number(row[8]) == static_cast<double>(least(list, root + 1)));
        CHECK(cell_number(row[11]) == list[root]);
        CHECK(cell_number(row[12]) == list[0]);
        const raya_mapping m = make_mapping("cyclic", kSize, kSize, static_cast<std::uint32_t>(pes),
                                            static_cast<std::uint32_t>(best), "cyclic");
        CHECK(cell_number(row[7]) == Approx(static_load(lab.costs(scene, kSize).trace, m).imbalance).epsilon(1e-9));
    }
    const auto best = [&](const char* method) { return least(totals.at({kSize, method}), kSize); };
    CHECK(page.findings.front() ==
          fmt::format("Use --offset {} without anti-aliasing, --offset {} with --antialias filter, --offset {} with "
                      "--antialias supersample: mirrors at 24 x 24 pixels on 24 PEs.",
                      best("none"), best("filter"), best("supersample")));
}

TEST_CASE("rotations make a distant offset dear", "[study]") {
    // Every pixel costs the same: no offset balances better, so with the ring the shortest way is best.
    Costs costs;
    costs.trace = {64, 64, std::vector<std::uint64_t>(64 * 64, 1000)};
    const auto filtered = offset_times(costs, 64, AntialiasMethod::kFilter);
    CHECK(best_offset_of(filtered, 64) == 0);
    CHECK(filtered[32].total_ms() > filtered[16].total_ms());
    CHECK(filtered[16].total_ms() == filtered[48].total_ms());
    CHECK(best_offset_of(offset_times(costs, 64, AntialiasMethod::kNone), 64) == 0);
}

TEST_CASE("best-offset takes the scene's own size, and centre where none is named", "[study]") {
    Session session(choose_device(""));
    Laboratory lab(session, 0);
    LabelledScene scene = embedded_scene("spheres");
    scene.scene.view.width = scene.scene.view.height = 40;
    CHECK(study_best_offset(lab, {scene}).settings["scenes"][0]["size"] == 40);
    Laboratory small(session, 16);
    const StudyPage page = study_best_offset(small, {});
    check_shape(page);
    CHECK(page.settings["scenes"][0]["scene"] == "centre");
    CHECK(page.settings["scenes"][0]["size"] == 16);
}

}  // namespace
}  // namespace raya
