// raya page REPORT.json -o FILE.html: a saved report as a page.
#include "host/cli/page.hpp"

#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <optional>

#include "host/base/say.hpp"
#include "host/base/standard_streams.hpp"
#include "host/base/whole_file.hpp"
#include "host/cli/command_tree.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/file_options.hpp"
#include "host/cli/options.hpp"
#include "host/cli/parse.hpp"
#include "host/cli/parse_mapping.hpp"
#include "host/error.hpp"
#include "host/page/html_document.hpp"
#include "host/report/bench_report.hpp"
#include "host/report/render_report.hpp"
#include "host/report_page/report_page.hpp"
#include "host/ring/mapping.hpp"
#include "host/verify/verify.hpp"

namespace raya {
namespace {

struct PageCommand {
    std::string report, page;
};

// Of a ring whose pixels a rule divides.
std::optional<raya_mapping> mapping_of(const Json& report) {
    const Json &machine = report.at("machine"), &image = report.at("image");
    const std::string& text = machine.at("mapping").text();
    if (report.find("torus") != nullptr || is_dynamic(text)) return {};
    const auto side = [&](const char* key) { return static_cast<std::uint32_t>(image.at(key).whole(kLargestSide)); };
    MappingRule rule = parse_mapping(text).rule;
    if (rule.has_slots())
        rule = cyclic_mapping(static_cast<std::uint32_t>(machine.at("offset").whole(kLargestSide)),
                              parse_fold(machine.at("fold").text()));
    return make_mapping(rule, {side("width"), side("height")},
                        static_cast<std::uint32_t>(machine.at("pes").whole(UINT32_MAX)));
}

// A page is sent to others: the files that a run names appear without their folders.
Json without_folders(Json report) {
    const auto shorten = [](Json& object, const char* key) {
        const Json* const path = object.find(key);
        if (path != nullptr && path->is_text()) object[key] = std::filesystem::path(path->text()).filename().string();
    };
    const Json *const scene = report.find("scene"), *const warnings = report.find("warnings");
    if (scene != nullptr && scene->is_text() && warnings != nullptr) {
        const std::string file = scene->text();
        Json shorter = Json::list();
        for (const std::string& text : warnings->texts())
            shorter.push_back(text.starts_with(file + ':') ? text.substr(file.rfind('/') + 1) : text);
        report["warnings"] = shorter;
    }
    shorten(report, "scene");
    for (const auto& [part, key] : {std::pair{"image", "file"}, {"device", "tuned"}, {"compared", "baseline"}})
        if (report.find(part) != nullptr) shorten(report[part], key);
    return report;
}

std::string page_of(const Json& report) {
    const Json* const kind = report.find("kind");
    const std::string name = kind != nullptr && kind->is_text() ? kind->text() : "";
    if (name == kRenderReportKind) return render_page(report, mapping_of(report));
    if (name == kBenchReportKind) return bench_page(report);
    if (name == kVerifyReportKind) return verify_page(report);
    if (kind == nullptr && (report.find("measured") != nullptr || report.find("devices") != nullptr))
        throw JsonError("the report of an older raya, without the command that wrote it");
    throw JsonError("valid JSON, but not a report of raya render, bench or verify");
}

JsonSource source_of(const std::string& name) {
    return {name, "a report that this raya writes by raya render, bench or verify with --report FILE.json"};
}

void make_page(const PageCommand& command) {
    check_page_name("-o", command.page);
    const std::string name = input_name(command.report);
    const std::string page = page_of_report(json_text(command.report, source_of(name), Pipes::kRead), name);
    write_whole_file(command.page, page);
    if (!is_quiet())
        fmt::print("page    {} ({:.0f} KB); open it in a browser, it needs no network\n", printable(command.page),
                   static_cast<double>(page.size()) / 1e3);
}

}  // namespace

void check_page_name(const std::string& option, const std::string& file) {
    if (!file.ends_with(".html") && !file.ends_with(".htm") && !file.starts_with("/dev/") && !is_standard_stream(file))
        throw UserError(
            fmt::format("{} {}: what is written is a page for a browser; let the name end in .html", option, file));
}

std::string page_of_report(const std::string& report, const std::string& name) {
    const auto page_from = [](const Json& json) { return page_of(without_folders(json)); };
    const std::string page = read_json(report, source_of(name), page_from);
    if (page.size() <= kLargestPage) return page;
    throw UserError(fmt::format("{}: its page would have {} bytes, {} at most so that it can be sent", name,
                                page.size(), kLargestPage));
}

void write_report_and_page(const ReportFiles& files, const std::string& report) {
    if (!files.report.empty()) write_whole_file(files.report, report);
    if (!files.page.empty())
        write_whole_file(files.page, page_of_report(report, files.report.empty() ? "the report" : files.report));
}

void add_page_command(CLI::App& program) {
    CLI::App* command = program.add_subcommand(
        "page", "Make a page for a browser of a saved report of render, bench or verify; nothing runs again");
    add_examples(*command,
                 {{"raya render scenes/planes.nff --report planes.json -o planes.png && raya page planes.json -o "
                   "planes.html",
                   "A render whose report becomes a page; render --page does both at once"},
                  {"raya verify --brief --only number --report verify.json && raya page verify.json -o verify.html",
                   "What was checked on this device, to be sent to somebody"}});
    const auto options = std::make_shared<PageCommand>();
    const OptionGroup group(*command, kFiles);
    add_file(*command, FileUse::kRead, "REPORT", options->report, "REPORT.json",
             "Report of raya render, bench or verify, as --report writes it")
        ->required();
    add_file(*command, FileUse::kWritten, "-o,--output", options->page, "FILE.html",
             "Page to write: one file for a browser, below 1 MB, that needs no network")
        ->required();
    command->callback([options] { make_page(*options); });
}

}  // namespace raya
