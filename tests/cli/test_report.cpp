// The report of a render: its keys and types, and numbers that agree with each other, the scene and the images.
#include <algorithm>
#include <numeric>
#include <set>

#include "host/scene/nff.hpp"
#include "tests/cli/render_files.hpp"
#include "tests/document.hpp"
#include "tests/image/read_image.hpp"

namespace raya {
namespace {

void check_rays_and_tests(const Document& report, const Scene& scene) {
    const Document &rays = report["rays"], &tests = report["tests"], &shading = report["shading"];
    const std::uint64_t primary = rays["primary"], reflected = rays["reflected"], refracted = rays["refracted"],
                        shadow = rays["shadow"], shadow_hits = rays["shadow_hits"], hits = shading["hits"];
    const std::uint64_t all_rays = primary + reflected + refracted + shadow;
    CHECK(primary == report["image"]["width"].get<std::uint64_t>() * report["image"]["height"].get<std::uint64_t>());
    CHECK(rays["primary_hits"] <= primary);
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

using Loads = std::vector<std::uint64_t>;

Loads loads_of(const Document& report) { return report["load"]["per_pe"].get<Loads>(); }

std::uint64_t sum_of(const Loads& loads) { return std::accumulate(loads.begin(), loads.end(), std::uint64_t{0}); }

void check_load(const Document& report) {
    const Document& load = report["load"];
    const Loads per_pe = loads_of(report);
    const auto sum = static_cast<double>(sum_of(per_pe));
    const auto pes = static_cast<double>(per_pe.size());
    const auto [min, max] = std::minmax_element(per_pe.begin(), per_pe.end());
    const auto maximum = static_cast<double>(*max);
    CHECK(per_pe.size() == report["machine"]["pes"]);
    CHECK(load["unit"] == "cycles");
    CHECK(load["min"] == *min);
    CHECK(load["max"] == *max);
    const auto approx = [&](const char* key) { return Approx(load[key].get<double>()).epsilon(1e-12); };
    CHECK(sum / pes == approx("mean"));
    CHECK((maximum - sum / pes) / (sum / pes) == approx("imbalance"));
    CHECK(sum / maximum == approx("speedup"));
    CHECK(sum / maximum / pes == approx("efficiency"));
}

void check_communication(const Document& report) {
    const Document& communication = report["communication"];
    CHECK(communication["broadcasts"] == 1);
    CHECK(communication["broadcast_words"] > 0);
    CHECK(communication["rotations"] == 0);
    CHECK(communication["rotation_words"] == 0);
    CHECK(communication["gathers"] >= 1);
    CHECK(communication["gather_words"] == 3 * report["rays"]["primary"].get<std::uint64_t>());
}

void check_measured(const Document& report) {
    const Document& measured = report["measured"];
    CHECK(measured["build_s"] > 0);
    CHECK(measured["render_s"] > 0);
    std::set<std::string> labels;
    for (const Document& command : measured["commands"]) {
        INFO(command.dump());
        labels.insert(command["label"]);
        const double launches = command["launches"], total = command["total_ns"], mean = command["mean_ns"];
        CHECK(launches >= 1);
        CHECK(command["min_ns"] <= mean);
        CHECK(mean <= command["max_ns"]);
        CHECK(mean * launches == Approx(total).epsilon(1e-12));
        if (command["label"] == "bus.gather") CHECK(launches == report["communication"]["gathers"]);
    }
    for (const char* label : {"bus.broadcast", "trace", "bus.gather"}) CHECK(labels.count(label) == 1);
}

TEST_CASE("report: numbers agree with each other and with the scene", "[cli]") {
    const std::string name = GENERATE("centre", "glass", "polygons", "cones");
    CAPTURE(name);
    const Document report = RenderFiles(name, {"--pes", "5"}).report();
    check_rays_and_tests(report, read_nff(scene_file(name)));
    check_load(report);
    check_communication(report);
    check_measured(report);
}

TEST_CASE("report: contains the options of the render", "[cli]") {
    const Document report = RenderFiles("planes", {"--pes", "7", "--offset", "3", "--fold", "block", "--lanes", "1",
                                                   "--group", "2", "--bounces", "2"})
                                .report();
    INFO(report.dump());
    CHECK(report["scene"] == scene_file("planes"));
    CHECK(report["image"]["width"] == kTestWidth);
    CHECK(report["image"]["height"] == kTestHeight);
    CHECK(report["machine"]["name"] == "spa");
    CHECK(report["machine"]["topology"] == "ring+bus");
    CHECK(report["machine"]["pes"] == 7);
    CHECK(report["machine"]["mapping"] == "cyclic");
    CHECK(report["machine"]["offset"] == 3);
    CHECK(report["machine"]["fold"] == "block");
    CHECK(report["machine"]["format"] == "e6m15");
    CHECK(report["machine"]["bounces"] == 2);
    CHECK(report["machine"]["pe_memory_bytes"] == 32768);
    CHECK(report["machine"]["pe_memory_used_bytes"] <= 32768);
    CHECK(report["device"]["lanes"] == 1);
    CHECK(report["device"]["group_size"] == 2);
    for (const char* option : {"-DRAYA_LANES=1", "-DRAYA_GROUP=2", "-DRAYA_BOUNCES=2"})
        CHECK_THAT(report["device"]["build_options"].get<std::string>(), Catch::Contains(option));
    CHECK(RenderFiles("planes", {"--mapping", "column"}).report()["machine"]["offset"] == 0);
    CHECK(RenderFiles("planes", {"--machine", "grande"}).report()["machine"]["pes"] == kTestWidth);
}

TEST_CASE("report: names a mapping with slots by name and offset, other mappings by their full text", "[cli]") {
    struct Row {
        std::string mapping, name;
        Document offset, fold;
    };
    for (const Row& row : {Row{"cyclic", "cyclic", 16, "cyclic"}, Row{"cyclic:3", "cyclic", 3, "cyclic"},
                           Row{"column", "column", 0, "cyclic"}, Row{"grid:4x5", "grid:4x5", {}, {}},
                           Row{"tiles:5x3", "tiles:5x3", {}, {}}, Row{"random", "random:1", {}, {}}}) {
        const Document machine = RenderFiles("planes", {"--mapping", row.mapping}).report()["machine"];
        INFO(machine.dump());
        CHECK(machine["mapping"] == row.name);
        CHECK(machine["offset"] == row.offset);
        CHECK(machine["fold"] == row.fold);
    }
}

TEST_CASE("report: marks dynamic and hybrid mappings as simulated", "[cli]") {
    const Document static_report = RenderFiles("planes", {"--mapping", "cyclic"}).report();
    for (const char* mapping : {"dynamic:4", "dynamic:4,100", "hybrid:4,0,0.5"}) {
        const Document report = RenderFiles("planes", {"--mapping", mapping, "--pes", "9"}).report();
        INFO(report["load"].dump());
        CHECK(report["machine"]["mapping"] == mapping);
        CHECK(report["machine"]["offset"].is_null());
        CHECK(report["load"]["simulated"] == true);
        CHECK(report["load"]["requests"].get<int>() <= (kTestWidth * kTestHeight + 3) / 4);
        CHECK(report["load"]["per_pe"].size() == 9);
        CHECK(report["image"]["hash"] == static_report["image"]["hash"]);
    }
    CHECK(static_report["load"]["simulated"] == false);
    CHECK(RenderFiles("planes", {"--machine", "links"}).report()["machine"]["mapping"] == "dynamic:1,0,568");
}

TEST_CASE("report: the hash is that of the image file, and the costs in the cost image sum to the load", "[cli]") {
    const std::string extension = GENERATE(".exr", ".pfm");
    CAPTURE(extension);
    const RenderFiles files("centre", {"--pes", "5"}, extension, extension);
    const Document report = files.report();
    CHECK(report["image"]["hash"] == pixel_hash(read_image(files.image())));
    CHECK(report["image"]["file"] == files.image());
    const GreyImage cost = read_grey_image(files.cost());
    CHECK(cost.width == kTestWidth);
    CHECK(cost.height == kTestHeight);
    CHECK(std::accumulate(cost.values.begin(), cost.values.end(), 0.0) ==
          static_cast<double>(sum_of(loads_of(report))));
}

TEST_CASE("render --pes 1: one PE of the SPA gathers its image in blocks", "[cli]") {
    const Document one_pe = RenderFiles("centre", {"--size", "256", "--pes", "1"}).report();
    const Document many_pes = RenderFiles("centre", {"--size", "256", "--pes", "256"}).report();
    CHECK(one_pe["communication"]["gathers"] > 1);
    CHECK(many_pes["communication"]["gathers"] == 1);
    CHECK(one_pe["machine"]["pe_memory_used_bytes"] <= 32768);
    check_communication(one_pe);
    check_measured(one_pe);
    CHECK(one_pe["image"]["hash"] == many_pes["image"]["hash"]);
    CHECK(one_pe["rays"] == many_pes["rays"]);
    CHECK(one_pe["load"]["speedup"] == 1.0);
    CHECK(one_pe["load"]["max"] == sum_of(loads_of(many_pes)));
}

}  // namespace
}  // namespace raya
