// From linear colours to the 8-bit codes of picture files: exposure, tone curve, transfer curve (sRGB, IEC 61966-2-1,
// or another).
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "host/image/encoder.hpp"

namespace raya {

/// borders[k] = the linear value half way, on the curve, between the codes k and k + 1.
using CodeBorders = std::array<double, 255>;

/// `linear_from`: the curve's inverse, from 0..1 to linear light.
template <class Curve>
CodeBorders code_borders(Curve&& linear_from) {
    CodeBorders borders;
    for (std::size_t k = 0; k < borders.size(); ++k) borders[k] = linear_from((static_cast<double>(k) + 0.5) / 255);
    return borders;
}

const CodeBorders& srgb_borders();

/// The code 0..255 nearest to 255 curve(linear); below 0 and NaN give 0, above 1 gives 255.
std::uint8_t code_between(const CodeBorders& borders, double linear);

/// That code on the sRGB curve. Has the same answer on every machine: the value is compared with the 255 borders
/// between codes, which no float comes near (the nearest is more than 10^-11 of itself away, the C library's pow is
/// right to about 10^-16).
std::uint8_t srgb_code(float linear);

/// The linear value that a code stands for.
float srgb_light(std::uint8_t code);

enum class ToneCurve {
    kClip,      // what is brighter than 1 is 1
    kReinhard,  // luminance L becomes L / (1 + L), and all three components change alike, so that hues stay
};

/// How a picture's colours become codes: times 2^exposure, then the tone curve, then the transfer curve.
struct Tone {
    double exposure = 0;  // stops
    ToneCurve curve = ToneCurve::kClip;
    std::optional<double> gamma{};  // codes are v^(1/gamma); empty: the sRGB curve
    bool operator==(const Tone&) const = default;
};

/// "clip", "reinhard".
const char* tone_curve_name(ToneCurve curve);

/// What a picture's file says of it, where it is another one than usual.
ImageAttributes tone_attributes(const Tone& tone);

/// The codes of pixels, the same on every machine but for what pow() may round otherwise at a code's border.
///
/// kReinhard is E. Reinhard, M. Stark, P. Shirley, J. Ferwerda, "Photographic Tone Reproduction for Digital Images",
/// SIGGRAPH 2002, equation 3, with the exposure in place of their key over the log-average luminance, so that pictures
/// of a series are alike. L is the luminance of sRGB's primaries (ITU-R BT.709). NaN is black, infinity the largest
/// float.
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
