// Launches and times of commands by label, as a table and as JSON.
#pragma once
#include <string>
#include <vector>

#include "host/base/json.hpp"
#include "host/cl/profile.hpp"
#include "host/report/render_report.hpp"

namespace raya {

/// A line about builds, which are not commands, then a table with a row for each label and kind: launches; total,
/// share, minimum, mean and maximum of the times from start to end; mean times from queueing to submission and from
/// submission to start; bytes.
std::string profile_table(double build_s, const std::vector<ProgramBuild>& builds,
                          const std::vector<LabelSummary>& commands);

/// `waits`: also the mean times before the start, and the bytes moved.
Json commands_json(const std::vector<LabelSummary>& commands, bool waits);
Json builds_json(const std::vector<ProgramBuild>& builds);

}  // namespace raya
