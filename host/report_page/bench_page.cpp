#include <fmt/core.h>

#include "host/page/drawing.hpp"
#include "host/page/html.hpp"
#include "host/report_page/read.hpp"
#include "host/report_page/render_parts.hpp"
#include "host/report_page/report_page.hpp"

namespace raya {
namespace {

// "trace, e6m15, 16 lanes"
std::string row_name(const Json& row) {
    return fmt::format("{}, {}, {} lanes, group {}", row.at("kernel").text(), row.at("format").text(),
                       row.at("lanes").whole(), row.at("group").whole());
}

std::string rate(double mrays_per_s) { return fixed(mrays_per_s, mrays_per_s < 10 ? 2 : 1); }

// Of each row of the run the baseline's, null where it has none; compare_bench() wrote them in the run's order first.
std::vector<const Json*> baselines_of(const Json& report) {
    std::vector<const Json*> found(report.at("rows").elements().size());
    const Json* const compared = report.find("compared");
    if (compared == nullptr) return found;
    const auto& rows = compared->at("rows").elements();
    for (std::size_t i = 0; i < found.size() && i < rows.size(); ++i)
        if (const Json& was = rows[i].at("mrays_per_s_was"); !was.is_null()) found[i] = &was;
    return found;
}

std::string rates_html(const Json& report) {
    const std::vector<const Json*> baselines = baselines_of(report);
    const auto& rows = report.at("rows").elements();
    const bool compared = report.find("compared") != nullptr;
    std::vector<NamedBar> bars;
    TextCells cells = {
        {"kernel", "format", "lanes", "group", "Mrays/s best", "median", "ms best", "median", "samples", "image"}};
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const Json &row = rows[i], &rates = row.at("mrays_per_s"), &ms = row.at("ms");
        const double median = rates.at("median").number();
        if (!(median > 0)) throw JsonError("rows has a rate that is not above 0");
        bars.push_back({row_name(row), rate(median) + " Mrays/s", median, {}});
        if (baselines[i] != nullptr) bars.back().mark = baselines[i]->at("median").number();
        cells.push_back({row.at("kernel").text(), row.at("format").text(), count_of(row.at("lanes")),
                         count_of(row.at("group")), rate(rates.at("best").number()), rate(median),
                         fixed(ms.at("best").number(), 2), fixed(ms.at("median").number(), 2),
                         count_of(row.at("samples")), row.at("hash").text().substr(0, 8)});
    }
    return html_named_bars({.id = "rates-bars",
                            .title = std::string("Rays per second, medians of the samples") +
                                     (compared ? "; the lines are the baseline's." : "."),
                            .across = "million rays a second",
                            .up = "row",
                            .series = fmt::format("{} rows", bars.size())},
                           bars) +
           html_table({"Rates", html_cells(cells)}) +
           "<p class=\"note\">image: the hash's begin; it is the same in all rows of a format, else nothing would have "
           "been "
           "measured.</p>\n";
}

std::string verdict_html(const std::string& verdict) {
    const bool bad = verdict.starts_with("OTHER IMAGE") || verdict == "SLOWER",
               good = verdict == "faster" || verdict == "as before";
    return fmt::format("<span class=\"verdict {}\">{}</span>", bad ? "no" : good ? "yes" : "open", html_prose(verdict));
}

std::string compared_html(const Json& report) {
    const Json* const c = report.find("compared");
    if (c == nullptr)
        return "<p>This run was held against no baseline; <code>raya bench --compare</code> does so.</p>\n";
    TextCells html = {
        {"kernel", "format", "lanes", "group", "best Mrays/s", "was", "change", "median", "was", "change", "verdict"}};
    for (const Json& row : c->at("rows").elements()) {
        const Json &now = row.at("mrays_per_s"), &was = row.at("mrays_per_s_was");
        html.push_back({html_prose(row.at("kernel").text()), html_text(row.at("format").text()),
                        count_of(row.at("lanes")), count_of(row.at("group"))});
        for (const char* key : {"best", "median"}) {
            const auto told = [&](const Json& side) { return side.is_null() ? "-" : rate(side.at(key).number()); };
            const bool both = !now.is_null() && !was.is_null();
            html.back().insert(
                html.back().end(),
                {told(now), told(was),
                 both ? fmt::format("{:+.1f} %", 100 * (now.at(key).number() / was.at(key).number() - 1)) : "-"});
        }
        html.back().push_back(verdict_html(row.at("verdict").text()));
    }
    std::string text = fmt::format(
        "<p>Held against {}: of {} rows that both have, {} slower by more than {} %, {} with another "
        "image.</p>\n",
        html_text(c->at("baseline").text()), c->at("compared").whole(), c->at("slower").whole(),
        c->at("tolerance_percent").number(), c->at("other_images").whole());
    for (const std::string& remark : c->at("remarks").texts())
        text += fmt::format("<p class=\"message\">{}</p>\n", html_prose(remark));
    return text + html_table({"Comparison with the baseline", html});
}

// One drawing for each peak: rows that follow each other and were held against the same one.
std::string rooflines_html(const Json& report) {
    std::string html, peak;
    std::vector<const Json*> rows;
    std::vector<std::string> names;
    const Json* of = nullptr;
    std::size_t drawings = 0;
    const auto finish = [&] {
        if (rows.empty()) return;
        html += html_section(fmt::format("In {}", of->at("format").text()),
                             roofline_html(fmt::format("roofline-{}", drawings++), *of, rows, names));
        if (rows.size() > 1)
            html +=
                "<p class=\"note\">Each row's shares are of the peak measured with its own lanes; the drawing and the "
                "sentence have the last row's.</p>\n";
        rows.clear(), names.clear();
    };
    for (const Json& row : report.at("rows").elements()) {
        if (const Json* const why = row.find("no_roofline"))
            html += fmt::format("<p>{}: none, {}.</p>\n", html_prose(row_name(row)), html_prose(why->text()));
        const Json *const roof = row.find("roofline"), *const own = row.find("peak");
        if (roof == nullptr || own == nullptr) continue;
        if (own->at("format").text() != peak) finish();
        peak = own->at("format").text();
        of = own;
        rows.push_back(roof);
        names.push_back(row_name(row));
    }
    finish();
    return !html.empty()
               ? html
               : "<p>The device's peak was not measured; <code>raya bench --page</code> measures it, for rows of one "
                 "kernel.</p>\n";
}

}  // namespace

