// Conversion of linear colours to 8-bit codes of image files: exposure, tone curve, and transfer curve (sRGB, IEC
// 61966-2-1, or a power).
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "host/image/encoder.hpp"

namespace raya {

/// borders[k]: the linear value halfway, on the transfer curve, between the codes k and k + 1.
using CodeBorders = std::array<double, 255>;

/// `linear_from`: the inverse of the transfer curve, from 0..1 to linear light.
template <class Curve>
CodeBorders code_borders(Curve&& linear_from) {
    CodeBorders borders;
    for (std::size_t k = 0; k < borders.size(); ++k) borders[k] = linear_from((static_cast<double>(k) + 0.5) / 255);
    return borders;
}

const CodeBorders& srgb_borders();

/// The code 0..255 nearest to 255 curve(linear); 0 for negative values and NaN, 255 above 1.
std::uint8_t code_between(const CodeBorders& borders, double linear);

/// The code on the sRGB curve. The same on every machine: the value is compared with the 255 borders between codes, and
/// no float is close to one (the relative distance is more than 10^-11; the C library's pow() has an error of about
/// 10^-16).
std::uint8_t srgb_code(float linear);

/// The linear value of a code.
float srgb_light(std::uint8_t code);

enum class ToneCurve {
    kClip,      // clamps to 1
    kReinhard,  // luminance L becomes L / (1 + L); all three components are scaled by 1 / (1 + L), which keeps hues
};

/// The conversion of colours to codes: times 2^exposure, then the tone curve, then the transfer curve.
struct Tone {
    double exposure = 0;  // stops
    ToneCurve curve = ToneCurve::kClip;
    std::optional<double> gamma{};  // codes are v^(1/gamma); empty: the sRGB curve
    bool operator==(const Tone&) const = default;
};

/// "clip", "reinhard".
const char* tone_curve_name(ToneCurve curve);

/// The attributes of an image file for a tone: its members that differ from the defaults.
ImageAttributes tone_attributes(const Tone& tone);

/// Converts pixels to codes. The same on every machine, except for different rounding of pow() at the border of a code.
///
/// kReinhard: equation 3 of E. Reinhard, M. Stark, P. Shirley, J. Ferwerda, "Photographic Tone Reproduction for Digital
/// Images", SIGGRAPH 2002, with the exposure instead of their key over the log-average luminance, so that the images of
/// a series are comparable. L is the luminance of sRGB's primaries (ITU-R BT.709). NaN becomes black, infinity the
/// largest float.
class ToneCodes {
  public:
    explicit ToneCodes(const Tone& tone);

    /// `rgb`: 3 linear values.
    std::array<std::uint8_t, 3> operator()(const float* rgb) const;

  private:
    ToneCurve curve_;
    double factor_;
    CodeBorders borders_;
};

}  // namespace raya
