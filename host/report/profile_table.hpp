// Launches and times of every labelled command, as a table and as JSON.
#pragma once
#include <string>
#include <vector>

#include "host/base/json.hpp"
#include "host/cl/profile.hpp"
#include "host/report/render_report.hpp"

namespace raya {

/// A line about the builds, which are none of the commands, then one line for each label and kind: launches, total,
/// share of all commands, least, mean and most, all from a command's start to its end; then, kept apart, how long one
/// waited on average until it was submitted to the device, and from there until it started.
std::string profile_table(double build_s, const std::vector<ProgramBuild>& builds,
                          const std::vector<LabelSummary>& commands);

/// `waits`: with those two times and the bytes moved.
Json commands_json(const std::vector<LabelSummary>& commands, bool waits);
Json builds_json(const std::vector<ProgramBuild>& builds);

}  // namespace raya
