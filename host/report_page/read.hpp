// Members of a saved report, and figures as a page prints them. What is missing is a JsonError, by which the report is
// refused.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/base/json.hpp"
#include "host/report/text_tables.hpp"

namespace raya {

/// A whole number with narrow spaces between its thousands; JsonError for another.
std::string count_of(const Json& number);
std::string grouped(std::uint64_t number);

/// "12.3"
std::string fixed(double value, int digits);

/// "12.3 %"
std::string percent_of(double share, int digits = 1);

std::vector<double> numbers_of(const Json& list);

/// The member as text; empty where there is none, or null.
std::string text_or_nothing(const Json& object, std::string_view key);

/// Of name and text: a list of definitions, of those with text. Names plain, texts HTML.
std::string html_definitions(const std::vector<std::pair<std::string, std::string>>& rows);

/// The same as tiles, of the page's chief figures.
std::string html_tiles(const std::vector<std::pair<std::string, std::string>>& tiles);

/// `title`: plain. Nothing where `html` is.
std::string html_part(const std::string& id, const std::string& title, const std::string& html);

/// The whole page: header, list of its parts, parts, footer. `kicker`, `title`: plain; the rest HTML.
struct PageFrame {
    std::string kicker, title, lead;
    std::string parts;  // of html_part()
    std::string made;
};
std::string framed_page(const PageFrame& frame);

}  // namespace raya
