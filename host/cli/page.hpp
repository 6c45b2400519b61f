// HTML pages of reports: `raya page`, and --page of the commands that write reports.
#pragma once
#include <string>

#include "host/base/json.hpp"

namespace raya {

/// Refuses a page whose name does not end in .html or .htm. UserError with `option`.
void check_page_name(const std::string& option, const std::string& file);

/// The page of a report of render, bench or verify. `name`: the report's file, for messages. UserError for other text;
/// the page lists members that the report is missing.
std::string page_of_report(const std::string& text, const std::string& name);

struct ReportFiles {
    std::string report, page;  // empty: not requested
};

/// Writes a report and its page. page_of_report() makes the same page from the report's file.
void write_report_and_page(const ReportFiles& files, const Json& report);

}  // namespace raya
