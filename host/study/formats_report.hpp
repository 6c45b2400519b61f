// A formats study as text: for spreadsheets, for programs and for people. All three say the same.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "host/study/formats_study.hpp"

namespace raya {

/// One line for each scene and format, under a header; numbers with all their digits, `inf` and `-inf` where there is
/// none. Fields with commas, quotes or line ends are quoted (RFC 4180).
std::string formats_csv(const FormatsStudy& study);

/// Everything in the study. JSON has no infinity: the strings "inf" and "-inf" stand for it.
nlohmann::ordered_json formats_json(const FormatsStudy& study);

/// A page: how it was done, all scenes in one table, what is seen, a table for each scene.
std::string formats_markdown(const FormatsStudy& study);

/// One row for each format over all scenes, under a header: cells of a table.
std::vector<std::vector<std::string>> formats_overview_cells(const FormatsStudy& study);

}  // namespace raya
