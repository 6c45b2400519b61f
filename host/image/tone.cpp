#include "host/image/tone.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace raya {
namespace {

double linear_from_srgb(double encoded) {
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

CodeBorders borders_of(const Tone& tone) {
    if (!tone.gamma) return srgb_borders();
    return code_borders([&](double encoded) { return std::pow(encoded, *tone.gamma); });
}

double luminance(const std::array<double, 3>& v) { return 0.2126 * v[0] + 0.7152 * v[1] + 0.0722 * v[2]; }

}  // namespace

const CodeBorders& srgb_borders() {
    static const CodeBorders borders = code_borders(linear_from_srgb);
    return borders;
}

std::uint8_t nearest_code(const CodeBorders& borders, double linear) {
    const auto border = std::lower_bound(borders.begin(), borders.end(), linear);
    return static_cast<std::uint8_t>(border - borders.begin());
}

float srgb_light(std::uint8_t code) { return static_cast<float>(linear_from_srgb(code / 255.0)); }

std::uint8_t srgb_code(float linear) { return nearest_code(srgb_borders(), static_cast<double>(linear)); }

const char* tone_curve_name(ToneCurve curve) { return curve == ToneCurve::kReinhard ? "reinhard" : "clip"; }

ImageAttributes tone_attributes(const Tone& tone) {
    ImageAttributes attributes;
    if (tone.exposure != 0) attributes.emplace_back("exposure", fmt::format("{}", tone.exposure));
    if (tone.curve != ToneCurve::kClip) attributes.emplace_back("tone", tone_curve_name(tone.curve));
    if (tone.gamma) attributes.emplace_back("gamma", fmt::format("{}", *tone.gamma));
    return attributes;
}

ToneCodes::ToneCodes(const Tone& tone)
    : curve_(tone.curve), factor_(std::exp2(tone.exposure)), borders_(borders_of(tone)) {
    for (std::size_t k = 0; k < codes_.size(); ++k) codes_[k] = nearest_code(borders_, static_cast<double>(k) / kCells);
}

std::array<std::uint8_t, 3> ToneCodes::operator()(const float* rgb) const {
    constexpr double kMaxFloat = std::numeric_limits<float>::max();
    std::array<double, 3> linear{};
    for (std::size_t i = 0; i < 3; ++i)
        linear[i] = std::isnan(rgb[i]) ? 0 : factor_ * std::clamp<double>(rgb[i], -kMaxFloat, kMaxFloat);
    const double pixel_luminance = luminance(linear);
    const double scale = curve_ == ToneCurve::kReinhard && pixel_luminance > 0 ? 1 / (1 + pixel_luminance) : 1;
    std::array<std::uint8_t, 3> codes{};
    for (std::size_t i = 0; i < 3; ++i) {
        const double value = linear[i] * scale;
        std::size_t code = codes_[static_cast<std::size_t>(std::clamp(value, 0.0, 1.0) * kCells)];
        while (code < borders_.size() && borders_[code] < value) ++code;
        codes[i] = static_cast<std::uint8_t>(code);
    }
    return codes;
}

}  // namespace raya
