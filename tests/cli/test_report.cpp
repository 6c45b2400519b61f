// The report of a render: its numbers agree with each other, with the scene, with the images, and with modelled times
// computed in this file. tools.reports checks its members.
#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "host/scene/nff.hpp"
#include "tests/cli/refusals.hpp"
#include "tests/cli/render_files.hpp"
#include "tests/document.hpp"
#include "tests/image/read_image.hpp"

namespace raya {
namespace {

using Loads = std::vector<std::uint64_t>;

constexpr std::uint64_t kPixels = kTestWidth * kTestHeight;

std::uint64_t sum_of(const Document& load) {
    const Loads loads = load["per_pe"].get<Loads>();
    return std::accumulate(loads.begin(), loads.end(), std::uint64_t{0});
}

void check_rays_and_tests(const Document& report, const Scene& scene) {
    const Document &rays = report["rays"], &tests = report["tests"], &shading = report["shading"];
    const std::uint64_t primary = rays["primary"], reflected = rays["reflected"], refracted = rays["refracted"],
                        shadow = rays["shadow"], shadow_hits = rays["shadow_hits"], hits = shading["hits"];
    const std::uint64_t all_rays = primary + reflected + refracted + shadow;
    CHECK(primary == kPixels);
    CHECK(rays["primary_hits"] <= hits);
    CHECK(hits <= primary + reflected + refracted);
    CHECK(shadow <= hits * scene.lights.size());
    CHECK(shading["lit"] == shadow - shadow_hits);
    CHECK(shading["highlights"] <= shading["lit"]);
    CHECK(tests["sphere"] == all_rays * scene.spheres.size());
    CHECK(tests["plane"] == all_rays * scene.planes.size());
    CHECK(tests["polygon"] == all_rays * scene.polygons.size());
    CHECK(tests["cone"] == all_rays * scene.cones.size());
}

void check_load(const Document& report) {
    const Document& load = report["load"];
    const Loads per_pe = load["per_pe"].get<Loads>();
    const auto sum = static_cast<double>(sum_of(load)), pes = static_cast<double>(per_pe.size());
    const auto [min, max] = std::minmax_element(per_pe.begin(), per_pe.end());
    const auto maximum = static_cast<double>(*max);
    CHECK(per_pe.size() == report["machine"]["pes"]);
    CHECK((load["unit"] == "cycles" && load["min"] == *min && load["max"] == *max));
    const auto approx = [&](const char* key) { return Approx(load[key].get<double>()).epsilon(1e-12); };
    CHECK(sum / pes == approx("mean"));
    CHECK((maximum - sum / pes) / (sum / pes) == approx("imbalance"));
    CHECK(sum / maximum == approx("speedup"));
    CHECK(sum / maximum / pes == approx("efficiency"));
    const Document& budget = report["budget"];  // cycles (host/model/budget.hpp): division 6, square root 8, branch 3
    CHECK(sum_of(load) == budget["multiply_accumulates"].get<std::uint64_t>() +
                              6 * budget["divisions"].get<std::uint64_t>() + 8 * budget["roots"].get<std::uint64_t>() +
                              budget["moves"].get<std::uint64_t>() + 3 * budget["branches"].get<std::uint64_t>());
}

/// Returns the number of launches of commands with this label.
std::uint64_t launches_of(const Document& report, const std::string& label) {
    std::uint64_t launches = 0;
    for (const Document& command : report["measured"]["commands"])
        if (command["label"] == label) launches += command["launches"].get<std::uint64_t>();
    return launches;
}

void check_communication(const Document& report) {
    const Document& communication = report["communication"];
    CHECK((communication["broadcasts"] == 1 && communication["broadcast_words"] > 0));
    CHECK(communication["gathers"] == launches_of(report, "bus.gather"));
    CHECK(communication["gather_words"] ==
          3 * report["image"]["width"].get<std::uint64_t>() * report["image"]["height"].get<std::uint64_t>());
    const Document& measured = report["measured"];
    CHECK((measured["build_s"] > 0 && measured["render_s"] > 0));
    for (const Document& command : measured["commands"]) {
        const double launches = command["launches"], total = command["total_ns"], mean = command["mean_ns"];
        CHECK((command["min_ns"] <= mean && mean <= command["max_ns"]));
        CHECK(mean * launches == Approx(total).epsilon(1e-12));
    }
}

TEST_CASE("report: numbers agree with each other and with the scene", "[cli]") {
    const Arguments spa22 = {"--pes", "5"}, fp32 = {"--pes", "5", "--format", "fp32", "--bounces", "4"};
    for (const std::string name : {"centre", "glass", "polygons", "cones"}) {
        CAPTURE(name);
        const Document report = RenderFiles(name, name == "centre" || name == "glass" ? spa22 : fp32).report();
        check_rays_and_tests(report, read_nff(scene_file(name)));
        check_load(report);
        check_communication(report);
    }
}

TEST_CASE("report: contains the options of the render, and the mapping's canonical name", "[cli]") {
    const Document report = RenderFiles("planes", {"--pes", "7", "--offset", "3", "--fold", "block"}).report();
    const Document& machine = report["machine"];
    INFO(report.dump());
    CHECK(
        (machine["pes"] == 7 && machine["offset"] == 3 && machine["fold"] == "block" && machine["format"] == "e6m15"));
    CHECK((machine["pe_memory_bytes"] == 32768 && machine["pe_memory_used_bytes"] <= 32768));
    CHECK((report["device"]["lanes"] == 4 && report["device"]["group_size"] == 1));
    CHECK_THAT(report["device"]["build_options"].get<std::string>(), Catch::Contains("-DRAYA_LANES=4"));
    struct Row {
        std::string mapping, name;
        Document offset, fold;
    };
    const Document usual = RenderFiles("planes").report();
    for (const Row& row : {Row{"cyclic:3", "cyclic", 3, "cyclic"}, Row{"column", "column", 0, "cyclic"},
                           Row{"tiles:5x3", "tiles:5x3", {}, {}}, Row{"random", "random:1", {}, {}},
                           Row{"dynamic:4", "dynamic:4", {}, {}}, Row{"hybrid:4,0,0.5", "hybrid:4,0,0.5", {}, {}}}) {
        const Document other = RenderFiles("planes", {"--mapping", row.mapping}).report();
        INFO(other["machine"].dump());
        CHECK(other["machine"]["mapping"] == row.name);
        CHECK((other["machine"]["offset"] == row.offset && other["machine"]["fold"] == row.fold));
        CHECK(other["load"]["simulated"] == (contains(row.mapping, "dynamic") || contains(row.mapping, "hybrid")));
        CHECK(other["image"]["hash"] == usual["image"]["hash"]);
    }
}

TEST_CASE("report: the hash is that of the image file, and the costs in the cost image sum to the load", "[cli]") {
    for (const std::string extension : {".exr", ".pfm"}) {
        const RenderFiles files("centre", {"--pes", "5"}, extension, extension);
        const Document report = files.report();
        CHECK(report["image"]["hash"] == pixel_hash(read_image(files.image())));
        const GreyImage cost = read_grey_image(files.cost());
        CHECK((cost.width == kTestWidth && cost.height == kTestHeight));
        CHECK(std::accumulate(cost.values.begin(), cost.values.end(), 0.0) ==
              static_cast<double>(sum_of(report["load"])));
    }
}

TEST_CASE("render --pes 1: one PE of the SPA gathers its image in blocks", "[cli]") {
    const Document one_pe = RenderFiles("centre", {"--size", "256", "--pes", "1"}).report();
    const Document many_pes = RenderFiles("centre", {"--size", "256", "--pes", "256"}).report();
    CHECK((one_pe["communication"]["gathers"] > 1 && many_pes["communication"]["gathers"] == 1));
    check_communication(one_pe);
    CHECK(one_pe["image"]["hash"] == many_pes["image"]["hash"]);
    CHECK(one_pe["rays"] == many_pes["rays"]);
    CHECK(one_pe["load"]["max"] == sum_of(many_pes["load"]));
}

TEST_CASE("render --antialias: counts of the exchange, of supersampled pixels, and modelled times", "[cli]") {
    constexpr std::uint64_t kBlock = 3 * kTestHeight;  // words of a PE's pixels: 3 for each pixel of a column
    const Document plain = RenderFiles("planes", {"--offset", "3"}).report();
    std::map<std::string, Document> hashes;
    for (const std::string method : {"none", "filter", "supersample"})
        for (const std::string exchange : {"ring", "bus", "bus-broadcast"}) {
            if (method == "none" && exchange != "ring") continue;
            Arguments options = {"--offset", "3", "--antialias", method};
            if (method != "none") options.insert(options.end(), {"--exchange", exchange});
            const Document report = RenderFiles("planes", options).report();
            const Document &communication = report["communication"], &load = report["load"],
                           &ms = report["modelled_ms"];
            CAPTURE(method, exchange, communication.dump(), ms.dump());
            check_load(report);
            hashes.emplace(method, report["image"]["hash"]);
            CHECK(report["image"]["hash"] == hashes.at(method));  // does not depend on the exchange
            CHECK((report["image"]["hash"] == plain["image"]["hash"]) == (method == "none"));
            const bool moves = method != "none";
            const std::uint64_t rotations = moves && exchange == "ring" ? 2 + 2 * 3 : 0,  // neighbours 1 and 3 PEs away
                transfers = moves && exchange == "bus" ? 4 * kTestWidth : 0,
                                broadcasts = moves && exchange == "bus-broadcast"
                                                 ? (method == "filter" ? 4 : 1) * kTestWidth
                                                 : 0;
            CHECK((communication["rotations"] == rotations && communication["transfers"] == transfers &&
                   communication["pe_broadcasts"] == broadcasts));
            CHECK(communication["rotation_words"] == rotations * kTestWidth * kBlock);
            CHECK(communication["transfer_words"] == transfers * kBlock);
            CHECK(communication["pe_broadcast_words"] == broadcasts * kBlock);
            // A rotation is two copies: of all blocks but the last by one PE, and of the last to the opposite end.
            CHECK(launches_of(report, "ring.rotate_up") + launches_of(report, "ring.rotate_down") == 2 * rotations);
            CHECK(launches_of(report, "bus.send") == transfers);
            CHECK(launches_of(report, "bus.broadcast_from") == broadcasts);

            std::uint64_t max_load = load["trace"]["max"];
            if (method == "supersample") {
                const std::uint64_t recomputed = report["antialias"]["recomputed_pixels"];
                CHECK((recomputed > kPixels / 20 && recomputed < kPixels));
                CHECK(report["rays"]["primary"] == kPixels + 4 * recomputed);
                CHECK(sum_of(load) == sum_of(load["trace"]) + sum_of(load["supersample"]));
                CHECK(load["trace"] == plain["load"]["trace"]);
                max_load += load["supersample"]["max"].get<std::uint64_t>();
            } else {
                CHECK(report["rays"] == plain["rays"]);
            }
            // The formulas of the modelled times: tests/model/test_time_model.cpp.
            const double ms_per_cycle = 1e-4 * 7 / 1.0752;
            CHECK((ms["filter"] > 0) == (method == "filter"));
            CHECK((ms["compare"] > 0) == (method == "supersample"));
            CHECK((ms["communication"] > 0) == moves);
            CHECK(ms["compute"].get<double>() == Approx(ms_per_cycle * static_cast<double>(max_load) +
                                                        ms["filter"].get<double>() + ms["compare"].get<double>()));
            double total = 0;
            for (const char* part : {"objects", "compute", "communication", "image", "display"})
                total += ms[part].get<double>();
            CHECK(ms["total"].get<double>() == Approx(total));
        }
}

TEST_CASE("render: --threshold and --points select the supersampled pixels and their points; --mask shows them",
          "[cli]") {
    const auto antialias_with = [](Arguments options) {
        options.insert(options.begin(), {"--antialias", "supersample"});
        const Document report = RenderFiles("planes", options).report();
        return std::pair<Document, std::string>(report["antialias"], report["image"]["hash"]);
    };
    CHECK(antialias_with({"--threshold", "0"}).first["recomputed_pixels"] == kPixels);
    const ScratchFolder folder;
    const auto [axes, axes_hash] = antialias_with({"--mask", folder / "mask.png"});
    const std::uint64_t recomputed = axes["recomputed_pixels"];
    CHECK(axes["recomputed_share"] == double(recomputed) / double(kPixels));
    CHECK(antialias_with({"--threshold", "0.5"}).first["recomputed_pixels"] < recomputed);
    const auto [diagonals, diagonals_hash] = antialias_with({"--points", "diagonals"});
    CHECK((diagonals["recomputed_pixels"] == recomputed && diagonals_hash != axes_hash));
    const Image mask = read_image(folder / "mask.png");
    CHECK((mask.width == kTestWidth && mask.height == kTestHeight));
    CHECK(std::ranges::count(mask.rgb, 1.0f) == static_cast<long>(3 * recomputed));
    CHECK(std::ranges::count(mask.rgb, 0.0f) == static_cast<long>(3 * (kPixels - recomputed)));
}

}  // namespace
}  // namespace raya
