#include "host/image/preview.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <stdexcept>

#include "host/image/tone.hpp"

namespace raya {
namespace {

double clamped_light(float value) { return value > 0 ? std::min(1.0, static_cast<double>(value)) : 0; }

// Returns the first pixel of part number `part`, if a row or column of `pixels` pixels is divided into `parts` parts of
// about equal size.
std::size_t first_pixel(int part, int parts, int pixels) {
    return static_cast<std::size_t>(std::int64_t{part} * pixels / parts);
}

}  // namespace

int preview_side(int image_side, int longer_side, int max_side) {
    if (longer_side <= max_side) return image_side;
    return std::max(1, static_cast<int>((std::int64_t{image_side} * max_side + longer_side / 2) / longer_side));
}

Image as_displayed(const Image& image, const Tone& tone) {
    const ToneCodes codes(tone);
    Image displayed{image.width, image.height, {}};
    displayed.rgb.reserve(image.rgb.size());
    for (std::size_t at = 0; at + 2 < image.rgb.size(); at += 3)
        for (const std::uint8_t code : codes(&image.rgb[at])) displayed.rgb.push_back(srgb_light(code));
    return displayed;
}

Image preview_of(const Image& image, int max_side) {
    if (image.width < 1 || image.height < 1 || max_side < 1) throw std::logic_error("preview_of: no pixels");
    const int longer_side = std::max(image.width, image.height);
    Image preview{
        preview_side(image.width, longer_side, max_side), preview_side(image.height, longer_side, max_side), {}};
    const auto width = static_cast<std::size_t>(image.width);
    for (int y = 0; y < preview.height; ++y)
        for (int x = 0; x < preview.width; ++x) {
            const std::size_t top = first_pixel(y, preview.height, image.height),
                              end_row = first_pixel(y + 1, preview.height, image.height),
                              left = first_pixel(x, preview.width, image.width),
                              end_column = first_pixel(x + 1, preview.width, image.width);
            double sums[3] = {};
            for (std::size_t row = top; row < end_row; ++row)
                for (std::size_t column = left; column < end_column; ++column)
                    for (std::size_t c = 0; c < 3; ++c)
                        sums[c] += clamped_light(image.rgb[3 * (row * width + column) + c]);
            const auto pixels = static_cast<double>((end_row - top) * (end_column - left));
            for (const double sum : sums) preview.rgb.push_back(static_cast<float>(sum / pixels));
        }
    return preview;
}

}  // namespace raya
