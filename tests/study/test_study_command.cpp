// raya study, as a user runs it: three files that agree, and what is refused.
#include <fmt/core.h>
#include <sys/stat.h>

#include <sstream>

#include "tests/cli/refusals.hpp"
#include "tests/document.hpp"

namespace raya {
namespace {

// Lines of fields; none of the fields that are tested here holds a comma.
std::vector<Words> csv_lines(const std::string& text) {
    std::vector<Words> rows;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        rows.emplace_back();
        std::istringstream fields(line);
        for (std::string field; std::getline(fields, field, ',');) rows.back().push_back(field);
    }
    return rows;
}

void check_csv_row(const Words& csv, const Document& scene, const Document& row) {
    REQUIRE(csv.size() == 12);
    CHECK(csv[0] == scene["scene"]);
    CHECK(csv[1] == row["format"]);
    CHECK(std::stoi(csv[2]) == row["exponent_bits"]);
    CHECK(std::stoi(csv[3]) == row["fraction_bits"]);
    CHECK(csv[4] == row["rounding"]);
    CHECK(std::stod(csv[5]) == row["psnr_db"]);
    CHECK(std::stod(csv[6]) == row["largest_error"]);
    CHECK(std::stoi(csv[7]) == row["pixels_over"]);
    CHECK(std::stod(csv[8]) == row["share_over"]);
    CHECK(csv[9] == row["image_hash"]);
    CHECK(std::stod(csv[10]) == row["measured"]["kernel_s"]);
    CHECK(std::stod(csv[11]) == row["measured"]["ratio_to_fp32"]);
}

std::string markdown_row(const Document& row) {
    return fmt::format("| {} | {:.2f} | {:.4f} | {:.3f} | {:.2f} | {:.2f} |\n", row["format"].get<std::string>(),
                       row["psnr_db"].get<double>(), row["largest_error"].get<double>(),
                       100 * row["share_over"].get<double>(), 1e3 * row["measured"]["kernel_s"].get<double>(),
                       row["measured"]["ratio_to_fp32"].get<double>());
}

TEST_CASE("the three files of a formats study are complete and agree", "[study]") {
    const ScratchFolder folder;
    const std::filesystem::path out = folder / "made/for/it";
    const Words scenes = {scene_file("centre"), scene_file("spheres")};
    const RunOutcome run = run_raya({"study", "formats", "-o", out, "--size", "16x12", "--samples", "1", "--lanes", "1",
                                     "--format", "e6m13t,spa22,fp32,e6m15", scenes[0], scenes[1]});
    INFO(run.told());
    REQUIRE(run.code == 0);
    CHECK(run.err.empty());
    CHECK(std::count(run.out.begin(), run.out.end(), '\n') == 4);  // a header, fp32, e6m13t, e6m15
    const auto json = Document::parse(file_contents(out / "formats.json"));
    const auto csv = csv_lines(file_contents(out / "formats.csv"));
    const std::string markdown = file_contents(out / "formats.md");
    CHECK(std::distance(std::filesystem::directory_iterator(out), std::filesystem::directory_iterator()) == 3);

    CHECK(json["image"] == Document{{"width", 16}, {"height", 12}});
    CHECK(json["machine"]["name"] == "grande");
    CHECK(json["machine"]["pes"] == 16);
    CHECK(json["device"]["lanes"] == 1);
    REQUIRE(json["scenes"].size() == 2);
    REQUIRE(csv.size() == 1 + 2 * 3);
    for (std::size_t s = 0; s < 2; ++s) {
        const auto& scene = json["scenes"][s];
        CHECK(scene["scene"] == scenes[s]);
        REQUIRE(scene["formats"].size() == 3);
        for (std::size_t i = 0; i < 3; ++i) {
            const auto& row = scene["formats"][i];
            CHECK(row["format"] == Words{"fp32", "e6m13t", "e6m15"}[i]);
            CHECK(row["share_over"] == row["pixels_over"].get<double>() / (16 * 12));
            check_csv_row(csv[1 + 3 * s + i], scene, row);
            CHECK_THAT(markdown, Catch::Contains(markdown_row(row)));
        }
    }
    CHECK(!json["seen"].empty());
    for (const auto& sentence : json["seen"])
        CHECK_THAT(markdown, Catch::Contains("- " + sentence.get<std::string>() + "\n"));
}

TEST_CASE("a study that there is not, or none, is refused with those that there are", "[study]") {
    const ScratchFolder outputs;
    check_refused(outputs, {"study", "speed", "-o", outputs / "x"}, 2, {"no command speed", "there are fig7"});
    check_refused(outputs, {"study"}, 2, {"raya: study: name a command: fig7"});
    CHECK_THAT(run_raya({"study", "--help"}).out,
               Catch::Contains("Usage: raya study COMMAND [OPTIONS]") && Catch::Contains("formats"));
}

TEST_CASE("options of a formats study that are out of range are refused before anything is made", "[study]") {
    const ScratchFolder outputs;
    const std::string folder = outputs / "x";
    const auto refused = [&](const Words& options, const Words& message) {
        Words arguments = {"study", "formats", "-o", folder};
        arguments.insert(arguments.end(), options.begin(), options.end());
        check_refused(outputs, arguments, 2, message);
    };
    refused({"--samples", "0"}, {"--samples 0", "1..1000"});
    refused({"--lanes", "0"}, {"--lanes 0", "1, 4, 8 or 16"});
    refused({"--size", "0"}, {"--size 0", "1..16384"});
    refused({"--format", "e9m30"}, {"--format e9m30", "eXmY"});
    refused({outputs / "none.nff"}, {"none.nff", "cannot read"});
    check_refused(outputs, {"study", "formats"}, 2, {"--output is required"});
}

TEST_CASE("a folder that cannot be made or written is refused", "[study]") {
    const ScratchFolder outputs;
    check_refused(outputs, {"study", "formats", "-o", "/dev/null/x"}, 2, {"/dev/null/x", "cannot create directory"});
    const ScratchFolder closed;
    ::chmod(closed.path().c_str(), 0555);
    check_refused(closed, {"study", "formats", "-o", closed.path()}, 2, {"formats.csv", "not writable"},
                  {.as_nobody = true});
}

}  // namespace
}  // namespace raya
