#include <fmt/core.h>

#include <algorithm>

#include "host/page/drawing.hpp"
#include "host/page/html.hpp"
#include "host/report_page/read.hpp"
#include "host/report_page/render_parts.hpp"

namespace raya {
namespace {

std::string giga(double value) { return fixed(1e-9 * value, 2); }

double positive(const Json& json, const char* key) {
    const double value = json.at(key).number();
    if (!(value > 0)) throw JsonError(fmt::format("{} must be above 0", key));
    return value;
}

std::vector<std::string> cells_of(const Json& row, const std::string& name, std::size_t number) {
    const Json& of_format = row.at("share_of_format");
    const auto or_dash = [](double value, const std::string& text) { return value > 0 ? text : "-"; };
    const double rays = row.at("rays_per_s").number(), operations = row.at("operations_per_s").number();
    return {
        fmt::format("{}", number),
        name,
        or_dash(rays, fixed(1e-6 * rays, 2)),
        or_dash(operations, fixed(1e-9 * operations, 3)),
        fixed(1e-9 * row.at("bytes_per_s").number(), 3),
        or_dash(row.at("operations_per_byte").number(), fmt::format("{:.3g}", row.at("operations_per_byte").number())),
        row.at("bound").text(),
        percent_of(row.at("share_of_roof").number(), 2),
        of_format.is_null() ? "-" : percent_of(of_format.number(), 2)};
}

std::string peak_html(const Json& p) {
    const std::string format = p.at("format").text();
    return fmt::format(
        "<p>The peak was measured by small programs in the same run: {} Gop/s of multiply-adds in fp32; in {} {} of "
        "multiply-adds, {} of divisions, {} of roots; {} GB/s copied, each byte counted as read and as written. An "
        "operation is one of the budgets of the events that were counted, bytes are the fewest that the kernel has to "
        "move.</p>\n",
        giga(positive(p, "fp32_multiply_adds_per_s")), html_text(format),
        giga(positive(p, "format_multiply_adds_per_s")), giga(positive(p, "format_divisions_per_s")),
        giga(positive(p, "format_roots_per_s")), giga(positive(p, "copy_bytes_per_s")));
}

}  // namespace

std::string roofline_html(const std::string& id, const Json& peak, const std::vector<const Json*>& rows,
                          const std::vector<std::string>& names) {
    TextCells cells = {
        {"no.", "kernel", "Mrays/s", "Gop/s", "GB/s", "op/byte", "bound", "of the roof", "of the format"}};
    std::vector<RoofPoint> points;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const Json& row = *rows[i];
        const double operations = row.at("operations_per_s").number(),
                     intensity = row.at("operations_per_byte").number();
        const bool drawn = operations > 0 && intensity > 0;
        if (drawn) points.push_back({intensity, 1e-9 * operations});
        cells.push_back(cells_of(row, names[i], points.size()));
        if (!drawn) cells.back().front() = "-";
    }
    const std::string format = peak.at("format").text();
    std::vector<double> lower;
    if (format != "fp32") lower.push_back(1e-9 * positive(peak, "format_multiply_adds_per_s"));
    RoofWords words{{.id = id + "-drawing",
                     .title = "Kernels, by their numbers in the table, below the device's roof: as fast as their bytes "
                              "are copied, or as "
                              "multiply-adds are computed.",
                     .across = "operations a byte",
                     .up = "thousand million operations a second",
                     .series = fmt::format("the roof, and {} kernels by the numbers of the table", points.size())},
                    "copies",
                    {"multiply-adds in fp32"}};
    if (!lower.empty()) words.tops.push_back("in " + format);
    const double scatter = peak.at("scatter").number();
    const std::string remark =
        scatter > 0.15 ? fmt::format(
                             "<p class=\"message\">The peak, measured three times, scattered by {}: something else ran "
                             "on the device, and shares of the peak say little.</p>\n",
                             percent_of(scatter, 0))
                       : "";
    return html_roof(words, 1e-9 * positive(peak, "copy_bytes_per_s"),
                     1e-9 * positive(peak, "fp32_multiply_adds_per_s"), lower, points) +
           html_table({"Roofline", html_cells(cells)}) + peak_html(peak) + remark;
}

std::string render_roofline_html(const Json& report) {
    const Json& m = report.at("measured");
    if (const Json* const why = m.find("no_roofline"))
        return fmt::format("<p>There is none: {}.</p>\n", html_prose(why->text()));
    const Json *const peak = m.find("peak"), *const list = m.find("roofline");
    if (peak == nullptr || list == nullptr)
        return "<p>The device's peak was not measured; <code>raya render --page</code> and <code>--profile</code> "
               "measure "
               "it.</p>\n";
    std::vector<const Json*> rows;
    std::vector<std::string> names;
    for (const Json& row : list->elements()) {
        rows.push_back(&row);
        names.push_back(row.at("label").text());
    }
    return roofline_html("roofline", *peak, rows, names);
}

}  // namespace raya
