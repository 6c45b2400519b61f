// render --antialias: the report, the mask image, and refused options.
#include <algorithm>
#include <array>

#include "tests/cli/refusals.hpp"
#include "tests/cli/render_files.hpp"
#include "tests/document.hpp"
#include "tests/image/read_image.hpp"

namespace raya {
namespace {
using Loads = std::vector<std::uint64_t>;

constexpr std::uint64_t kPixels = kTestWidth * kTestHeight;

Arguments supersample_options(const Arguments& extra_options = {}) {
    Arguments options = {"--antialias", "supersample"};
    options.insert(options.end(), extra_options.begin(), extra_options.end());
    return options;
}

Loads sum_of(Loads a, const Loads& b) {
    REQUIRE(a.size() == b.size());
    std::transform(a.begin(), a.end(), b.begin(), a.begin(), std::plus<>());
    return a;
}

/// Returns the number of launches of commands with this label.
std::uint64_t launches_of(const Document& report, const std::string& label) {
    std::uint64_t launches = 0;
    for (const Document& command : report["measured"]["commands"])
        if (command["label"] == label) launches += command["launches"].get<std::uint64_t>();
    return launches;
}

/// Checks that each rotation consists of two copies: one copy moves all blocks except the last by one PE, and one moves
/// the last block to the opposite end of the array.
void check_rotations(const Document& report) {
    const Document& communication = report["communication"];
    const std::uint64_t rotations = communication["rotations"], pes = report["machine"]["pes"],
                        band = report["antialias"]["band_pixels"];
    CHECK(rotations > 0);
    CHECK(communication["rotation_words"] == rotations * pes * 3 * band);
    CHECK(launches_of(report, "ring.rotate_up") + launches_of(report, "ring.rotate_down") == 2 * rotations);
}

TEST_CASE("render --antialias none: the report has no rotations; the image equals that without the option", "[cli]") {
    const RenderFiles files("planes", {"--antialias", "none"});
    const Document report = files.report();
    CHECK(report["antialias"] == Document{{"method", "none"}});
    CHECK(report["load"]["trace"]["per_pe"] == report["load"]["per_pe"]);
    CHECK(report["communication"]["rotations"] == 0);
    CHECK_FALSE(contains(files.run().out, "ring "));
    CHECK(report["image"]["hash"] == RenderFiles("planes").report()["image"]["hash"]);
}

TEST_CASE("render --antialias filter: the counts of the report are consistent", "[cli]") {
    const RenderFiles files("planes", {"--antialias", "filter", "--offset", "3"});
    const Document report = files.report(), plain_report = RenderFiles("planes", {"--offset", "3"}).report();
    CHECK(report["antialias"] == Document{{"method", "filter"}, {"exchange", "ring"}, {"band_pixels", kTestHeight}});
    CHECK(report["communication"]["rotations"] == 2 + 2 * 3);  // left and right neighbours: 1 PE away, others: 3
    check_rotations(report);
    for (const char* part : {"rays", "tests", "shading", "load"}) CHECK(report[part] == plain_report[part]);
    CHECK(report["image"]["hash"] != plain_report["image"]["hash"]);
    CHECK(report["machine"]["pe_memory_used_bytes"] == plain_report["machine"]["pe_memory_used_bytes"].get<int>() +
                                                           2 * 12 * kTestHeight);  // sums, and a block in transit
    for (const char* label : {"filter.sum_rows", "filter.sum_columns"}) CHECK(launches_of(report, label) == 2);
    CHECK(launches_of(report, "filter.take_means") == 1);
    CHECK_THAT(files.run().out, Catch::Contains("ring    8 rotations, " + std::to_string(8 * 20 * 3 * 12) + " words"));
}

TEST_CASE("render --exchange bus: the report has number and time of the transfers; the image equals the ring's",
          "[cli]") {
    const auto options = [](const std::string& exchange) {
        return Arguments{"--antialias", "supersample", "--offset", "3", "--exchange", exchange};
    };
    const Document ring = RenderFiles("planes", options("ring")).report();
    const RenderFiles bus("planes", options("bus")), broadcast("planes", options("bus-broadcast"));
    constexpr std::uint64_t kBlock = 3 * kTestHeight;  // words of a PE's pixels: 3 for each pixel of a column
    for (const RenderFiles* files : {&bus, &broadcast}) {
        const Document report = files->report();
        const Document& communication = report["communication"];
        const bool by_transfers = files == &bus;
        CHECK(report["image"]["hash"] == ring["image"]["hash"]);
        CHECK(report["load"] == ring["load"]);
        CHECK(communication["rotations"] == 0);
        CHECK(communication["transfers"] ==
              (by_transfers ? 4 * kTestWidth : 0));  // one transfer per PE and neighbour; a broadcast reaches all PEs
        CHECK(communication["pe_broadcasts"] == (by_transfers ? 0 : kTestWidth));
        const std::uint64_t moves = by_transfers ? communication["transfers"] : communication["pe_broadcasts"];
        CHECK(communication[by_transfers ? "transfer_words" : "pe_broadcast_words"] == moves * kBlock);
        CHECK(launches_of(report, by_transfers ? "bus.send" : "bus.broadcast_from") == moves);
        CHECK(report["modelled_ms"]["communication"] ==
              Approx(1.375 + static_cast<double>(moves) * (0.1845 + kBlock / 6e3)).epsilon(1e-9));
        const std::string line = by_transfers ? " transfers between PEs, " : " broadcasts by PEs, ";
        CHECK_THAT(files->run().out, Catch::Contains("bus     " + std::to_string(moves) + line +
                                                     std::to_string(moves * kBlock) + " words"));
    }
}

TEST_CASE("render --antialias supersample: the counts of the report are consistent", "[cli]") {
    const RenderFiles files("planes", supersample_options({"--offset", "3"}));
    const Document report = files.report(), plain_report = RenderFiles("planes", {"--offset", "3"}).report();
    const Document &antialias = report["antialias"], &load = report["load"];
    const std::uint64_t recomputed = antialias["recomputed_pixels"];
    CHECK(antialias["method"] == "supersample");
    CHECK(antialias["threshold"] == 0.125);
    CHECK(antialias["points"] == "axes");
    CHECK(antialias["band_pixels"] == kTestHeight);
    CHECK(recomputed > kPixels / 20);
    CHECK(recomputed < kPixels);
    CHECK(antialias["recomputed_share"] == double(recomputed) / double(kPixels));
    CHECK(report["rays"]["primary"] == kPixels + 4 * recomputed);
    CHECK(load["trace"] == plain_report["load"]["trace"]);
    CHECK(load["per_pe"].get<Loads>() ==
          sum_of(load["trace"]["per_pe"].get<Loads>(), load["supersample"]["per_pe"].get<Loads>()));
    CHECK(report["communication"]["rotations"] == 2 + 2 * 3);
    check_rotations(report);
    CHECK(launches_of(report, "supersample.compare") == 4);
    CHECK(launches_of(report, "supersample") >= 1);
    CHECK_THAT(files.run().out,
               Catch::Contains("super   " + std::to_string(recomputed) + " pixels (") && Catch::Contains("super u = "));
}

TEST_CASE("render: --threshold selects the supersampled pixels; --points selects their sample points", "[cli]") {
    const Document all = RenderFiles("planes", supersample_options({"--threshold", "0"})).report();
    CHECK(all["antialias"]["threshold"] == 0.0);
    CHECK(all["antialias"]["recomputed_pixels"] == kPixels);
    CHECK(all["antialias"]["recomputed_share"] == 1.0);
    const Document axes = RenderFiles("planes", supersample_options()).report();
    const Document coarse = RenderFiles("planes", supersample_options({"--threshold", "0.5"})).report();
    CHECK(coarse["antialias"]["threshold"] == 0.5);
    CHECK(coarse["antialias"]["recomputed_pixels"] < axes["antialias"]["recomputed_pixels"]);
    const Document diagonals = RenderFiles("planes", supersample_options({"--points", "diagonals"})).report();
    CHECK(diagonals["antialias"]["points"] == "diagonals");
    CHECK(diagonals["antialias"]["recomputed_pixels"] == axes["antialias"]["recomputed_pixels"]);
    CHECK(diagonals["image"]["hash"] != axes["image"]["hash"]);
}

TEST_CASE("render --mask: white where pixels were supersampled, black elsewhere", "[cli]") {
    const std::string extension = GENERATE(".png", ".exr", ".pfm");
    const ScratchFolder folder;
    const std::string mask_file = folder / ("mask" + extension);
    const Document antialias = RenderFiles("planes", supersample_options({"--mask", mask_file})).report()["antialias"];
    const Image mask = read_image(mask_file);
    CAPTURE(extension);
    CHECK(folder.entries() == 1);
    REQUIRE(mask.width == kTestWidth);
    REQUIRE(mask.height == kTestHeight);
    std::uint64_t white_pixels = 0, invalid_pixels = 0;  // invalid: neither white nor black
    for (std::size_t i = 0; i < mask.rgb.size(); i += 3) {
        const std::array<float, 3> pixel = {mask.rgb[i], mask.rgb[i + 1], mask.rgb[i + 2]};
        white_pixels += pixel == std::array<float, 3>{1, 1, 1};
        invalid_pixels += pixel != std::array<float, 3>{1, 1, 1} && pixel != std::array<float, 3>{0, 0, 0};
    }
    CHECK(invalid_pixels == 0);
    CHECK(white_pixels == antialias["recomputed_pixels"]);
    CHECK(double(white_pixels) / double(kPixels) == antialias["recomputed_share"]);
}

TEST_CASE("render: refuses options of supersampling out of range, and those without --antialias supersample", "[cli]") {
    const ScratchFolder outputs;
    const auto refused = [&](const Arguments& options, const Arguments& message) {
        check_refused(outputs, render_into(outputs, scene_file("planes"), options), 2, message);
    };
    refused({"--antialias", "blur"}, {"--antialias blur", "none, filter or supersample"});
    refused({"--antialias", ""}, {"--antialias", "must not be empty"});
    refused(supersample_options({"--points", "corners"}), {"--points corners", "axes or diagonals"});
    refused(supersample_options({"--exchange", "torus"}), {"--exchange torus", "ring, bus or bus-broadcast"});
    refused({"--exchange", "bus"}, {"--exchange", "add --antialias filter or supersample"});
    for (const std::string value : {"-0.1", "1.001", "nan", "inf"})
        refused(supersample_options({"--threshold", value}), {"--threshold", "must be 0..1"});
    refused(supersample_options({"--threshold", "0.125x"}), {"--threshold 0.125x: not a number", "0..1"});
    for (const Arguments& option : {Arguments{"--threshold", "0.125"}, Arguments{"--points", "diagonals"},
                                    Arguments{"--points", "axes"}, Arguments{"--mask", outputs / "mask.png"}})
        for (const std::string method : {"none", "filter"}) {
            Arguments options = {"--antialias", method};
            options.insert(options.end(), option.begin(), option.end());
            refused(options, {option[0], "add --antialias supersample"});
        }
}

TEST_CASE("render --mask: refuses a file that it cannot write, before rendering", "[cli]") {
    const ScratchFolder outputs;
    const auto refused = [&](const std::string& mask, const Arguments& message) {
        check_refused(outputs, render_into(outputs, scene_file("planes"), supersample_options({"--mask", mask})), 2,
                      message);
    };
    for (const char* file : {"x.json", "./x.pfm"}) refused(outputs / file, {file, "--mask", "the same file as"});
    refused(scene_file("planes"), {"--mask", "would overwrite the input SCENE", "planes.nff"});
    refused("", {"--mask", "must not be empty"});
    refused(outputs / "mask.gif", {"mask.gif", ".png", ".exr", ".pfm", ".jpg"});
    refused(outputs / "missing/mask.png", {"/missing' does not exist", "mkdir -p"});
}

TEST_CASE("render --antialias: the error for a PE memory that is too small names the needed and the available size",
          "[cli]") {
    const ScratchFolder outputs;
    const auto refused = [&](const Arguments& options, const Arguments& message) {
        check_refused(outputs, render_into(outputs, scene_file("planes"), options), 2, message);
    };
    // A PE's memory holds the broadcast scene, and per pixel 24 bytes for the filter or 13 bytes for supersampling.
    refused({"--antialias", "filter", "--size", "256", "--pes", "1"},
            {"planes.nff with --antialias filter", "needs 153", " KB in every PE", "the SPA has 32 KB", "more PEs",
             "--machine grande"});
    refused(supersample_options({"--size", "256", "--pes", "1"}),
            {"planes.nff with --antialias supersample", "needs 83", " KB in every PE", "the SPA has 32 KB", "more PEs",
             "--machine grande"});
}

}  // namespace
}  // namespace raya
