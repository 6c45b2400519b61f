// --quiet and --verbose, which every command has.
#pragma once

namespace CLI {
class App;
}

namespace raya {

class Ranks;

/// Adds them to all commands below `program`, and puts them with --help below one heading. Of several ranks the first
/// alone is verbose. To be called when all commands are there; both may be given twice, and not together: UserError.
void add_verbosity_options(CLI::App& program, const Ranks& ranks);

}  // namespace raya
