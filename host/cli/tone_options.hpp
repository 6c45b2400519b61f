// How colours become the codes of 8-bit pictures, from the command line.
#pragma once
#include <optional>
#include <string>

#include "host/image/tone.hpp"

namespace CLI {
class App;
}

namespace raya {

/// As given on the command line; what is empty has its default.
struct ToneOptions {
    std::optional<double> exposure, gamma;  // stops; exponent
    std::string curve;
};

/// Adds --exposure, --gamma and --tone with their help texts.
void add_tone_options(CLI::App& command, ToneOptions& tone);

/// For the picture `file`. UserError where a value is out of range, or an option is given although the picture holds
/// linear colours.
Tone tone_of(const ToneOptions& options, const std::string& file);

}  // namespace raya
