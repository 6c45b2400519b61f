// Options of the tone mapping of 8-bit images.
#pragma once
#include <optional>
#include <string>

#include "host/image/tone.hpp"

namespace CLI {
class App;
}

namespace raya {

/// The options as given on the command line. An empty value means the default.
struct ToneOptions {
    std::optional<double> exposure;  // stops: colours are multiplied by 2^exposure
    std::optional<double> gamma;     // colours are raised to the power 1/gamma
    std::string curve;
};

/// Adds --exposure, --gamma and --tone.
void add_tone_options(CLI::App& command, ToneOptions& tone);

/// Returns the tone mapping for the image `file`. Throws UserError for a value out of range, and if an
/// option is given for a linear format.
Tone tone_of(const ToneOptions& options, const std::string& file);

}  // namespace raya
