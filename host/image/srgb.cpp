#include "host/image/srgb.hpp"

#include <algorithm>
#include <cmath>

namespace raya {
namespace {

double linear_from_srgb(double encoded) {
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

}  // namespace

const CodeBorders& srgb_borders() {
    static const CodeBorders borders = code_borders(linear_from_srgb);
    return borders;
}

std::uint8_t code_between(const CodeBorders& borders, double linear) {
    const auto border = std::lower_bound(borders.begin(), borders.end(), linear);
    return static_cast<std::uint8_t>(border - borders.begin());
}

float srgb_light(std::uint8_t code) { return static_cast<float>(linear_from_srgb(code / 255.0)); }

std::uint8_t srgb_code(float linear) { return code_between(srgb_borders(), static_cast<double>(linear)); }

}  // namespace raya
