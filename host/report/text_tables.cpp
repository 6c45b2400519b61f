#include "host/report/text_tables.hpp"

#include <fmt/core.h>

#include <cmath>

#include "host/base/json.hpp"

namespace raya {
namespace {

std::string markdown_cell(std::string text) {
    for (char& c : text)
        if (c == '\n' || c == '\r') c = ' ';
    return replaced(std::move(text), "|", "\\|");
}

}  // namespace

std::string replaced(std::string text, const std::string& what, const std::string& by) {
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size()))
        text.replace(at, what.size(), by);
    return text;
}

std::string csv_field(const std::string& text) {
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    return '"' + replaced(text, "\"", "\"\"") + '"';
}

Json json_number(double value) {
    if (std::isfinite(value)) return value;
    return fmt::format("{}", value);
}

std::string markdown_table(const TextCells& rows) {
    std::string text;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        text += '|';
        for (const std::string& cell : rows[i]) text += ' ' + markdown_cell(cell) + " |";
        text += '\n';
        if (i > 0) continue;
        text += '|';
        for (std::size_t column = 0; column < rows[i].size(); ++column) text += "---|";
        text += '\n';
    }
    return text;
}

}  // namespace raya
