#include "host/cli/tuned_option.hpp"

#include "host/cli/options.hpp"
#include "host/tune/store.hpp"

namespace raya {

void add_tuned_option(CLI::App& command, bool& no_tuned) {
    const OptionGroup group(command, kKernels);
    command.add_flag("--no-tuned", no_tuned,
                     "Take the defaults, not what raya tune has kept for this device and driver; the environment "
                     "variable RAYA_TUNED=off does the same. The image is the same in any case");
}

TunedUse use_tuned(bool no_tuned, Warnings* warnings) {
    const auto warn = [warnings](const std::string& text) {
        Warnings nobodys;
        (warnings ? *warnings : nobodys).add(text);
    };
    return TunedUse(no_tuned ? TunedSource{} : kept_choices(warn));
}

}  // namespace raya
