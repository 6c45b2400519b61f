// A formats study as text: for spreadsheets, for programs and for people. All three say the same.
#pragma once
#include <string>
#include <vector>

#include "host/base/json.hpp"
#include "host/study/formats_study.hpp"

namespace raya {

struct FigureRange {
    double lowest = 0, highest = 0;
};

/// One format over all scenes.
struct FormatOverview {
    NumberFormat format;
    FigureRange psnr_db;
    std::string worst_scene;  // label of the one with the lowest PSNR, of equal ones the first
    double largest = 0;       // error of any channel
    FigureRange share_over;   // of pixels, 0..1
    FigureRange ratio;        // measured, to fp32
};

/// One entry for each format, in the study's order; none without scenes.
std::vector<FormatOverview> formats_overview(const FormatsStudy& study);

/// Sentences on the SPA's format beside fp32, on rounding against truncation and on fraction and exponent bits, as far
/// as the study has the formats for them. A difference of infinite PSNRs is left out.
std::vector<std::string> formats_findings(const FormatsStudy& study);

/// One line for each scene and format, under a header; numbers with all their digits, `inf` and `-inf` where there is
/// none. Fields with commas, quotes or line ends are quoted (RFC 4180).
std::string formats_csv(const FormatsStudy& study);

/// Everything in the study. JSON has no infinity: the strings "inf" and "-inf" stand for it.
Json formats_json(const FormatsStudy& study);

/// A page: how it was done, all scenes in one table, what is seen, a table for each scene.
std::string formats_markdown(const FormatsStudy& study);

/// One row for each format over all scenes, under a header: cells of a table.
std::vector<std::vector<std::string>> formats_overview_cells(const FormatsStudy& study);

}  // namespace raya
