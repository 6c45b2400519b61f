#include "host/image/preview.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <stdexcept>

#include "host/image/tone.hpp"

namespace raya {
namespace {

double shown(float value) { return value > 0 ? std::min(1.0, static_cast<double>(value)) : 0; }

// The first pixel of part `at`, if a row or column of `pixels` pixels is divided into `count` parts of about equal
// size.
std::size_t begin_of(int at, int count, int pixels) {
    return static_cast<std::size_t>(std::int64_t{at} * pixels / count);
}

}  // namespace

int preview_side(int own, int longest, int side) {
    if (longest <= side) return own;
    return std::max(1, static_cast<int>((std::int64_t{own} * side + longest / 2) / longest));
}

Image as_displayed(const Image& image, const Tone& tone) {
    const ToneCodes codes(tone);
    Image shown{image.width, image.height, {}};
    shown.rgb.reserve(image.rgb.size());
    for (std::size_t at = 0; at + 2 < image.rgb.size(); at += 3)
        for (const std::uint8_t code : codes(&image.rgb[at])) shown.rgb.push_back(srgb_light(code));
    return shown;
}

Image preview_of(const Image& image, int side) {
    if (image.width < 1 || image.height < 1 || side < 1) throw std::logic_error("preview_of: no pixels");
    const int longest = std::max(image.width, image.height);
    Image small{preview_side(image.width, longest, side), preview_side(image.height, longest, side), {}};
    const auto width = static_cast<std::size_t>(image.width);
    for (int y = 0; y < small.height; ++y)
        for (int x = 0; x < small.width; ++x) {
            const std::size_t top = begin_of(y, small.height, image.height),
                              end_row = begin_of(y + 1, small.height, image.height),
                              left = begin_of(x, small.width, image.width),
                              end_column = begin_of(x + 1, small.width, image.width);
            double sums[3] = {};
            for (std::size_t row = top; row < end_row; ++row)
                for (std::size_t column = left; column < end_column; ++column)
                    for (std::size_t c = 0; c < 3; ++c) sums[c] += shown(image.rgb[3 * (row * width + column) + c]);
            const auto pixels = static_cast<double>((end_row - top) * (end_column - left));
            for (const double sum : sums) small.rgb.push_back(static_cast<float>(sum / pixels));
        }
    return small;
}

}  // namespace raya
