// render --exposure: changes the values in 8-bit images. The report and the image file contain it.
#include <OpenImageIO/imageio.h>

#include "tests/cli/refusals.hpp"
#include "tests/cli/render_files.hpp"

namespace raya {
namespace {

TEST_CASE("render --exposure: changes the 8-bit values, not the hash; report and image contain it", "[cli]") {
    const Arguments tone = {"--exposure", "-1.5"};
    const RenderFiles default_render("planes", {}, ".ppm");
    CHECK(default_render.report()["image"]["exposure"] == 0.0);
    for (const std::string extension : {".ppm", ".png", ".tif", ".jpg"}) {
        CAPTURE(extension);
        const RenderFiles toned_render("planes", tone, extension);
        CHECK(toned_render.report()["image"]["hash"] == default_render.report()["image"]["hash"]);
        CHECK(toned_render.report()["image"]["exposure"] == -1.5);
        if (extension == ".ppm") {
            CHECK(file_contents(toned_render.image()) != file_contents(default_render.image()));
            continue;
        }
        const auto image = OIIO::ImageInput::open(toned_render.image());
        REQUIRE(image);
        if (extension != ".png") {
            const std::string description = image->spec().get_string_attribute("ImageDescription");
            CHECK_THAT(description, Catch::EndsWith("raya:exposure=-1.5"));
            continue;
        }
        CHECK(image->spec().get_string_attribute("raya:exposure") == "-1.5");
    }
}

TEST_CASE("render --exposure: refuses wrong values, and linear image formats", "[cli]") {
    const ScratchFolder outputs;
    const auto refused = [&](const std::string& image, const Arguments& options, const Arguments& message) {
        Arguments arguments = {"render", scene_file("planes"), "-o", outputs / image};
        arguments.insert(arguments.end(), options.begin(), options.end());
        check_refused(outputs, arguments, 2, message);
    };
    for (const char* image : {"x.exr", "x.pfm"}) {
        refused(image, {"--exposure", "1"}, {"--exposure applies to 8-bit images", image, "name a .png"});
    }
    refused("x.ppm", {"--exposure", "65"}, {"--exposure 65: must be -64..64 stops"});
    refused("x.ppm", {"--exposure", "nan"}, {"--exposure nan: must be -64..64 stops"});
    refused("x.ppm", {"--exposure", "bright"}, {"--exposure bright: not a number"});
}

}  // namespace
}  // namespace raya