std::string bench_page(const Json& report) {
    const auto& rows = report.at("rows").elements();
    if (rows.empty()) throw JsonError("it has no rows");
    const Json &first = rows.front(), &device = report.at("device");
    const Json* best = &first;
    for (const Json& row : rows)
        if (row.at("mrays_per_s").at("best").number() > best->at("mrays_per_s").at("best").number()) best = &row;
    std::string options;
    for (const Json& row : rows)
        options += fmt::format("<dt>{}</dt><dd><code>{}</code></dd>\n", html_prose(row_name(row)),
                               html_text(row.at("build_options").text()));
    const std::string lead =
        fmt::format("<p>{} pixels, {}, {} rays a picture.</p>\n", html_text(first.at("size").text()),
                    html_prose(first.at("array").text()), count_of(first.at("rays"))) +
        html_tiles({{"best rate", rate(best->at("mrays_per_s").at("best").number()) + " Mrays/s"},
                    {"by", html_prose(row_name(*best))},
                    {"rows", fmt::format("{}", rows.size())}});
    return framed_page(
        {.kicker = "raya bench",
         .title = first.at("scene").text() + " on " + device.at("name").text(),
         .lead = lead,
         .parts = html_part("rates", "Rates", rates_html(report)) +
                  html_part("compared", "Beside the baseline", compared_html(report)) +
                  html_part("roof", "Roofline", rooflines_html(report)) +
                  html_part("made", "Device and build",
                            html_definitions({{"device", html_text(device.at("name").text())},
                                              {"platform", html_text(device.at("platform").text())},
                                              {"version", html_text(device.at("version").text())},
                                              {"driver", html_text(device.at("driver").text())}}) +
                                html_section("Build options", "<dl class=\"long\">\n" + options + "</dl>\n")),
         .made = fmt::format("Measured by raya {}; made from the report of that run alone.",
                             html_text(report.at("raya").text()))});
}

}  // namespace raya
