// Image files: their bytes, and reading back of written images.
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <string>

#include "host/error.hpp"
#include "host/image/image_io.hpp"
#include "tests/base/scratch_folder.hpp"
#include "tests/image/read_image.hpp"

namespace raya {
namespace {
namespace fs = std::filesystem;
using Catch::Matchers::Contains;

std::string contents(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// Returns an image whose values include negative ones, values above 1, -0, infinity and a denormal number.
Image special_image() {
    Image image{5, 3, {}};
    for (int i = 0; i < 45; ++i) image.rgb.push_back(static_cast<float>(i - 5) * 0.37f);
    image.rgb[7] = -0.0f;
    image.rgb[8] = std::numeric_limits<float>::infinity();
    image.rgb[9] = std::numeric_limits<float>::denorm_min();
    return image;
}

TEST_CASE("EXR, PFM: preserve every bit", "[image_io]") {
    const ScratchFolder folder;
    const Image image = special_image();
    for (const char* name : {"a.exr", "a.pfm", "A.EXR"}) {
        CAPTURE(name);
        write_image(folder / name, image);
        const Image read = read_image(folder / name);
        CHECK(read.width == 5);
        CHECK(read.height == 3);
        CHECK(pixel_hash(read) == pixel_hash(image));
    }
}

TEST_CASE("EXR, PFM: preserve grey images; EXR has a float channel Y", "[image_io]") {
    const ScratchFolder folder;
    const GreyImage image{3, 2, {0, 1.5f, 1e9f, 16777217.0f, -4, 0.1f}};
    for (const char* name : {"cost.exr", "cost.pfm"}) {
        CAPTURE(name);
        write_image(folder / name, image);
        const GreyImage read = read_grey_image(folder / name);
        CHECK(read.width == 3);
        CHECK(read.height == 2);
        CHECK(read.values == image.values);
    }
    const auto file = OIIO::ImageInput::open((folder / "cost.exr").string());
    REQUIRE(file);
    CHECK(file->spec().channelnames == std::vector<std::string>{"Y"});
    CHECK(file->spec().format == OIIO::TypeDesc::FLOAT);
}

TEST_CASE("PFM: little-endian floats, bottom row first", "[image_io]") {
    const ScratchFolder folder;
    write_image(folder / "grey.pfm", GreyImage{1, 2, {1.0f, -2.0f}});  // the upper pixel is 1, the lower -2
    CHECK(contents(folder / "grey.pfm") == std::string("Pf\n1 2\n-1.0\n\x00\x00\x00\xc0\x00\x00\x80\x3f", 20));
    write_image(folder / "rgb.pfm", Image{2, 1, {1, 0, 0, 0, 0, 1}});
    CHECK(contents(folder / "rgb.pfm").substr(0, 16) == std::string("PF\n2 1\n-1.0\n\x00\x00\x80\x3f", 16));
    CHECK(contents(folder / "rgb.pfm").size() == 12 + 24);
}

TEST_CASE("PPM: stores the same codes as PNG, top row first", "[image_io]") {
    const ScratchFolder folder;
    write_image(folder / "two.ppm", Image{2, 2, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0.5f, 0.5f, 0.5f}});
    CHECK(contents(folder / "two.ppm") ==
          std::string("P6\n2 2\n255\n\xff\x00\x00\x00\x00\xff\x00\x00\x00\xbc\xbc\xbc", 23));
    for (const char* name : {"a.png", "a.PPM"}) write_image(folder / name, special_image());
    const Image png = read_image(folder / "a.png"), ppm = read_image(folder / "a.PPM");
    CHECK(ppm.width == 5);
    CHECK(ppm.height == 3);
    CHECK(ppm.rgb == png.rgb);
}

TEST_CASE("TIFF: stores the same codes as PNG, with either extension", "[image_io]") {
    const ScratchFolder folder;
    for (const char* name : {"a.png", "a.tif", "a.tiff", "A.TIF"}) write_image(folder / name, special_image());
    for (const char* name : {"a.tif", "a.tiff", "A.TIF"})
        CHECK(read_image(folder / name).rgb == read_image(folder / "a.png").rgb);
}

/// Returns the sampling factors of the three components, from the frame header (SOF0) of a JPEG file.
std::string sampling_factors(const std::string& jpeg) {
    const std::size_t frame = jpeg.find("\xff\xc0");
    REQUIRE(frame != std::string::npos);
    return {jpeg[frame + 11], jpeg[frame + 14], jpeg[frame + 17]};
}

TEST_CASE("JPEG: differs from PNG by at most 4 codes, without chroma subsampling", "[image_io]") {
    const ScratchFolder folder;
    Image image{64, 48, {}};
    for (int y = 0; y < 48; ++y)
        for (int x = 0; x < 64; ++x)
            for (const int code : {4 * x, 5 * y, 2 * (x + y)})
                image.rgb.push_back(linear_from_srgb_code(static_cast<std::uint8_t>(code)));
    for (const char* name : {"a.png", "a.jpg", "a.jpeg"}) write_image(folder / name, image);
    CHECK(contents(folder / "a.jpg") == contents(folder / "a.jpeg"));
    CHECK(sampling_factors(contents(folder / "a.jpg")) == "\x11\x11\x11");
    const Image png = read_image(folder / "a.png"), jpeg = read_image(folder / "a.jpg");
    REQUIRE(jpeg.rgb.size() == png.rgb.size());
    double max_difference = 0;  // in codes
    for (std::size_t i = 0; i < png.rgb.size(); ++i)
        max_difference = std::max(max_difference, std::abs(double(srgb_code(jpeg.rgb[i])) - srgb_code(png.rgb[i])));
    CHECK(max_difference > 0);  // JPEG is lossy
    CHECK(max_difference <= 4);
}

TEST_CASE("8-bit files: store the codes of the exposure", "[image_io]") {
    const ScratchFolder folder;
    constexpr double kExposure = 1;
    const Image image = special_image();
    std::string expected = "P6\n5 3\n255\n";
    for (const std::uint8_t code : srgb_codes(image.rgb, kExposure)) expected += static_cast<char>(code);
    write_image(folder / "a.ppm", image, kExposure);
    CHECK(contents(folder / "a.ppm") == expected);
    for (const char* name : {"a.png", "a.tif"}) {
        CAPTURE(name);
        write_image(folder / name, image, kExposure);
        const auto file = OIIO::ImageInput::open((folder / name).string());
        REQUIRE(file);
        std::string bytes(45, '\0');
        REQUIRE(file->read_image(0, 0, 0, -1, OIIO::TypeDesc::UINT8, bytes.data()));
        CHECK(bytes == expected.substr(expected.size() - 45));
    }
    for (const char* name : {"a.exr", "a.pfm"}) {
        write_image(folder / name, image, kExposure);
        CHECK(pixel_hash(read_image(folder / name)) == pixel_hash(image));
    }
    for (const char* name : {"a.png", "a.ppm", "a.tif", "a.tiff", "a.JPG", "a.jpeg", "-"})
        CHECK(stores_8bit_codes(name));
    for (const char* name : {"a.exr", "a.pfm"}) CHECK_FALSE(stores_8bit_codes(name));
}

TEST_CASE("image files: contain no date, host or software version", "[image_io]") {
    const ScratchFolder folder;
    for (const char* name : {"a.png", "a.exr", "a.pfm", "a.ppm", "a.tif", "a.jpg"}) {
        CAPTURE(name);
        write_image(folder / name, special_image());
        std::string first = contents(folder / name);
        write_image(folder / name, special_image());
        CHECK(contents(folder / name) == first);
        const std::string no_date("capDate\0string\0\1\0\0\0000", 20);  // OpenImageIO 3.1 writes the date "0"
        if (const std::size_t at = first.find(no_date); at != first.npos) first.erase(at, no_date.size());
        for (const char* word : {"capDate", "tIME", "DateTime", "Software", "HostComputer", "OpenImageIO"})
            CHECK_THAT(first, !Contains(word));
    }
}

TEST_CASE("write_image: refuses an unknown extension and names the known extensions", "[image_io]") {
    const ScratchFolder folder;
    const auto message = Contains("use one of .png, .exr, .pfm, .ppm, .tif, .tiff, .jpg, .jpeg");
    for (const char* name : {"a.gif", "a", ".png", "a.png.gz"}) {
        CAPTURE(name);
        CHECK_THROWS_WITH(write_image(folder / name, special_image()), Contains(name) && message);
        CHECK_THROWS_WITH(check_image_name(folder / name, kImageExtensions), Contains(name) && message);
        CHECK_THROWS_AS(check_image_name(folder / name, kImageExtensions), UserError);
    }
    for (const char* name : {"cost.png", "cost.ppm"})
        CHECK_THROWS_WITH(write_image(folder / name, GreyImage{1, 1, {1}}), Contains("use one of .exr, .pfm"));
    CHECK(folder.entries() == 0);
}

TEST_CASE("write_image: refuses a file that it cannot write, and leaves no partial file", "[image_io]") {
    const ScratchFolder folder;
    fs::create_symlink("/dev/full", folder / "full.png");
    check_image_name(folder / "new.png", kImageExtensions);
    CHECK_THROWS_WITH(write_image(folder / "missing/a.exr", special_image()), Contains("does not exist"));
    CHECK_THROWS_WITH(write_image(folder / "full.png", special_image()), Contains("No space left on device"));
    CHECK(folder.entries() == 1);
}

TEST_CASE("write_image: an image with missing pixels is an internal error", "[image_io]") {
    const ScratchFolder folder;
    CHECK_THROWS_AS(write_image(folder / "a.exr", Image{2, 2, std::vector<float>(11)}), std::logic_error);
    CHECK_THROWS_AS(write_image(folder / "a.exr", GreyImage{0, 2, {}}), std::logic_error);
    CHECK(folder.entries() == 0);
}

}  // namespace
}  // namespace raya
