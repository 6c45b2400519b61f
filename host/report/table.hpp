// Plain text tables for the terminal.
#pragma once
#include <string>
#include <vector>

namespace raya {

/// The rows under each other, columns two blanks apart; the first row is the header. Columns of numbers,
/// or of "-" in place of one, stand to the right.
std::string text_table(const std::vector<std::vector<std::string>>& rows);

}  // namespace raya
