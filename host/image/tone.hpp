// Conversion of linear colours to 8-bit codes of image files: exposure, tone curve, and transfer curve (sRGB, IEC
// 61966-2-1, or a power).
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "host/image/encoder.hpp"

namespace raya {

/// borders[k]: the linear value at which the nearest code changes from k to k + 1. Its encoded value is
/// (k + 1/2) / 255.
using CodeBorders = std::array<double, 255>;

/// Returns the borders of a transfer curve. `linear_from`: the inverse of the curve, from encoded values 0..1 to linear
/// light.
template <class Curve>
CodeBorders code_borders(Curve&& linear_from) {
    CodeBorders borders;
    for (std::size_t k = 0; k < borders.size(); ++k) borders[k] = linear_from((static_cast<double>(k) + 0.5) / 255);
    return borders;
}

const CodeBorders& srgb_borders();

/// Returns the code 0..255 that is nearest to 255 curve(linear), for the curve of `borders`; 0 for negative values and
/// NaN, 255 above 1.
std::uint8_t nearest_code(const CodeBorders& borders, double linear);

/// Returns the nearest code on the sRGB curve. The code follows from comparisons with the 255 borders, which are
/// computed with the C library's pow(). The code is the same on every machine, because the relative error of pow() is
/// only about 10^-16, and the relative distance of every float from every border is more than 10^-11.
std::uint8_t srgb_code(float linear);

/// Returns the linear value of a code on the sRGB curve.
float srgb_light(std::uint8_t code);

enum class ToneCurve {
    kClip,      // clamps to 1
    kReinhard,  // scales all three components by 1 / (1 + L), L: luminance; keeps hues
};

/// The conversion of linear colours to codes: multiplication by 2^exposure, then the tone curve, then the transfer
/// curve.
struct Tone {
    double exposure = 0;  // stops
    ToneCurve curve = ToneCurve::kClip;
    std::optional<double> gamma{};  // the transfer curve is v^(1/gamma); empty: the sRGB curve
    bool operator==(const Tone&) const = default;
};

/// Returns the name of a curve in options and metadata: "clip" or "reinhard".
const char* tone_curve_name(ToneCurve curve);

/// Returns the members of `tone` that differ from the defaults, as attributes of an image file.
ImageAttributes tone_attributes(const Tone& tone);

/// Converts pixels to codes. The result is the same on every machine, except for values at the border of two codes,
/// which depend on the rounding of pow().
///
/// kReinhard: equation 3 of E. Reinhard, M. Stark, P. Shirley, J. Ferwerda, "Photographic Tone Reproduction for Digital
/// Images", SIGGRAPH 2002. The factor 2^exposure replaces the paper's key value divided by the log-average luminance,
/// so that the images of a series are comparable. L is the luminance for sRGB's primaries (ITU-R BT.709). Before the
/// conversion, a NaN component becomes 0 and an infinite one the largest float.
class ToneCodes {
  public:
    explicit ToneCodes(const Tone& tone);

    /// Returns the codes of one pixel. `rgb`: 3 linear values, red, green and blue.
    std::array<std::uint8_t, 3> operator()(const float* rgb) const;

  private:
    ToneCurve curve_;
    double factor_;
    CodeBorders borders_;
    static constexpr int kCells = 4096;
    std::array<std::uint8_t, kCells + 1> codes_;  // [k]: the code of k / kCells; a search from there takes few steps
};

}  // namespace raya
