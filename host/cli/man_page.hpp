// Manual pages, as man reads them.
#pragma once
#include <string>
#include <vector>

#include "host/cli/command_text.hpp"

namespace raya {

/// Section 1's page "raya" of the program, or "raya-render" of one of its commands, with the commands below it: what
/// help says of them, in man's macros. `commands` holds the program's commands, none for the program itself; `program`
/// is name and version.
struct ManPage {
    std::string name{};  // "raya-render"
    std::string text{};
};

/// The pages of the program and of each of its commands.
std::vector<ManPage> man_pages(const CommandText& program, const std::string& name_and_version);

}  // namespace raya
