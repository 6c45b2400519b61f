// Pages of reports: `raya page`, and --page of the commands that write reports.
#pragma once
#include <string>

#include "host/base/json.hpp"

namespace raya {

/// Refuses a page whose name does not end in .html or .htm. `option`: as it was given. UserError.
void check_page_name(const std::string& option, const std::string& file);

/// The page of a saved report of render, bench or verify. `name`: of its file, for messages. UserError for anything
/// else; what such a report lacks, the page itself names.
std::string page_of_report(const std::string& text, const std::string& name);

struct ReportFiles {
    std::string report, page;  // empty: not asked for
};

/// Writes both of one run's report; page_of_report() makes the same page of the file.
void write_report_and_page(const ReportFiles& files, const Json& report);

}  // namespace raya
