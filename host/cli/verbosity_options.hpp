// The options --quiet and --verbose of all commands.
#pragma once

namespace CLI {
class App;
}

namespace raya {

class Ranks;

/// Adds both options to `program` and to all its commands, and lists them with --help and --help-all under one heading.
/// Call add_verbosity_options() after all commands are added. Only rank 0 is verbose. Each option may be given twice;
/// giving both options is a UserError.
void add_verbosity_options(CLI::App& program, const Ranks& ranks);

}  // namespace raya
