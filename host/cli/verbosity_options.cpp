#include "host/cli/verbosity_options.hpp"

#include <CLI/CLI.hpp>
#include <memory>

#include "host/base/log.hpp"
#include "host/cli/options.hpp"
#include "host/error.hpp"
#include "host/ranks/ranks.hpp"

namespace raya {
namespace {

struct VerbosityFlags {
    int quiet = 0, verbose = 0;
    bool is_first_rank = true;

    void apply() const {
        if (quiet > 0 && verbose > 0) throw UserError("--quiet and --verbose: give one of them");
        set_verbosity(is_first_rank || quiet > 0 ? verbose - quiet : 0);
    }
};

void add_to(CLI::App& command, const std::shared_ptr<VerbosityFlags>& flags) {
    const OptionGroup group(command, kGeneralOptions);
    for (const char* name : {"--help", "--help-all"})
        if (CLI::Option* help = command.get_option_no_throw(name); help != nullptr) help->group(kGeneralOptions);
    if (command.get_help_all_ptr() == nullptr) command.set_help_all_flag("--help-all")->group("");  // hidden
    command.add_flag_function(
        "-q,--quiet",
        [flags](std::int64_t count) {
            flags->quiet += static_cast<int>(count);
            flags->apply();
        },
        "Print no summary and no progress; twice: no warnings either");
    command.add_flag_function(
        "-v,--verbose",
        [flags](std::int64_t count) {
            flags->verbose += static_cast<int>(count);
            flags->apply();
        },
        "Log the host's steps and their seconds on stderr; twice: also kernels' build options and logs, and the "
        "device's times by label");
    for (CLI::App* subcommand : command.get_subcommands([](const CLI::App*) { return true; }))
        add_to(*subcommand, flags);
}

}  // namespace

void add_verbosity_options(CLI::App& program, const Ranks& ranks) {
    const auto flags = std::make_shared<VerbosityFlags>();
    flags->is_first_rank = ranks.is_first();
    add_to(program, flags);
}

}  // namespace raya
