// pixel_hash(): a known value; the hash depends on the size and on every bit.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <random>
#include <utility>

#include "host/image/image_io.hpp"

namespace raya {
namespace {

Image ramp(int width, int height) {
    Image image{width, height, {}};
    for (int i = 0; i < 3 * width * height; ++i) image.rgb.push_back(static_cast<float>(i) / 8);
    return image;
}

TEST_CASE("pixel_hash: is XXH3 of the little-endian words", "[image]") {
    // The expected text is XXH3_128bits() of the bytes
    //   01 00 00 00  01 00 00 00  00 00 00 3f  00 00 80 3f  00 00 00 c0,
    // printed with its upper 64 bits first.
    CHECK(pixel_hash(Image{1, 1, {0.5f, 1.0f, -2.0f}}) == "ede5021099dc7fb9e634093e89f01db8");
}

TEST_CASE("pixel_hash: depends on width and height", "[image]") {
    const Image wide = ramp(6, 4);
    Image tall = wide;
    std::swap(tall.width, tall.height);
    CHECK(pixel_hash(wide) != pixel_hash(tall));
}

TEST_CASE("pixel_hash: depends on the last bit of every float", "[image]") {
    const std::uint32_t seed = 20260;
    CAPTURE(seed);
    std::mt19937 random(seed);
    const Image image = ramp(160, 120);  // long enough for several blocks of XXH3
    const std::string hash = pixel_hash(image);
    for (int n = 0; n < 40; ++n) {
        const std::size_t at = n == 0 ? image.rgb.size() - 1 : random() % image.rgb.size();
        Image changed = image;
        changed.rgb[at] = std::nextafter(changed.rgb[at], 1e9f);
        CAPTURE(n, at);
        CHECK(pixel_hash(changed) != hash);
    }
}

}  // namespace
}  // namespace raya
