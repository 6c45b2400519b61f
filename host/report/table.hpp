// Plain text tables for the terminal.
#pragma once
#include <string>
#include <vector>

namespace raya {

/// Formats rows as lines with columns two spaces apart; the first row is the header. Columns of numbers and "-" are
/// aligned to the right.
std::string text_table(const std::vector<std::vector<std::string>>& rows);

}  // namespace raya
