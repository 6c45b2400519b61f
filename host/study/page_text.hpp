// How figures, verdicts and plots of a page are put into words, alike in Markdown and HTML.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "host/report/text_tables.hpp"
#include "host/study/page.hpp"

namespace raya {

/// All digits, and for a reader five: never an exponent where all digits fit, since figures are compared by length.
std::string exact_text(const Cell& cell);
std::string shown_text(const Cell& cell);

/// Empty where the paper has no number, or none to divide by.
std::optional<double> ratio_of(const Comparison& comparison);

const char* verdict_text(ClaimVerdict verdict);

/// Under the name of the paper; without its columns where no row has a figure of it.
TextCells comparison_cells(const StudyPage& page);
TextCells claim_cells(const StudyPage& page);
TextCells table_cells(const StudyTable& table);
/// The points of all series that have a place on the plot's axes or not.
TextCells point_cells(const StudyPlot& plot);

/// What stands above the comparisons.
std::string comparison_title(const StudyPage& page);

/// What is seen on a plot, for those who do not see it: axes, series, ranges.
std::string description_of(const StudyPlot& plot);

/// What is needed to have the page's figures again: command, version, device, settings. (name, value).
std::vector<std::pair<std::string, std::string>> repeat_lines(const StudyPage& page);

/// std::invalid_argument for a table whose rows do not fit its columns or for two tables, or two plots or pictures, of
/// one name.
void check_page(const StudyPage& page);

}  // namespace raya
