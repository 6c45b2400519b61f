// HTML pages of reports: `raya page`, and --page of the commands that write reports.
#pragma once
#include <string>

#include "host/base/json.hpp"

namespace raya {

/// Throws UserError, which names `option`, unless `file` ends in .html or .htm, is stdout ("-"), or is in /dev/.
void check_page_name(const std::string& option, const std::string& file);

/// Returns the HTML page of a report of render, bench, verify or gpu_day. `text`: the report; `name`: its file, for
/// messages. Throws UserError unless `text` is such a report. The page lists members that are missing in the report.
std::string page_of_report(const std::string& text, const std::string& name);

struct ReportFiles {
    std::string report, page;  // file names; empty: not requested
};

/// Writes the requested files. `raya page` makes the same page from the report's file.
void write_report_and_page(const ReportFiles& files, const Json& report);

/// Returns the JSON Schema of the data in the page of `raya explore`.
Json explore_schema();

}  // namespace raya
