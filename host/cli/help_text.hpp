// What --help prints, for a terminal of any width.
#pragma once
#include <cstddef>
#include <string>

#include "host/cli/command_text.hpp"

namespace raya {

/// The help of a command that the words `path` lead to, "raya study fig7": usage, summary, examples, commands, options
/// by their groups, what stands below. No line is longer than `width` letters but where a word is.
std::string help_text(const CommandText& command, const std::string& path, std::size_t width);

}  // namespace raya
