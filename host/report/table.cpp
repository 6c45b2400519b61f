#include "host/report/table.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>

namespace raya {
namespace {

bool is_number(const std::string& cell) {
    return cell == "-" || (!cell.empty() && std::isdigit(static_cast<unsigned char>(cell.front())));
}

// Returns true if all cells of the column, except the header, are numbers or "-".
bool is_right_aligned(const std::vector<std::vector<std::string>>& rows, std::size_t column) {
    return std::all_of(rows.begin() + 1, rows.end(),
                       [&](const auto& row) { return column >= row.size() || is_number(row[column]); });
}

}  // namespace

std::string text_table(const std::vector<std::vector<std::string>>& rows) {
    std::vector<std::size_t> widths;
    for (const auto& row : rows) {
        widths.resize(std::max(widths.size(), row.size()));
        for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
    }
    std::string text;
    for (const auto& row : rows) {
        std::string line;
        for (std::size_t i = 0; i < row.size(); ++i) {
            if (i > 0) line += "  ";
            line += is_right_aligned(rows, i) ? fmt::format("{:>{}}", row[i], widths[i])
                                              : fmt::format("{:<{}}", row[i], widths[i]);
        }
        line.erase(line.find_last_not_of(' ') + 1);
        text += line + '\n';
    }
    return text;
}

}  // namespace raya
