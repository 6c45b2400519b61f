// PNG files that raya writes without OpenImageIO, read with OpenImageIO.
#include <catch2/catch.hpp>
#include <random>

#include "host/base/whole_file.hpp"
#include "host/image/image_io.hpp"
#include "tests/base/scratch_folder.hpp"
#include "tests/image/read_image.hpp"

namespace raya {
namespace {

TEST_CASE("plain_png: stores the sRGB codes of all pixels", "[image]") {
    std::mt19937 random(11);
    const ScratchFolder folder;
    for (const auto& [width, height] : {std::pair{1, 1}, {2, 1}, {1, 3}, {37, 21}, {300, 200}}) {
        Image image{width, height, {}};
        for (int i = 0; i < 3 * width * height; ++i)  // ramps and steps, with values outside 0..1
            image.rgb.push_back(static_cast<float>(i % 97) / 80 - 0.1f + (random() % 5 == 0 ? 0.4f : 0.0f));
        write_whole_file(folder / "x.png", plain_png(image));
        const Image read = read_image(folder / "x.png");
        REQUIRE(read.width == width);
        REQUIRE(read.height == height);
        for (std::size_t i = 0; i < image.rgb.size(); ++i)
            if (read.rgb[i] != linear_from_srgb_code(srgb_code(image.rgb[i])))
                FAIL("wrong code of value " << i << " in an image of " << width << " x " << height << " pixels");
    }
}

TEST_CASE("plain_png: an image with missing pixels is an internal error", "[image]") {
    CHECK_THROWS_AS(plain_png({2, 2, {0, 0, 0}}), std::logic_error);
    CHECK_THROWS_AS(plain_png({0, 0, {}}), std::logic_error);
}

}  // namespace
}  // namespace raya
