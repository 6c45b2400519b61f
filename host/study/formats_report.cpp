#include "host/study/formats_report.hpp"

#include <cmath>
#include <numeric>

#include "host/base/json.hpp"
#include "host/report/text_tables.hpp"
#include "host/study/page_writer.hpp"
#include "host/study/rows.hpp"

namespace raya {
namespace {

using Cells = std::vector<std::vector<std::string>>;

// Where kernel_s comes from.
const char* clock_name(const FormatsStudy& study) { return study.device.profiling ? "device" : "host"; }

// What CSV and JSON have of a row, both under these names; what is measured stands apart in JSON.
constexpr const char* kMeasured = "measured_";
const std::vector<Column<FormatRow>>& columns() {
    static const std::vector<Column<FormatRow>> all = {
        {"format", [](const FormatRow& row) { return format_name(row.format); }},
        {"exponent_bits", [](const FormatRow& row) { return row.format.exponent_bits; }},
        {"fraction_bits", [](const FormatRow& row) { return row.format.fraction_bits; }},
        {"rounding", [](const FormatRow& row) { return row.format.truncates ? "truncate" : "nearest"; }},
        {"psnr_db", [](const FormatRow& row) { return row.difference.psnr_db; }},
        {"largest_error", [](const FormatRow& row) { return row.difference.largest; }},
        {"pixels_over", [](const FormatRow& row) { return row.difference.over; }},
        {"share_over", [](const FormatRow& row) { return row.difference.share_over; }},
        {"image_hash", &FormatRow::image_hash},
        {std::string(kMeasured) + "kernel_s", &FormatRow::kernel_s},
        {std::string(kMeasured) + "ratio_to_fp32", &FormatRow::ratio_to_fp32}};
    return all;
}

Json row_json(const FormatRow& row) {
    Json json;
    for (const auto& [name, figure, unit] : columns())
        if (name.starts_with(kMeasured))
            json["measured"][name.substr(std::string_view(kMeasured).size())] = cell_json(figure(row));
        else
            json[name] = cell_json(figure(row));
    return json;
}

Json scene_json(const SceneRows& scene) {
    return {{"scene", scene.label}, {"objects", scene.objects}, {"formats", each(scene.rows, row_json)}};
}

std::string ratio_range(const FigureRange& range) {
    const std::string from = fmt::format("{:.2f}", range.lowest), to = fmt::format("{:.2f}", range.highest);
    return from == to ? from : from + " to " + to;
}

Cells scene_cells(const SceneRows& scene) {
    Cells cells = {
        {"format", "PSNR dB", "largest error", "off by > 1/255, %", "kernel ms (measured)", "time / fp32 (measured)"}};
    for (const FormatRow& row : scene.rows) {
        const ImageDifference& d = row.difference;
        cells.push_back({format_name(row.format), fmt::format("{:.2f}", d.psnr_db), fmt::format("{:.4f}", d.largest),
                         fmt::format("{:.3f}", 100 * d.share_over), fmt::format("{:.2f}", 1e3 * row.kernel_s),
                         fmt::format("{:.2f}", row.ratio_to_fp32)});
    }
    return cells;
}

std::string method(const FormatsStudy& study) {
    return fmt::format(
        "{} x {} pixels, rays through pixel centres, {} bounces, machine {} with {} PEs at offset {}. Each image is "
        "compared with the double-precision reference on values clamped to 0..1. Formats: `eXmY` has X exponent and Y "
        "fraction bits and rounds to nearest, with `t` it truncates; `e6m15` is `spa22`. Times are measured on {} "
        "({}), {} lanes, by the {}'s clock: the least of {} renders of each format, taken in turn.\n",
        study.width, study.height, study.bounces, study.machine, study.pes, study.offset, study.device.name,
        study.device.platform, study.lanes, clock_name(study), study.samples);
}

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
    const auto text = [](double factor, const FigureRange& range, int digits) {
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
FigureRange range_of(const Rows& rows, Figure figure) {
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

std::string formats_csv(const FormatsStudy& study) {
    StudyTable all{"formats", {}, {{"scene"}}, {}};
    for (const Column<FormatRow>& column : columns()) all.columns.push_back({column.label});
    for (const SceneRows& scene : study.scenes)
        for (auto& cells : table_of("", "", scene.rows, columns()).rows) {
            cells.insert(cells.begin(), scene.label);
            all.rows.push_back(std::move(cells));
        }
    return table_csv(all);
}

Json formats_json(const FormatsStudy& study) {
    return {{"study", "formats"},
            {"image", {{"width", study.width}, {"height", study.height}}},
            {"machine",
             {{"name", study.machine}, {"pes", study.pes}, {"offset", study.offset}, {"bounces", study.bounces}}},
            {"device",
             {{"name", study.device.name},
              {"platform", study.device.platform},
              {"version", study.device.version},
              {"lanes", study.lanes},
              {"group_size", study.group_size}}},
            {"limit", kShownStep},
            {"measured", {{"clock", clock_name(study)}, {"samples", study.samples}}},
            {"seen", formats_findings(study)},
            {"scenes", each(study.scenes, scene_json)}};
}

std::string formats_markdown(const FormatsStudy& study) {
    std::string text = "# Number formats against the double-precision reference\n\n" + method(study);
    text += "\n## All scenes\n\n" + markdown_table(formats_overview_cells(study));
    const std::vector<std::string> findings = formats_findings(study);
    if (!findings.empty()) text += "\n## What is seen\n\n";
    for (const std::string& sentence : findings) text += "- " + sentence + '\n';
    for (const SceneRows& scene : study.scenes)
        text +=
            fmt::format("\n## {} ({} objects)\n\n{}", scene.label, scene.objects, markdown_table(scene_cells(scene)));
    return text;
}

Cells formats_overview_cells(const FormatsStudy& study) {
    Cells cells = {
        {"format", "lowest PSNR dB", "of scene", "largest error", "most off by > 1/255, %", "time / fp32 (measured)"}};
    for (const FormatOverview& o : formats_overview(study))
        cells.push_back({format_name(o.format), fmt::format("{:.2f}", o.psnr_db.lowest), o.worst_scene,
                         fmt::format("{:.4f}", o.largest), fmt::format("{:.3f}", 100 * o.share_over.highest),
                         ratio_range(o.ratio)});
    return cells;
}

}  // namespace raya
