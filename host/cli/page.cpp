// raya page REPORT.json -o FILE.html: writes a report as an HTML page.
#include "host/cli/page.hpp"

#include <fmt/core.h>

#include <filesystem>
#include <memory>

#include "host/base/log.hpp"
#include "host/base/standard_streams.hpp"
#include "host/base/whole_file.hpp"
#include "host/cli/command_tree.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/options.hpp"
#include "host/error.hpp"
#include "host/report/bench_report.hpp"
#include "host/report/page/page.hpp"
#include "host/report/render_report.hpp"
#include "host/verify/verify.hpp"

namespace raya {
namespace {

struct PageCommand {
    std::string report, page;
};

// Removes the folders from file names in the report, because users send pages to others.
Json without_folders(Json report) {
    const auto shorten = [](Json& object, const char* key) {
        const Json* const path = find_member(object, key);
        if (path != nullptr && path->is_string())
            object[key] = std::filesystem::path(json_text(*path)).filename().string();
    };
    const Json *const scene = find_member(report, "scene"), *const warnings = find_member(report, "warnings");
    if (scene != nullptr && scene->is_string() && warnings != nullptr) {
        const std::string file = json_text(*scene);
        Json shortened = Json::array();
        for (const std::string& text : json_strings(*warnings))
            shortened.push_back(text.starts_with(file + ':') ? text.substr(file.rfind('/') + 1) : text);
        report["warnings"] = shortened;
    }
    shorten(report, "scene");
    for (const auto& [part, key] : {std::pair{"image", "file"}, {"device", "tuned"}, {"compared", "baseline"}})
        if (report.contains(part)) shorten(report[part], key);
    return report;
}

void check_kind(const Json& report) {
    const Json* const kind = find_member(report, "kind");
    const std::string name = kind != nullptr && kind->is_string() ? json_text(*kind) : "";
    for (const char* known : {kRenderReportKind, kBenchReportKind, kVerifyReportKind, "raya gpu_day"})
        if (name == known) return;
    if (kind == nullptr && (find_member(report, "measured") != nullptr || find_member(report, "devices") != nullptr))
        throw UserError(
            "a report of an older raya, which does not state the command that wrote it; write the report again");
    throw UserError("valid JSON, but not a report of raya render, bench, verify or gpu_day");
}

JsonSource report_source(const std::string& name) {
    return {name, "give a report that this version of raya render, bench or verify wrote with --report FILE.json"};
}

void make_page(const PageCommand& command) {
    check_page_name("-o", command.page);
    const std::string name = input_name(command.report);
    const std::string page = page_of_report(json_file_text(command.report, report_source(name), Pipes::kRead), name);
    write_whole_file(command.page, page);
    if (!is_quiet())
        fmt::print("page    {} ({:.0f} KB); open it in a browser; it needs no network\n", printable(command.page),
                   static_cast<double>(page.size()) / 1e3);
}

}  // namespace

void check_page_name(const std::string& option, const std::string& file) {
    if (!file.ends_with(".html") && !file.ends_with(".htm") && !file.starts_with("/dev/") && !is_standard_stream(file))
        throw UserError(fmt::format("{} {}: raya writes an HTML page; choose a name that ends in .html", option, file));
}

std::string page_of_report(const std::string& text, const std::string& name) {
    return read_json(text, report_source(name), [](const Json& report) {
        check_kind(report);
        return report_page(without_folders(report));
    });
}

void write_report_and_page(const ReportFiles& files, const Json& report) {
    if (!files.report.empty()) write_whole_file(files.report, json_dump(report, 2) + "\n");
    if (!files.page.empty()) write_whole_file(files.page, report_page(without_folders(report)));
}

void add_page_command(CLI::App& program) {
    CLI::App* command = program.add_subcommand("page", "Make an HTML page from a report of render, bench or verify");
    add_examples(*command,
                 {{"raya render scenes/planes.nff --report planes.json -o planes.png && raya page planes.json -o "
                   "planes.html",
                   "Make a page from the report of a render; render --page writes the page without this step"},
                  {"raya verify --brief --only number --report verify.json && raya page verify.json -o verify.html",
                   "Make a page of the checks of this device"}});
    const auto options = std::make_shared<PageCommand>();
    const OptionGroup group(*command, kFiles);
    add_file(*command, FileUse::kRead, "REPORT", options->report, "REPORT.json",
             "Report of raya render, bench or verify, written by --report")
        ->required();
    add_file(*command, FileUse::kWritten, "-o,--output", options->page, "FILE.html",
             "HTML page to write: one file that needs no network")
        ->required();
    command->callback([options] { make_page(*options); });
}

}  // namespace raya
