#include "host/image/srgb.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace raya {
namespace {

double linear_from_srgb(double encoded) {
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

/// borders[k] = the linear value half way, on the curve, between the codes k and k + 1.
std::array<double, 255> borders_between_codes() {
    std::array<double, 255> borders;
    for (std::size_t k = 0; k < borders.size(); ++k)
        borders[k] = linear_from_srgb((static_cast<double>(k) + 0.5) / 255);
    return borders;
}

}  // namespace

std::uint8_t srgb_code(float linear) {
    static const std::array<double, 255> borders = borders_between_codes();
    const auto border = std::lower_bound(borders.begin(), borders.end(), static_cast<double>(linear));
    return static_cast<std::uint8_t>(border - borders.begin());
}

}  // namespace raya
