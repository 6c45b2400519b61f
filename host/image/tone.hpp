// From linear colours to the 8-bit codes of picture files: exposure, tone curve, transfer curve.
#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "host/image/encoder.hpp"
#include "host/image/srgb.hpp"

namespace raya {

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
