// What a formats study writes and says, on made-up figures.
#include <catch2/catch.hpp>
#include <limits>
#include <string>

#include "host/study/formats_report.hpp"
#include "tests/document.hpp"

namespace raya {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

FormatRow row(const std::string& format, double psnr_db, double largest, std::size_t over, double ratio) {
    return {
        parse_format(format), {psnr_db, largest, over, static_cast<double>(over) / 100}, "00ff", 0.002 * ratio, ratio};
}

FormatsStudy made_up() {
    FormatsStudy study{.width = 10,
                       .height = 10,
                       .bounces = 8,
                       .machine = "grande",
                       .pes = 10,
                       .offset = 6,
                       .device = {},
                       .lanes = 4,
                       .group_size = 1,
                       .samples = 3,
                       .scenes = {}};
    study.device.name = "a device";
    study.scenes = {{"one",
                     3,
                     {row("fp32", 60, 0.125, 1, 1), row("e6m15", 42, 0.25, 2, 1.5), row("e6m15t", 40, 0.25, 4, 1.25),
                      row("e6m13", 36, 0.5, 8, 1.5)}},
                    {"two",
                     5,
                     {row("fp32", 55, 0.25, 0, 1), row("e6m15", 44, 0.75, 3, 2), row("e6m15t", 45, 0.5, 3, 1.75),
                      row("e6m13", 30, 0.5, 9, 2)}}};
    return study;
}

TEST_CASE("the overview takes the worst over all scenes", "[study]") {
    const auto all = formats_overview(made_up());
    REQUIRE(all.size() == 4);
    CHECK(all[0].worst_scene == "two");
    CHECK(all[0].psnr_db.lowest == 55);
    CHECK(all[1].worst_scene == "one");
    CHECK(all[1].psnr_db.lowest == 42);
    CHECK(all[1].psnr_db.highest == 44);
    CHECK(all[1].largest == 0.75);
    CHECK(all[1].share_over.lowest == 0.02);
    CHECK(all[1].share_over.highest == 0.03);
    CHECK(all[1].ratio.lowest == 1.5);
    CHECK(all[1].ratio.highest == 2);
    CHECK(formats_overview({}).empty());
}

TEST_CASE("findings are computed, and left out where their formats are missing", "[study]") {
    FormatsStudy study = made_up();
    const auto said = formats_findings(study);
    REQUIRE(said.size() == 3);
    CHECK(said[0] ==
          "spa22 (e6m15) has a PSNR of 42.0 to 44.0 dB, fp32 one of 55.0 to 60.0 dB; 2.00 to 3.00 % of its pixels are "
          "off by more than 1/255, 0.00 to 1.00 % of fp32's; it takes 1.50 to 2.00 times fp32's kernel time "
          "(measured).");
    CHECK(said[1] ==
          "Rounding to nearest has a higher PSNR than truncation in 1 of 2 pairs of the same format and scene: +0.5 dB "
          "on average (-1.0 to +2.0).");
    CHECK(said[2] == "From e6m13 to e6m15 the PSNR changes by +10.0 dB on average (+6.0 to +14.0).");
    for (SceneRows& scene : study.scenes) scene.rows.resize(1);
    CHECK(formats_findings(study).empty());
    CHECK(formats_findings({}).empty());
}

TEST_CASE("a gain that is not finite is left out of the averages", "[study]") {
    FormatsStudy study = made_up();
    study.scenes[0].rows[1].difference.psnr_db = kInfinity;
    CHECK(formats_findings(study)[2] ==
          "From e6m13 to e6m15 the PSNR changes by +14.0 dB on average (+14.0 to +14.0).");
}

TEST_CASE("CSV has a header and all digits; odd labels are quoted", "[study]") {
    FormatsStudy study = made_up();
    study.scenes.resize(1);
    study.scenes[0].rows.resize(2);
    study.scenes[0].label = "a \"b\", c";
    study.scenes[0].rows[1].difference.psnr_db = 42.123456789012345;
    CHECK(formats_csv(study) ==
          "scene,format,exponent_bits,fraction_bits,rounding,psnr_db,largest_error,pixels_over,share_over,image_hash,"
          "measured_kernel_s,measured_ratio_to_fp32\n"
          "\"a \"\"b\"\", c\",fp32,8,23,nearest,60,0.125,1,0.01,00ff,0.002,1\n"
          "\"a \"\"b\"\", c\",e6m15,6,15,nearest,42.123456789012344,0.25,2,0.02,00ff,0.003,1.5\n");
}

TEST_CASE("infinities are written as inf and -inf everywhere", "[study]") {
    FormatsStudy study = made_up();
    study.scenes[0].rows[0].difference = {kInfinity, 0, 0, 0};
    study.scenes[0].rows[1].difference = {-kInfinity, kInfinity, 7, 0.07};
    const auto json = Document::parse(formats_json(study).dump());
    CHECK(json["scenes"][0]["formats"][0]["psnr_db"] == "inf");
    CHECK(json["scenes"][0]["formats"][1]["psnr_db"] == "-inf");
    CHECK(json["scenes"][0]["formats"][1]["largest_error"] == "inf");
    CHECK_THAT(formats_csv(study), Catch::Contains("one,fp32,8,23,nearest,inf,0,0,0,") &&
                                       Catch::Contains("one,e6m15,6,15,nearest,-inf,inf,7,0.07,"));
    CHECK_THAT(formats_markdown(study), Catch::Contains("| fp32 | inf | 0.0000 | 0.000 | 2.00 | 1.00 |") &&
                                            Catch::Contains("| e6m15 | -inf | inf | 7.000 | 3.00 | 1.50 |"));
}

TEST_CASE("Markdown keeps a table whole whatever a scene is called", "[study]") {
    FormatsStudy study = made_up();
    study.scenes[1].label = "a|b";
    CHECK_THAT(formats_markdown(study), Catch::Contains("| fp32 | 55.00 | a\\|b | 0.2500 | 1.000 | 1.00 |\n") &&
                                            Catch::Contains("| e6m15 | 42.00 | one | 0.7500 | 3.000 | 1.50 to 2.00 |"));
}

}  // namespace
}  // namespace raya
