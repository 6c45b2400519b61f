// --exposure, --gamma, --tone: what an 8-bit picture is made with, told in report and picture; the hash stays.
#include <OpenImageIO/imageio.h>

#include "tests/cli/refusals.hpp"
#include "tests/cli/render_files.hpp"

namespace raya {
namespace {

TEST_CASE("a tone changes codes, never the hash, and report and picture tell it", "[cli]") {
    const Words tone = {"--exposure", "-1.5", "--gamma", "2.2", "--tone", "reinhard"};
    const RenderFiles usual("planes", {}, ".ppm");
    CHECK(usual.report()["image"]["codes"] == Document({{"exposure", 0.0}, {"tone", "clip"}, {"gamma", nullptr}}));
    for (const std::string extension : {".ppm", ".png", ".tif", ".jpg"}) {
        CAPTURE(extension);
        const RenderFiles toned("planes", tone, extension);
        CHECK(toned.report()["image"]["hash"] == usual.report()["image"]["hash"]);
        CHECK(toned.report()["image"]["codes"] == Document({{"exposure", -1.5}, {"tone", "reinhard"}, {"gamma", 2.2}}));
        if (extension == ".ppm") {
            CHECK(file_contents(toned.image()) != file_contents(usual.image()));
            continue;
        }
        const auto image = OIIO::ImageInput::open(toned.image());
        REQUIRE(image);
        if (extension != ".png") {
            const std::string told = image->spec().get_string_attribute("ImageDescription");
            CHECK_THAT(told, Catch::EndsWith("raya:exposure=-1.5\nraya:tone=reinhard\nraya:gamma=2.2"));
            continue;
        }
        CHECK(image->spec().get_string_attribute("raya:exposure") == "-1.5");
        CHECK(image->spec().get_string_attribute("raya:tone") == "reinhard");
        CHECK(image->spec().get_string_attribute("raya:gamma") == "2.2");
    }
}

TEST_CASE("a tone that is none, or for a picture of linear colours, is refused", "[cli]") {
    const ScratchFolder outputs;
    const auto refused = [&](const std::string& image, const Words& options, const Words& message) {
        Words words = {"render", scene_file("planes"), "-o", outputs / image};
        words.insert(words.end(), options.begin(), options.end());
        check_refused(outputs, words, 2, message);
    };
    for (const char* image : {"x.exr", "x.pfm"}) {
        refused(image, {"--exposure", "1"}, {"--exposure is for 8-bit pictures", image, "name a .png"});
        refused(image, {"--gamma", "2"}, {"--gamma is for 8-bit pictures"});
        refused(image, {"--tone", "clip"}, {"--tone is for 8-bit pictures"});
    }
    refused("x.ppm", {"--exposure", "65"}, {"--exposure 65: must be -64..64 stops"});
    refused("x.ppm", {"--exposure", "nan"}, {"--exposure nan: must be -64..64 stops"});
    refused("x.ppm", {"--exposure", "bright"}, {"--exposure bright: not a number"});
    for (const char* gamma : {"0", "-1", "0.09", "10.1", "inf"})
        refused("x.ppm", {"--gamma", gamma}, {std::string("--gamma ") + gamma, "must be 0.1..10"});
    refused("x.ppm", {"--tone", "filmic"}, {"--tone filmic: must be clip or reinhard"});
}

}  // namespace
}  // namespace raya
