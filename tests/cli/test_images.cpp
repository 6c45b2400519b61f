// The files that a render writes: what they say about themselves, and that the same render writes the same bytes.
#include <OpenImageIO/imageio.h>
#include <unistd.h>

#include <algorithm>
#include <array>

#include "tests/cli/render_files.hpp"

namespace raya {
namespace {

TEST_CASE("the same render writes the same bytes", "[cli]") {
    const std::string extension = GENERATE(".png", ".exr", ".pfm");
    const std::string cost_extension = extension == ".png" ? ".exr" : extension;
    CAPTURE(extension, cost_extension);
    const RenderFiles first("centre", {}, extension, cost_extension), second("centre", {}, extension, cost_extension);
    CHECK(file_contents(first.image()) == file_contents(second.image()));
    CHECK(file_contents(first.cost()) == file_contents(second.cost()));
    CHECK(first.report()["image"]["hash"] == second.report()["image"]["hash"]);
}

TEST_CASE("PNG and EXR say how they were made", "[cli]") {
    const std::string extension = GENERATE(".png", ".exr");
    const RenderFiles files("centre", {"--offset", "3"}, extension, ".exr");
    const double u = files.report()["load"]["imbalance"];
    for (const std::string& path : {files.image(), files.cost()}) {
        CAPTURE(path);
        const auto image = OIIO::ImageInput::open(path);
        REQUIRE(image);
        const auto text = [&](const char* key) { return std::string(image->spec().get_string_attribute(key)); };
        CHECK(text("raya:scene") == "centre.nff");
        CHECK(text("raya:machine") == "spa");
        CHECK(text("raya:mapping") == "cyclic");
        CHECK(text("raya:offset") == "3");
        CHECK(text("raya:format") == "e6m15");
        CHECK(std::stod(text("raya:u")) == Approx(u).margin(0.5e-6));  // six digits after the point
    }
}

TEST_CASE("no file says when or where it was made", "[cli]") {
    const std::string extension = GENERATE(".png", ".exr", ".pfm");
    CAPTURE(extension);
    std::array<char, 256> host{};
    REQUIRE(::gethostname(host.data(), host.size() - 1) == 0);
    const RenderFiles files("centre", {}, extension, extension == ".png" ? ".exr" : extension);
    for (const std::string& path : {files.image(), files.cost()}) {
        const std::string bytes = file_contents(path);
        for (const std::string word : {"DateTime", "capDate", "tIME", "HostComputer", "Software", "owner"})
            CHECK_FALSE(contains(bytes, word));
        const std::string name = host.data();
        if (name.size() >= 6) CHECK_FALSE(contains(bytes, name));  // a shorter one could stand among the pixels
    }
}

TEST_CASE("a render replaces old files", "[cli]") {
    const ScratchFolder folder;
    const std::string image = folder / "x.pfm";
    for (const std::string size : {"9x7", "4x3"}) {
        const Outcome run =
            run_raya({"render", scene_file("planes"), "-o", image, "--size", size, "--pes", "2", "--lanes", "4"});
        INFO(run.told());
        REQUIRE(run.code == 0);
    }
    CHECK(file_contents(image).size() == std::string("PF\n4 3\n-1.0\n").size() + 4 * 3 * 3 * sizeof(float));
    CHECK(folder.entries() == 1);
}

}  // namespace
}  // namespace raya
