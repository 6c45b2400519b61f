#include "host/cli/tone_options.hpp"

#include <fmt/core.h>

#include "host/cli/options.hpp"
#include "host/error.hpp"
#include "host/image/image_io.hpp"

namespace raya {
namespace {

constexpr double kMaxStops = 64;                     // factors of 2^-64 to 2^64
constexpr double kMinGamma = 0.1, kMaxGamma = 10.0;  // the range of PNG's gAMA chunk

void refuse_linear_image(const std::string& file, const char* option) {
    throw UserError(
        fmt::format("{} applies to 8-bit images, and {} has linear colours; leave it out, or name a .png, .ppm, .tif "
                    "or .jpg file",
                    option, file));
}

ToneCurve parse_curve(const std::string& text) {
    if (text.empty() || text == "clip") return ToneCurve::kClip;
    if (text == "reinhard") return ToneCurve::kReinhard;
    throw UserError(fmt::format("--tone {}: must be clip or reinhard", text));
}

}  // namespace

void add_tone_options(CLI::App& command, ToneOptions& t) {
    const OptionGroup group(command, kImageGroup);
    add_value(command, "--exposure", t.exposure,
              "8-bit images: multiply colours by 2^EV, -64..64 stops; the report's hash does not change")
        ->type_name("EV")
        ->default_str("0");
    add_value(command, "--gamma", t.gamma,
              "8-bit images: encode colours with the power 1/G, 0.1..10, instead of the sRGB curve")
        ->type_name("G");
    add_value(command, "--tone", t.curve,
              "8-bit images: clip colours to 1, or map luminance L to L/(1+L) (reinhard: Reinhard et al. 2002)")
        ->type_name("clip|reinhard")
        ->default_str("clip");
}

Tone tone_of(const ToneOptions& options, const std::string& file) {
    if (!stores_8bit_codes(file)) {
        if (options.exposure) refuse_linear_image(file, "--exposure");
        if (options.gamma) refuse_linear_image(file, "--gamma");
        if (!options.curve.empty()) refuse_linear_image(file, "--tone");
    }
    const Tone tone{options.exposure.value_or(0), parse_curve(options.curve), options.gamma};
    if (!(tone.exposure >= -kMaxStops && tone.exposure <= kMaxStops))
        throw UserError(fmt::format("--exposure {}: must be -64..64 stops", tone.exposure));
    if (tone.gamma && !(*tone.gamma >= kMinGamma && *tone.gamma <= kMaxGamma))
        throw UserError(fmt::format("--gamma {}: must be 0.1..10", *tone.gamma));
    return tone;
}

}  // namespace raya
