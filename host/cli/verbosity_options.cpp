#include "host/cli/verbosity_options.hpp"

#include <CLI/CLI.hpp>
#include <memory>

#include "host/base/say.hpp"
#include "host/cli/options.hpp"
#include "host/error.hpp"
#include "host/ranks/ranks.hpp"

namespace raya {
namespace {

struct Asked {
    int quiet = 0, verbose = 0;
    bool speaks = true;

    void set() const {
        if (quiet > 0 && verbose > 0) throw UserError("--quiet and --verbose: give one of them");
        set_verbosity(speaks || quiet > 0 ? verbose - quiet : 0);
    }
};

void add_to(CLI::App& command, const std::shared_ptr<Asked>& asked) {
    const OptionGroup group(command, kCommonOptions);
    if (command.get_help_ptr() != nullptr) command.get_help_ptr()->group(kCommonOptions);
    command.add_flag_function(
        "-q,--quiet",
        [asked](std::int64_t count) {
            asked->quiet += static_cast<int>(count);
            asked->set();
        },
        "Print no summary and no progress; twice: no warnings either");
    command.add_flag_function(
        "-v,--verbose",
        [asked](std::int64_t count) {
            asked->verbose += static_cast<int>(count);
            asked->set();
        },
        "Say on stderr what the host does, with its seconds; twice: build options and logs of kernels too, and the "
        "device's times by label");
    for (CLI::App* one : command.get_subcommands([](const CLI::App*) { return true; })) add_to(*one, asked);
}

}  // namespace

void add_verbosity_options(CLI::App& program, const Ranks& ranks) {
    const auto asked = std::make_shared<Asked>();
    asked->speaks = ranks.first();
    add_to(program, asked);
}

}  // namespace raya
