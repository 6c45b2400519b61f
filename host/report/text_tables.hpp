// The pieces that CSV, JSON and Markdown are made of.
#pragma once
#include <string>
#include <vector>

#include "host/base/json.hpp"

namespace raya {

/// Rows of cells, the first the header; empty where there is nothing to show.
using TextCells = std::vector<std::vector<std::string>>;

/// `text` with every `what` in it replaced by `by`.
std::string replaced(std::string text, const std::string& what, const std::string& by);

/// A field of CSV: in quotes where it holds commas, quotes or line ends (RFC 4180).
std::string csv_field(const std::string& text);

/// The number, or "inf", "-inf" or "nan", as JSON knows finite numbers only.
Json json_number(double value);

/// The first row is the header. Bars in cells are escaped and line ends become spaces, so that the table stays whole.
std::string markdown_table(const TextCells& rows);

}  // namespace raya
