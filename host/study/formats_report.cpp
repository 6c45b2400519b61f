#include "host/study/formats_report.hpp"

#include <nlohmann/json.hpp>

#include "host/study/page_writer.hpp"
#include "host/study/rows.hpp"
#include "host/study/text_tables.hpp"

namespace raya {
namespace {

using Cells = std::vector<std::vector<std::string>>;

// Where kernel_s comes from.
const char* clock_name(const FormatsStudy& study) { return study.device.profiling ? "device" : "host"; }

// What CSV and JSON have of a row, both under these names; what is measured stands apart in JSON.
const std::string kMeasured = "measured_";
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
        {kMeasured + "kernel_s", &FormatRow::kernel_s},
        {kMeasured + "ratio_to_fp32", &FormatRow::ratio_to_fp32}};
    return all;
}

nlohmann::ordered_json row_json(const FormatRow& row) {
    nlohmann::ordered_json json;
    for (const auto& [name, figure, unit] : columns())
        if (name.starts_with(kMeasured))
            json["measured"][name.substr(kMeasured.size())] = cell_json(figure(row));
        else
            json[name] = cell_json(figure(row));
    return json;
}

nlohmann::ordered_json scene_json(const SceneRows& scene) {
    return {{"scene", scene.label}, {"objects", scene.objects}, {"formats", each(scene.rows, row_json)}};
}

std::string ratio_range(const Range& range) {
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

}  // namespace

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

nlohmann::ordered_json formats_json(const FormatsStudy& study) {
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
