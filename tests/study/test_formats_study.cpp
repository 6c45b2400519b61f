// The formats study itself, on small images: its figures against the reference's own comparison, and what must hold of
// number formats.
#include <catch2/catch.hpp>

#include "host/study/formats_study.hpp"
#include "tests/reference/reference.hpp"
#include "tests/ring/render_scene.hpp"

namespace raya {
namespace {

FormatsStudy small_study(const std::vector<LabelledScene>& scenes, const std::vector<std::string>& names,
                         std::uint32_t side, const ProgressCallback& progress = {}) {
    Session session(choose_device(""));
    FormatsSettings settings{.width = side, .height = side, .lanes = 1, .samples = 2, .formats = {}};
    for (const std::string& name : names) settings.formats.push_back(parse_format(name));
    return run_formats_study(session, scenes, settings, progress);
}

std::vector<LabelledScene> only(const std::string& name) { return {{name, project_scene(name)}}; }

TEST_CASE("the default study has the formats and scenes that it promises", "[study]") {
    std::vector<std::string> names;
    for (const NumberFormat& format : reduced_formats()) names.push_back(format_name(format));
    CHECK(names == std::vector<std::string>{"e8m21", "e8m21t", "e8m18", "e8m18t", "e8m15", "e8m15t", "e7m15", "e7m15t",
                                            "e6m15", "e6m15t", "e6m14", "e6m14t", "e6m13", "e6m13t"});
    std::vector<std::string> labels;
    for (const LabelledScene& scene : embedded_study_scenes()) {
        labels.push_back(scene.label);
        CHECK(scene.scene == project_scene(scene.label));
    }
    CHECK(labels == std::vector<std::string>{"centre", "spheres", "glass", "polygons", "cones"});
}

TEST_CASE("fp32's figures are those of the renderer and of the reference's own comparison", "[study]") {
    constexpr std::uint32_t kSide = 40;
    const FormatsStudy study = small_study(only("spheres"), {}, kSide);
    REQUIRE(study.scenes.size() == 1);
    REQUIRE(study.scenes[0].rows.size() == 1);
    const FormatRow& row = study.scenes[0].rows[0];
    // Other PEs than the study's: the image is the same.
    const Image image =
        render_scene(project_scene("spheres"), {.width = kSide, .height = kSide, .pes = 7, .lanes = 1}).image;
    CHECK(row.image_hash == pixel_hash(image));
    const Scene scene = project_scene("spheres");
    const reference::Options options{.width = kSide, .height = kSide};
    const reference::Difference d =
        reference::compare(reference::render(scene, options), image.rgb, scene, options, kShownStep);
    CHECK(row.difference.psnr_db == Approx(d.psnr_db).epsilon(1e-12));
    CHECK(row.difference.largest == d.largest);
    CHECK(row.difference.over == static_cast<std::size_t>(d.over));
    CHECK(row.ratio_to_fp32 == 1);
}

TEST_CASE("fp32 is never further from the reference than the SPA's format", "[study][slow]") {
    const FormatsStudy study = small_study(embedded_study_scenes(), {"spa22"}, 32);
    REQUIRE(study.scenes.size() == 5);
    for (const SceneRows& scene : study.scenes) {
        CAPTURE(scene.label);
        REQUIRE(scene.rows.size() == 2);
        CHECK(scene.rows[0].format.is_fp32());
        CHECK(format_name(scene.rows[1].format) == "e6m15");
        CHECK(scene.rows[0].difference.psnr_db >= scene.rows[1].difference.psnr_db);
        CHECK(scene.rows[0].difference.over <= scene.rows[1].difference.over);
        CHECK(scene.rows[1].kernel_s > 0);
        CHECK(scene.rows[1].ratio_to_fp32 == scene.rows[1].kernel_s / scene.rows[0].kernel_s);
    }
}

TEST_CASE("more fraction bits do not lose quality", "[study]") {
    // At an edge a pixel may fall to the wrong side by luck, so a gain may be small or slightly negative: 1 dB is a
    // quarter more squared error, where another bit should leave a quarter of it.
    constexpr double kLittleDb = 1;
    const FormatsStudy study = small_study(only("spheres"), {"e6m13", "e6m14", "e6m15"}, 96);
    const auto& rows = study.scenes[0].rows;
    for (std::size_t i = 2; i < rows.size(); ++i) {
        CAPTURE(format_name(rows[i].format), rows[i - 1].difference.psnr_db);
        CHECK(rows[i].difference.psnr_db >= rows[i - 1].difference.psnr_db - kLittleDb);
    }
    CHECK(rows[3].difference.psnr_db > rows[1].difference.psnr_db);
}

TEST_CASE("progress rises to 1, one step for each reference image, build and render", "[study]") {
    std::vector<double> told;
    small_study(only("cones"), {"spa22"}, 8, [&](double done) { told.push_back(done); });
    REQUIRE(told.size() == 1 + 2 * (1 + 2));
    for (std::size_t i = 0; i < told.size(); ++i)
        CHECK(told[i] == static_cast<double>(i + 1) / static_cast<double>(told.size()));
}

}  // namespace
}  // namespace raya
