// What the figures of a formats study say, in sentences made from them alone.
#include <cmath>
#include <numeric>

#include "host/study/formats_report.hpp"
#include "host/study/rows.hpp"

namespace raya {
namespace {

const FormatRow* row_of(const SceneRows& scene, const NumberFormat& format) {
    const auto found = std::ranges::find(scene.rows, format, &FormatRow::format);
    return found == scene.rows.end() ? nullptr : &*found;
}

// Adds PSNR of `to` less that of `from`, one entry for each scene that has both.
void add_gains(const FormatsStudy& study, const NumberFormat& from, const NumberFormat& to,
               std::vector<double>& gains) {
    for (const SceneRows& scene : study.scenes) {
        const FormatRow *const before = row_of(scene, from), *const after = row_of(scene, to);
        if (before == nullptr || after == nullptr) continue;
        const double gain = after->difference.psnr_db - before->difference.psnr_db;
        if (std::isfinite(gain)) gains.push_back(gain);
    }
}

// To a tenth, without a negative zero.
double tenth(double value) { return std::round(10 * value) / 10 + 0.0; }

// "+1.2 dB on average (-0.3 to +2.0)"
std::string spread(const std::vector<double>& gains) {
    const double mean = std::accumulate(gains.begin(), gains.end(), 0.0) / static_cast<double>(gains.size());
    return fmt::format("{:+.1f} dB on average ({:+.1f} to {:+.1f})", tenth(mean), tenth(std::ranges::min(gains)),
                       tenth(std::ranges::max(gains)));
}

// Each of these is empty where the study has no such formats.

std::string finding_of_spa(const FormatsStudy& study) {
    const auto all = formats_overview(study);
    const auto spa = std::ranges::find(all, parse_format("spa22"), &FormatOverview::format);
    if (spa == all.end()) return {};
    const FormatOverview& fp32 = all.front();
    const auto text = [](double factor, const Range& range, int digits) {
        return fmt::format("{:.{}f} to {:.{}f}", factor * range.lowest, digits, factor * range.highest, digits);
    };
    return fmt::format(
        "spa22 (e6m15) has a PSNR of {} dB, fp32 one of {} dB; {} % of its pixels are off by more than 1/255, {} % of "
        "fp32's; it takes {} times fp32's kernel time (measured).",
        text(1, spa->psnr_db, 1), text(1, fp32.psnr_db, 1), text(100, spa->share_over, 2),
        text(100, fp32.share_over, 2), text(1, spa->ratio, 2));
}

std::string finding_of_rounding(const FormatsStudy& study) {
    std::vector<double> gains;
    if (study.scenes.empty()) return {};
    for (const FormatRow& row : study.scenes.front().rows) {
        if (!row.format.truncates) continue;
        NumberFormat nearest = row.format;
        nearest.truncates = false;
        add_gains(study, row.format, nearest, gains);
    }
    if (gains.empty()) return {};
    return fmt::format(
        "Rounding to nearest has a higher PSNR than truncation in {} of {} pairs of the same format and scene: {}.",
        std::ranges::count_if(gains, [](double gain) { return gain > 0; }), gains.size(), spread(gains));
}

std::string finding_of_change(const FormatsStudy& study, const char* from, const char* to) {
    std::vector<double> gains;
    add_gains(study, parse_format(from), parse_format(to), gains);
    return gains.empty() ? "" : fmt::format("From {} to {} the PSNR changes by {}.", from, to, spread(gains));
}

// Of one figure in the rows of a format.
template <class Rows, class Figure>
Range range_of(const Rows& rows, Figure figure) {
    const auto all = each(rows, figure);
    return {std::ranges::min(all), std::ranges::max(all)};
}

}  // namespace

std::vector<FormatOverview> formats_overview(const FormatsStudy& study) {
    std::vector<FormatOverview> all;
    const auto psnr = [](const FormatRow& row) { return row.difference.psnr_db; };
    const std::size_t formats = study.scenes.empty() ? 0 : study.scenes.front().rows.size();
    for (std::size_t i = 0; i < formats; ++i) {
        const auto rows = each(study.scenes, [i](const SceneRows& scene) { return scene.rows[i]; });
        const auto largest = each(rows, [](const FormatRow& row) { return row.difference.largest; });
        all.push_back({rows[0].format, range_of(rows, psnr),
                       least(study.scenes, [&](const SceneRows& scene) { return psnr(scene.rows[i]); }).label,
                       std::ranges::max(largest),
                       range_of(rows, [](const FormatRow& row) { return row.difference.share_over; }),
                       range_of(rows, &FormatRow::ratio_to_fp32)});
    }
    return all;
}

std::vector<std::string> formats_findings(const FormatsStudy& study) {
    const std::vector<std::string> all = {
        finding_of_spa(study), finding_of_rounding(study), finding_of_change(study, "e6m13", "e6m15"),
        finding_of_change(study, "e8m15", "e8m21"), finding_of_change(study, "e6m15", "e8m15")};
    return where(all, [](const std::string& sentence) { return !sentence.empty(); });
}

}  // namespace raya
