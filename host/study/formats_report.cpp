#include "host/study/formats_report.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "host/study/formats_findings.hpp"
#include "host/study/text_tables.hpp"

namespace raya {
namespace {

using Cells = std::vector<std::vector<std::string>>;

const char* rounding_name(const NumberFormat& format) { return format.truncates ? "truncate" : "nearest"; }

// Where kernel_s comes from.
const char* clock_name(const FormatsStudy& study) { return study.device.profiling ? "device" : "host"; }

nlohmann::ordered_json row_json(const FormatRow& row) {
    const ImageDifference& d = row.difference;
    return {{"format", format_name(row.format)},
            {"exponent_bits", row.format.exponent_bits},
            {"fraction_bits", row.format.fraction_bits},
            {"rounding", rounding_name(row.format)},
            {"psnr_db", json_number(d.psnr_db)},
            {"largest_error", json_number(d.largest)},
            {"pixels_over", d.over},
            {"share_over", d.share_over},
            {"image_hash", row.image_hash},
            {"measured", {{"kernel_s", row.kernel_s}, {"ratio_to_fp32", row.ratio_to_fp32}}}};
}

nlohmann::ordered_json scene_json(const SceneRows& scene) {
    auto rows = nlohmann::ordered_json::array();
    for (const FormatRow& row : scene.rows) rows.push_back(row_json(row));
    return {{"scene", scene.label}, {"objects", scene.objects}, {"formats", rows}};
}

std::string ratio_range(double lowest, double highest) {
    const std::string from = fmt::format("{:.2f}", lowest), to = fmt::format("{:.2f}", highest);
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
    std::string text =
        "scene,format,exponent_bits,fraction_bits,rounding,psnr_db,largest_error,pixels_over,share_over,image_hash,"
        "measured_kernel_s,measured_ratio_to_fp32\n";
    for (const SceneRows& scene : study.scenes)
        for (const FormatRow& row : scene.rows) {
            const ImageDifference& d = row.difference;
            text +=
                fmt::format("{},{},{},{},{},{},{},{},{},{},{},{}\n", csv_field(scene.label), format_name(row.format),
                            row.format.exponent_bits, row.format.fraction_bits, rounding_name(row.format), d.psnr_db,
                            d.largest, d.over, d.share_over, row.image_hash, row.kernel_s, row.ratio_to_fp32);
        }
    return text;
}

nlohmann::ordered_json formats_json(const FormatsStudy& study) {
    auto scenes = nlohmann::ordered_json::array();
    for (const SceneRows& scene : study.scenes) scenes.push_back(scene_json(scene));
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
            {"scenes", scenes}};
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
        cells.push_back({format_name(o.format), fmt::format("{:.2f}", o.lowest_psnr_db), o.worst_scene,
                         fmt::format("{:.4f}", o.largest), fmt::format("{:.3f}", 100 * o.highest_share_over),
                         ratio_range(o.lowest_ratio, o.highest_ratio)});
    return cells;
}

}  // namespace raya
