// A study page as files: for spreadsheets, for programs and for people. All say the same.
#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "host/study/page.hpp"
#include "host/study/plotter.hpp"

namespace raya {

/// One line for each row under the columns' names; numbers with all their digits, fields quoted as RFC 4180 says.
std::string table_csv(const StudyTable& table);

/// JSON has no infinity: the string "inf" stands for it.
Json cell_json(const Cell& cell);

/// Everything on the page, the points of its plots too.
Json page_json(const StudyPage& page);

/// Question, method, the paper's figures beside ours, findings, tables, plots, how to repeat it. Numbers have five
/// digits, as a reader wants them; the other files have all.
std::string page_markdown(const StudyPage& page, const PlotOutcome& plots);

/// Writes NAME.md, NAME.json and TABLE.csv for each table and PICTURE.png for each picture and draws the plots into
/// `folder`, which must be there. Returns what became of the plots. Throws UserError for a file that cannot be written;
/// std::invalid_argument for a table whose rows do not fit its columns or for two tables, or two plots or pictures, of
/// one name, and then writes nothing.
PlotOutcome write_page(const std::filesystem::path& folder, const StudyPage& page);

/// The story in order: what the verdicts come to; then title, question, the paper's figures beside ours and the first
/// finding of each page, with links to the pages, which lie in the same folder.
std::string index_markdown(std::span<const StudyPage> pages);

/// Writes index_markdown() to index.md in `folder`. Throws UserError where it cannot be written.
void write_index(const std::filesystem::path& folder, std::span<const StudyPage> pages);

}  // namespace raya
