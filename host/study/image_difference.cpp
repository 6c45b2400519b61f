#include "host/study/image_difference.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace raya {
namespace {

double shown_difference(double a, double b) {
    if (!std::isfinite(a) || !std::isfinite(b)) return std::numeric_limits<double>::infinity();
    return std::abs(std::clamp(a, 0.0, 1.0) - std::clamp(b, 0.0, 1.0));
}

}  // namespace

ImageDifference image_difference(std::span<const Colour> expected, std::span<const float> rgb, double limit) {
    if (expected.empty() || rgb.size() != 3 * expected.size())
        throw std::invalid_argument("image_difference: the images differ in size or have no pixel");
    ImageDifference difference;
    double squares = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
        double off = 0;
        for (int channel = 0; channel < 3; ++channel) {
            const double one = shown_difference(expected[i][channel], rgb[3 * i + static_cast<std::size_t>(channel)]);
            squares += one * one;
            off = std::max(off, one);
        }
        difference.largest = std::max(difference.largest, off);
        difference.over += off > limit ? 1 : 0;
    }
    difference.psnr_db = -10 * std::log10(squares / static_cast<double>(rgb.size()));
    difference.share_over = static_cast<double>(difference.over) / static_cast<double>(expected.size());
    return difference;
}

}  // namespace raya
