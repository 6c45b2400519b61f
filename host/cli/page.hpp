// Pages of reports: `raya page`, and --page of the commands that write reports.
#pragma once
#include <string>

namespace raya {

/// Refuses a page whose name does not end in .html or .htm. `option`: as it was given. UserError.
void check_page_name(const std::string& option, const std::string& file);

/// The page of a report of render, bench or verify, which tells what stands in it and nothing else. `name`: of the
/// report's file, for messages. UserError for what is no such report, or lacks what a page needs.
std::string page_of_report(const std::string& report, const std::string& name);

struct ReportFiles {
    std::string report, page;  // empty: not asked for
};

/// Writes both of one run's report, the page as page_of_report() makes it.
void write_report_and_page(const ReportFiles& files, const std::string& report);

}  // namespace raya
