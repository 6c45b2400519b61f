// Plain text tables for the terminal.
#pragma once
#include <string>
#include <vector>

namespace raya {

/// Formats rows as lines of text with two spaces between columns. The first row is the header. Columns that contain
/// only numbers and "-" are right-aligned.
std::string text_table(const std::vector<std::vector<std::string>>& rows);

}  // namespace raya
