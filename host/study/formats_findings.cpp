#include "host/study/formats_findings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace raya {
namespace {

const FormatRow* row_of(const SceneRows& scene, const NumberFormat& format) {
    const auto found =
        std::find_if(scene.rows.begin(), scene.rows.end(), [&](const FormatRow& row) { return row.format == format; });
    return found == scene.rows.end() ? nullptr : &*found;
}

// Adds PSNR of `to` less that of `from`, one entry for each scene that has both.
void add_gains(const FormatsStudy& study, const NumberFormat& from, const NumberFormat& to,
               std::vector<double>& gains) {
    for (const SceneRows& scene : study.scenes) {
        const FormatRow* const before = row_of(scene, from);
        const FormatRow* const after = row_of(scene, to);
        if (before == nullptr || after == nullptr) continue;
        const double gain = after->difference.psnr_db - before->difference.psnr_db;
        if (std::isfinite(gain)) gains.push_back(gain);
    }
}

// To a tenth, without a negative zero.
double tenth(double value) { return std::round(10 * value) / 10 + 0.0; }

// "+1.2 dB on average (-0.3 to +2.0)"
std::string spread(const std::vector<double>& gains) {
    const auto [least, most] = std::minmax_element(gains.begin(), gains.end());
    const double mean = std::accumulate(gains.begin(), gains.end(), 0.0) / static_cast<double>(gains.size());
    return fmt::format("{:+.1f} dB on average ({:+.1f} to {:+.1f})", tenth(mean), tenth(*least), tenth(*most));
}

void add_spa_beside_fp32(const FormatsStudy& study, std::vector<std::string>& sentences) {
    const auto all = formats_overview(study);
    const auto spa =
        std::find_if(all.begin(), all.end(), [](const auto& o) { return o.format == parse_format("spa22"); });
    if (spa == all.end()) return;
    const FormatOverview& fp32 = all.front();
    sentences.push_back(fmt::format(
        "spa22 (e6m15) has a PSNR of {:.1f} to {:.1f} dB, fp32 one of {:.1f} to {:.1f} dB; {:.2f} to {:.2f} % of its "
        "pixels are off by more than 1/255, {:.2f} to {:.2f} % of fp32's; it takes {:.2f} to {:.2f} times fp32's "
        "kernel time (measured).",
        spa->lowest_psnr_db, spa->highest_psnr_db, fp32.lowest_psnr_db, fp32.highest_psnr_db,
        100 * spa->lowest_share_over, 100 * spa->highest_share_over, 100 * fp32.lowest_share_over,
        100 * fp32.highest_share_over, spa->lowest_ratio, spa->highest_ratio));
}

void add_rounding(const FormatsStudy& study, std::vector<std::string>& sentences) {
    std::vector<double> gains;
    if (study.scenes.empty()) return;
    for (const FormatRow& row : study.scenes.front().rows) {
        if (!row.format.truncates) continue;
        NumberFormat nearest = row.format;
        nearest.truncates = false;
        add_gains(study, row.format, nearest, gains);
    }
    if (gains.empty()) return;
    const auto better = std::count_if(gains.begin(), gains.end(), [](double gain) { return gain > 0; });
    sentences.push_back(
        fmt::format("Rounding to nearest has a higher PSNR than truncation in {} of {} pairs of the same format and "
                    "scene: {}.",
                    better, gains.size(), spread(gains)));
}

void add_change(const FormatsStudy& study, const char* from, const char* to, std::vector<std::string>& sentences) {
    std::vector<double> gains;
    add_gains(study, parse_format(from), parse_format(to), gains);
    if (!gains.empty())
        sentences.push_back(fmt::format("From {} to {} the PSNR changes by {}.", from, to, spread(gains)));
}

void include(FormatOverview& overview, const FormatRow& row, const std::string& label) {
    const ImageDifference& d = row.difference;
    if (d.psnr_db < overview.lowest_psnr_db) overview.worst_scene = label;
    overview.lowest_psnr_db = std::min(overview.lowest_psnr_db, d.psnr_db);
    overview.highest_psnr_db = std::max(overview.highest_psnr_db, d.psnr_db);
    overview.largest = std::max(overview.largest, d.largest);
    overview.lowest_share_over = std::min(overview.lowest_share_over, d.share_over);
    overview.highest_share_over = std::max(overview.highest_share_over, d.share_over);
    overview.lowest_ratio = std::min(overview.lowest_ratio, row.ratio_to_fp32);
    overview.highest_ratio = std::max(overview.highest_ratio, row.ratio_to_fp32);
}

}  // namespace

std::vector<FormatOverview> formats_overview(const FormatsStudy& study) {
    std::vector<FormatOverview> all;
    if (study.scenes.empty()) return all;
    for (const FormatRow& row : study.scenes.front().rows) {
        const ImageDifference& d = row.difference;
        all.push_back({row.format, d.psnr_db, d.psnr_db, study.scenes.front().label, d.largest, d.share_over,
                       d.share_over, row.ratio_to_fp32, row.ratio_to_fp32});
    }
    for (const SceneRows& scene : study.scenes)
        for (std::size_t i = 0; i < scene.rows.size(); ++i) include(all[i], scene.rows[i], scene.label);
    return all;
}

std::vector<std::string> formats_findings(const FormatsStudy& study) {
    std::vector<std::string> sentences;
    add_spa_beside_fp32(study, sentences);
    add_rounding(study, sentences);
    add_change(study, "e6m13", "e6m15", sentences);
    add_change(study, "e8m15", "e8m21", sentences);
    add_change(study, "e6m15", "e8m15", sentences);
    return sentences;
}

}  // namespace raya
