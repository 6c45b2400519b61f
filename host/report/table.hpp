// Plain text tables for the terminal.
#pragma once
#include <string>
#include <vector>

#include "host/cl/profile.hpp"
#include "host/report/render_report.hpp"

namespace raya {

/// Formats rows as lines of text with two spaces between columns. The first row is the header. Columns that contain
/// only numbers and "-" are right-aligned.
std::string text_table(const std::vector<std::vector<std::string>>& rows);

/// Returns a line about builds, which are not device commands, then a table with a row for each label and kind of
/// command. Columns: number of launches; total, percentage of all commands' total, minimum, mean and maximum of the
/// times from start to end; mean times from queueing to submission and from submission to start; megabytes and GB/s.
std::string profile_table(double build_s, const std::vector<ProgramBuild>& builds,
                          const std::vector<LabelSummary>& commands);

}  // namespace raya
