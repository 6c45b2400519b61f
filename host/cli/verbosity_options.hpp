// --quiet and --verbose of all commands.
#pragma once

namespace CLI {
class App;
}

namespace raya {

class Ranks;

/// Adds both to `program` and to all its commands, which exist already, and puts them, --help and --help-all under one
/// heading. Only rank 0 is verbose. Each may be given twice; both together are a UserError.
void add_verbosity_options(CLI::App& program, const Ranks& ranks);

}  // namespace raya
