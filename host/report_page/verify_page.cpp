#include <fmt/core.h>

#include "host/page/html.hpp"
#include "host/report_page/read.hpp"
#include "host/report_page/report_page.hpp"

namespace raya {
namespace {

// A build log may be long, and several devices may fail: 1 MB holds them all.
constexpr std::size_t kLongestText = 20'000, kFullFailures = 8;

std::string text_html(const char* title, const std::string& text) {
    if (text.empty()) return {};
    const bool cut = text.size() > kLongestText;
    std::string begin = text.substr(0, kLongestText);
    return fmt::format("<h4>{}</h4>\n<pre tabindex=\"0\">{}</pre>\n{}", title, html_text(begin),
                       cut ? fmt::format("<p class=\"note\">The first {} of {} bytes; all stand in the report.</p>\n",
                                         kLongestText, text.size())
                           : "");
}

std::string failure_html(const Json& check) {
    return fmt::format("<p><span class=\"verdict no\">FAIL</span> {} {}: {}</p>\n",
                       html_prose(check.at("layer").text()), html_prose(check.at("name").text()),
                       html_prose(check.at("told").text())) +
           text_html("Where", check.at("where").text()) + text_html("Expected", check.at("expected").text()) +
           text_html("Got", check.at("got").text()) + text_html("Build options", check.at("build_options").text()) +
           (check.at("remedies").elements().empty()
                ? ""
                : "<h4>What to try</h4>\n" + html_list(check.at("remedies").texts()));
}

std::string status_html(const std::string& status) {
    const char* const kind = status == "PASS" ? "yes" : status == "FAIL" ? "no" : "open";
    return fmt::format("<span class=\"verdict {}\">{}</span>", kind, html_text(status));
}

std::string checks_html(const Json& device) {
    TextCells html = {{"status", "layer", "check", "seconds", "told"}};
    constexpr std::size_t kLongestLine = 300;
    for (const Json& check : device.at("checks").elements()) {
        const std::string& told = check.at("told").text();
        html.push_back({status_html(check.at("status").text()), html_prose(check.at("layer").text()),
                        html_prose(check.at("name").text()), fixed(check.at("seconds").number(), 2),
                        html_prose(told.size() > kLongestLine ? told.substr(0, kLongestLine) + " ..." : told)});
    }
    return html.size() > 1 ? html_table({"Every check on " + device.at("name").text(), html})
                           : "<p>No check ran.</p>\n";
}

const Json* first_failure(const Json& device) {
    for (const Json& check : device.at("checks").elements())
        if (check.at("status").text() == "FAIL") return &check;
    return nullptr;
}

std::string device_html(const Json& device, bool in_full) {
    std::string html = html_tiles({{"passed", count_of(device.at("passed"))},
                                   {"failed", count_of(device.at("failed"))},
                                   {"skipped", count_of(device.at("skipped"))},
                                   {"took", fixed(device.at("seconds").number(), 1) + " s"}}) +
                       html_definitions({{"platform", html_text(device.at("platform").text())},
                                         {"version", html_text(device.at("version").text())},
                                         {"driver", html_text(device.at("driver").text())}});
    const Json* const failure = first_failure(device);
    if (failure != nullptr && in_full) html += html_section("The first failure", failure_html(*failure));
    return html + html_section("Every check", checks_html(device));
}

std::string verdict_of(const Json& device) {
    if (device.at("failed").whole() > 0) return "<span class=\"verdict no\">is not right</span>";
    if (device.at("passed").whole() == 0) return "<span class=\"verdict open\">was not checked</span>";
    return "<span class=\"verdict yes\">is right, as far as was looked</span>";
}

}  // namespace

std::string verify_page(const Json& report) {
    const auto& devices = report.at("devices").elements();
    if (devices.empty()) throw JsonError("it has no devices");
    std::string parts, lead;
    std::size_t failures = 0;
    for (std::size_t i = 0; i < devices.size(); ++i) {
        const std::string& name = devices[i].at("name").text();
        if (first_failure(devices[i]) != nullptr) ++failures;
        parts += html_part(fmt::format("device-{}", i + 1), name, device_html(devices[i], failures <= kFullFailures));
        lead += fmt::format("<p>{} {}.</p>\n", html_text(name), verdict_of(devices[i]));
    }
    return framed_page(
        {.kicker = "raya verify",
         .title = devices.size() == 1 ? devices.front().at("name").text() : fmt::format("{} devices", devices.size()),
         .lead = lead + fmt::format("<p class=\"note\">Depth: {}. Layers rest on each other from the number layer "
                                    "up: the first failure is nearest to the fault.</p>\n",
                                    html_text(report.at("depth").text())),
         .parts = parts,
         .made = fmt::format("Checked by {}; made from the report of that run alone.",
                             html_text(report.at("program").text()))});
}

}  // namespace raya
