#include "host/cli/tone_options.hpp"

#include <fmt/core.h>

#include "host/cli/options.hpp"
#include "host/error.hpp"
#include "host/image/image_io.hpp"

namespace raya {
namespace {

constexpr double kMostStops = 64;                          // either way: 2^64
constexpr double kLeastGamma = 0.1, kLargestGamma = 10.0;  // what PNG's chunk can say

void refuse_linear_picture(const std::string& file, const char* option) {
    throw UserError(
        fmt::format("{} is for 8-bit pictures, and {} holds colours as they are, which a viewer exposes; leave it out, "
                    "or name a .png, .ppm, .tif or .jpg file",
                    option, file));
}

ToneCurve parse_curve(const std::string& text) {
    if (text.empty() || text == "clip") return ToneCurve::kClip;
    if (text == "reinhard") return ToneCurve::kReinhard;
    throw UserError(fmt::format("--tone {}: must be clip or reinhard", text));
}

}  // namespace

void add_tone_options(CLI::App& command, ToneOptions& t) {
    const OptionGroup group(command, kPicture);
    add_value(command, "--exposure", t.exposure,
              "Of 8-bit pictures: stops, -64..64, by which they are brighter: colours times 2^EV; the hash is that of "
              "the colours as they are")
        ->type_name("EV")
        ->default_str("0");
    add_value(command, "--gamma", t.gamma,
              "Of 8-bit pictures: codes are the colours to the power of 1/G, 0.1..10, in place of the sRGB curve")
        ->type_name("G");
    add_value(command, "--tone", t.curve,
              "Of 8-bit pictures: what is brighter than 1 is 1 (clip), or luminance L becomes L/(1+L) (reinhard: "
              "Reinhard et al. 2002)")
        ->type_name("clip|reinhard")
        ->default_str("clip");
}

Tone tone_of(const ToneOptions& options, const std::string& file) {
    if (!holds_codes(file)) {
        if (options.exposure) refuse_linear_picture(file, "--exposure");
        if (options.gamma) refuse_linear_picture(file, "--gamma");
        if (!options.curve.empty()) refuse_linear_picture(file, "--tone");
    }
    const Tone tone{options.exposure.value_or(0), parse_curve(options.curve), options.gamma};
    if (!(tone.exposure >= -kMostStops && tone.exposure <= kMostStops))
        throw UserError(fmt::format("--exposure {}: must be -64..64 stops", tone.exposure));
    if (tone.gamma && !(*tone.gamma >= kLeastGamma && *tone.gamma <= kLargestGamma))
        throw UserError(fmt::format("--gamma {}: must be 0.1..10", *tone.gamma));
    return tone;
}

}  // namespace raya
