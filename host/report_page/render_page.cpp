#include <fmt/core.h>

#include "host/model/unit_text.hpp"
#include "host/page/html.hpp"
#include "host/report_page/read.hpp"
#include "host/report_page/render_parts.hpp"
#include "host/report_page/report_page.hpp"

namespace raya {
namespace {

std::uint64_t rays_of(const Json& rays) {
    std::uint64_t all = 0;
    for (const char* kind : {"primary", "reflected", "refracted", "shadow"}) all += rays.at(kind).whole();
    return all;
}

// "spa (256 PEs, cyclic mapping, offset 16)"
std::string machine_text(const Json& report) {
    const Json& m = report.at("machine");
    const auto optional = [&](const char* key, const char* before) {
        const Json& value = m.at(key);
        if (value.is_null()) return std::string();
        return before + (value.is_text() ? value.text() : fmt::format("{}", value.whole()));
    };
    const bool torus = report.find("torus") != nullptr;
    return fmt::format("{} ({} {}, {}{}{})", m.at("name").text(), m.at("pes").whole(), torus ? "nodes" : "PEs",
                       torus ? m.at("topology").text() : m.at("mapping").text() + " mapping",
                       optional("offset", ", offset "), optional("fold", ", fold "));
}

std::string lead_html(const Json& report) {
    const Json &image = report.at("image"), &machine = report.at("machine"), &load = report.at("load"),
               &modelled = report.at("modelled_ms");
    const double render_s = report.at("measured").at("render_s").number();
    if (!(render_s > 0)) throw JsonError("measured.render_s must be above 0");
    const std::uint64_t rays = rays_of(report.at("rays"));
    const Json* const whole = modelled.is_null() ? nullptr : modelled.find(report.find("torus") ? "stepwise" : "total");
    std::string html = fmt::format("<p>{} x {} pixels on {}, {}, {} bounces.</p>\n", image.at("width").whole(),
                                   image.at("height").whole(), html_prose(machine_text(report)),
                                   html_text(machine.at("format").text()), machine.at("bounces").whole());
    html += html_tiles(
        {{"imbalance u", fixed(load.at("imbalance").number(), 3)},
         {"speed-up", fmt::format("{:.1f} of {}", load.at("speedup").number(), machine.at("pes").whole())},
         {"efficiency", percent_of(load.at("efficiency").number())},
         {"rays", grouped(rays)},
         {report.find("torus") ? "modelled, step by step" : "modelled time", whole ? time_text(whole->number()) : ""},
         {"render here", time_text(1e3 * render_s)},
         {"rate here", rate_text(static_cast<double>(rays) / render_s)}});
    for (const std::string& warning : report.at("warnings").texts())
        html += fmt::format("<p class=\"message\">{}</p>\n", html_prose(warning));
    return html;
}

}  // namespace

std::string counts_html(const Json& report) {
    const auto table = [&](const char* key, const char* label) {
        const Json& of = report.at(key);
        TextCells cells = {{label, "count"}};
        for (const std::string& name : of.keys()) cells.push_back({replaced(name, "_", " "), count_of(of.at(name))});
        return html_table({label, html_cells(cells)});
    };
    std::string html =
        table("rays", "rays") + table("tests", "tests of rays against objects") + table("shading", "shading");
    if (report.find("communication") != nullptr) html += table("communication", "bus and ring");
    return "<div class=\"tables\">\n" + html + "</div>\n";
}

std::string making_html(const Json& report) {
    const Json &device = report.at("device"), &machine = report.at("machine"), &measured = report.at("measured");
    const Json& limit = machine.at("pe_memory_bytes");
    const std::string used = needed_text(machine.at("pe_memory_used_bytes").whole());
    std::string html = html_definitions(
        {{"device", html_text(device.at("name").text())},
         {"platform", html_text(device.at("platform").text())},
         {"version", html_text(device.at("version").text())},
         {"driver", html_text(device.at("driver").text())},
         {"lanes, group", fmt::format("{}, {}", device.at("lanes").whole(), device.at("group_size").whole())},
         {"they come from", html_text(device.at("tuned").text())},
         {"memory of a PE", html_text(used + (limit.is_null() ? ", no limit" : " of " + present_text(limit.whole())))},
         {"image's hash", "<code>" + html_text(report.at("image").at("hash").text()) + "</code>"},
         {"build options", "<code>" + html_text(device.at("build_options").text()) + "</code>"}});
    if (const Json* const builds = measured.find("builds")) {
        TextCells cells = {{"program", "build s"}};
        for (const Json& build : builds->elements())
            cells.push_back({build.at("program").text(), fixed(build.at("seconds").number(), 3)});
        if (cells.size() > 1) html += html_section("Builds", html_table({"Builds", html_cells(cells)}));
    }
    const Json* const ranks = measured.find("ranks");
    if (ranks == nullptr) return html;
    TextCells cells = {{"rank", "host", "device", "render s", "waiting s", "messages", "bytes sent"}};
    for (const Json& rank : ranks->elements())
        cells.push_back({fmt::format("{}", rank.at("rank").whole()), rank.at("host").text(),
                         rank.at("device").at("name").text(), fixed(rank.at("render_s").number(), 3),
                         fixed(rank.at("waiting_s").number(), 3), count_of(rank.at("messages_sent")),
                         count_of(rank.at("bytes_sent"))});
    return html + html_section("Ranks", html_folded_table({"Ranks", html_cells(cells)}, "All stand in the report."));
}

std::string render_page(const Json& report, const std::optional<raya_mapping>& mapping) {
    const bool torus = report.find("torus") != nullptr;
    if (report.at("load").at("per_pe").elements().size() != report.at("machine").at("pes").whole())
        throw JsonError("load.per_pe has another length than machine.pes says");
    const std::string parts =
        html_part("pictures", torus ? "Picture and nodes" : "Picture and owners", pictures_html(report, mapping)) +
        html_part("loads", torus ? "Load of each node" : "Load of each PE", loads_html(report)) +
        html_part("traffic", "Traffic of the links", traffic_html(report)) +
        html_part("model", "Modelled beside measured", model_html(report)) +
        html_part("labels", "Times by label", labels_html(report)) +
        html_part("roof", "Roofline", render_roofline_html(report)) +
        html_part("counts", "What was counted", counts_html(report)) +
        html_part("made", "Device and build", making_html(report));
    return framed_page({.kicker = "raya render",
                        .title = report.at("scene").text(),
                        .lead = lead_html(report),
                        .parts = parts,
                        .made = fmt::format("Rendered by raya {}; made from the report of that run alone.",
                                            html_text(report.at("raya").text()))});
}

}  // namespace raya
