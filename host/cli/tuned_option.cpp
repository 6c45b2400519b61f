#include "host/cli/tuned_option.hpp"

#include "host/cli/options.hpp"
#include "host/tune/store.hpp"

namespace raya {

void add_tuned_option(CLI::App& command, bool& no_tuned) {
    const OptionGroup group(command, kKernels);
    command.add_flag("--no-tuned", no_tuned,
                     "Use the defaults, not the values that raya tune stored for this device and driver, like the "
                     "environment variable RAYA_TUNED=off; the image does not change");
}

ScopedTunedSource use_tuned(bool no_tuned, Warnings* warnings) {
    const auto warn = [warnings](const std::string& text) {
        Warnings local_warnings;
        (warnings ? *warnings : local_warnings).add(text);
    };
    return ScopedTunedSource(no_tuned ? TunedSource{} : stored_choices(warn));
}

}  // namespace raya
