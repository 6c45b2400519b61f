// Text and tables as HTML. Whatever comes from outside, a scene's path too, passes html_text() or html_prose() once;
// everything called `html` has done so.
#pragma once
#include <string>
#include <vector>

#include "host/report/text_tables.hpp"

namespace raya {

/// Text between tags or in a quoted attribute, with nothing in it that a browser takes for a tag. Bytes that are no
/// UTF-8 stay: a browser shows them as U+FFFD, and they hide no letter after them.
std::string html_text(const std::string& text);

/// A sentence: the same, and `code` in backticks, +- as one sign.
std::string html_prose(const std::string& text);

/// Nothing for no sentences.
std::string html_list(const std::vector<std::string>& sentences);

/// A heading and what stands below it; nothing where nothing does.
std::string html_section(const std::string& title, const std::string& html);

/// All cells through html_prose().
TextCells html_cells(TextCells cells);

struct HtmlTable {
    std::string label;  // plain, for those who do not see it
    TextCells html;     // rows, the first the header
};

/// A table in a box of its own that scrolls where it is wide. Columns of numbers are marked as such, by which they are
/// set and sorted; nothing for no rows.
std::string html_table(const HtmlTable& table);

/// The same, of a long one the first rows alone. `rest`: HTML, where all of them are.
std::string html_cut_table(const HtmlTable& table, const std::string& rest);

/// The same, folded away where it is more than a reader takes in at a glance.
std::string html_folded_table(const HtmlTable& table, const std::string& rest);

struct HtmlPicture {
    std::string title;       // a line
    std::string words;       // what is seen, for those who do not see it
    std::string base64_png;  // the file
};

/// The picture itself within the page, as a figure.
std::string html_picture(const HtmlPicture& picture);

}  // namespace raya
