// What the figures of a formats study say, in sentences made from them alone.
#pragma once
#include <string>
#include <vector>

#include "host/study/formats_study.hpp"

namespace raya {

/// One format over all scenes.
struct FormatOverview {
    NumberFormat format;
    double lowest_psnr_db = 0, highest_psnr_db = 0;
    std::string worst_scene;  // label of the one with the lowest PSNR, of equal ones the first
    double largest = 0;       // error of any channel
    double lowest_share_over = 0, highest_share_over = 0;  // of pixels, 0..1
    double lowest_ratio = 0, highest_ratio = 0;            // measured, to fp32
};

/// One entry for each format, in the study's order; none without scenes.
std::vector<FormatOverview> formats_overview(const FormatsStudy& study);

/// Sentences on the SPA's format beside fp32, on rounding against truncation and on fraction and exponent bits, as far
/// as the study has the formats for them. A difference of infinite PSNRs is left out.
std::vector<std::string> formats_findings(const FormatsStudy& study);

}  // namespace raya
