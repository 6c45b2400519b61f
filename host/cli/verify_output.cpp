#include "host/cli/verify_output.hpp"

#include <fmt/core.h>

#include <cstdio>
#include <iomanip>
#include <memory>
#include <sstream>
#include <vector>

#include "host/base/log.hpp"
#include "host/base/standard_streams.hpp"
#include "host/cli/command_tree.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/options.hpp"
#include "host/cli/parse_failure.hpp"
#include "host/error.hpp"
#include "host/model/number_format.hpp"
#include "host/version.hpp"

namespace raya {
namespace {

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

std::string first_wrong(const Verdict& verdict) {
    const Fault& f = verdict.fault;
    if (f.where.empty() || f.got.empty()) return first_line(verdict.result);
    return fmt::format("{}: expected {}, got {}", first_line(f.where), first_line(f.expected), first_line(f.got));
}

}  // namespace

std::string SoakCounts::add(const Check& check, double seconds) {
    Count& count = counts_[check.layer + " " + check.name];
    ++count.runs;
    const Outcome outcome = check.verdict.outcome;
    if (outcome != Outcome::kFail && outcome != Outcome::kUnexpectedPass) return "";
    const std::string wrong = first_wrong(check.verdict);
    if (count.failures++ == 0) {
        count.first_s = seconds;
        count.first_wrong = wrong;
    }
    count.repeats += wrong == count.first_wrong;
    const std::string lines = check_lines(check);
    return fmt::format("after {:.1f} s: {}", seconds, count.failures == 1 ? lines : first_line(lines) + "\n");
}

std::string SoakCounts::summary() const {
    std::string lines;
    for (const auto& [name, count] : counts_)
        if (count.failures > 0)
            lines +=
                fmt::format("{}: failed {} of {}, first after {:.1f} s; {} of {} with the same first wrong word: {}\n",
                            name, count.failures, counted(count.runs, "time"), count.first_s, count.repeats,
                            counted(count.failures, "failure"), count.first_wrong);
    return lines;
}

namespace {

// Returns the text "57 checks passed, 0 failed, 2 skipped in 12.3 s".
std::string closing_text(const std::vector<Check>& checks, double seconds) {
    const std::size_t expected = count_of(checks, Outcome::kExpectedFail),
                      unexpected = count_of(checks, Outcome::kUnexpectedPass);
    return fmt::format("{} passed, {} failed, {} skipped{}{} in {:.1f} s",
                       counted(count_of(checks, Outcome::kPass), "check"), count_of(checks, Outcome::kFail),
                       count_of(checks, Outcome::kSkip),
                       expected ? fmt::format(", {} failed as expected", expected) : "",
                       unexpected ? fmt::format(", {} passed unexpectedly", unexpected) : "", seconds);
}

void print(const std::string& lines) {
    clear_status();
    fmt::print("{}", lines);
    std::fflush(stdout);
}

}  // namespace

DeviceOutput::DeviceOutput(const VerifySettings& settings, std::size_t index) : settings_(settings), index_(index) {}

void DeviceOutput::device(const DeviceChecks& device, const std::vector<std::string>& unusable_devices,
                          std::size_t devices) {
    device_count_ = devices;
    if (soaks() && devices > 1) prefix_ = device.name + ": ";
    if (is_quiet()) return;
    if (index_ == 0)
        for (const std::string& line : unusable_devices) print(line + "\n");
    print(fmt::format("{} ({}, driver {})\n", device.name, device.platform, device.driver));
}

void DeviceOutput::running(const std::string& layer, const std::string& name, double seconds) const {
    if (shows_progress()) show_status(fmt::format("{}running {} {} ... {:.0f} s", prefix_, layer, name, seconds));
}

void DeviceOutput::finished(const Check& check) {
    std::string lines;
    if (soaks())
        lines = counts_.add(check, seconds_since(start_));
    else if (!is_quiet() || is_unwanted(check.verdict.outcome))
        lines = check_lines(check);
    if (!lines.empty()) print(prefix_ + lines);
}

void DeviceOutput::ended(const DeviceChecks& all) const {
    std::string lines;
    if (soaks()) lines = fmt::format("{}random checks with --seed {}\n", counts_.summary(), settings_.seed);
    if (!is_quiet() || device_count_ == 1 || !all.all_passed())
        lines += fmt::format("{}: {}\n", all.name, closing_text(all.checks, all.seconds));
    if (!lines.empty()) print(lines);
}

void print_device_totals(const std::vector<DeviceChecks>& device_checks) {
    std::vector<Check> checks;
    double seconds = 0;
    for (const DeviceChecks& device : device_checks) {
        checks.insert(checks.end(), device.checks.begin(), device.checks.end());
        seconds += device.seconds;
    }
    fmt::print("{}: {}\n", counted(device_checks.size(), "device"), closing_text(checks, seconds));
}

Json verify_report(const std::vector<DeviceChecks>& device_checks, const VerifySettings& settings) {
    Json devices = Json::array();
    for (const DeviceChecks& device : device_checks) devices.push_back(to_json(device));
    Json report = {{"kind", kVerifyReportKind}, {"program", name_and_version()}, {"depth", depth_name(settings.depth)}};
    if (!settings.as.empty()) report["as"] = settings.as;
    report["devices"] = devices;
    return report;
}

RenderCommand parse_render(const std::string& text) {
    std::vector<std::string> words;  // those with blanks are in quotes
    std::istringstream in(text);
    for (std::string word; in >> std::ws && !in.eof(); words.push_back(word))
        in >> std::quoted(word, in.peek() == '\'' ? '\'' : '"');
    if (!words.empty() && words.front() == "raya") words.erase(words.begin());
    if (words.empty() || words.front() != "render")
        throw UserError(fmt::format("--as \"{}\": must be a render, such as \"render scene.nff --lanes 8\"", text));
    CLI::App program("", "raya");
    program.formatter(std::make_shared<HelpFormatter>());
    const auto command = std::make_shared<RenderCommand>();
    CLI::App* const parser = declare_render_command(program, command);
    parser->get_option("--output")->required(false);
    add_verbosity_options(program, Ranks::single());
    try {
        parse_arguments(program, words);
        refuse_options_of_other_machines(*parser, machine_named(command->render.machine));
    } catch (const UserError& error) {
        throw UserError(fmt::format("--as: {}", error.what()));
    } catch (const CLI::ParseError&) {  // --help
        throw UserError("--as: must be a render without --help");
    }
    if (is_standard_stream(command->render.scene)) throw UserError("--as: the scene must be a file, not stdin");
    return *command;
}

RenderCase render_case(const std::string& text) {
    const RenderCommand command = parse_render(text);
    Scene scene = read_scene(command.render.scene, command.render.strict).scene;
    change_view(command.render.view, scene);
    const ImageSize size = image_size(command.render, scene);
    const auto settings = [command](const Scene& other, const ImageSize& other_size) -> RenderCase::Settings {
        RenderOptions options = command.render;
        options.size = fmt::format("{}x{}", other_size.width, other_size.height);
        if (machine_named(options.machine).kind == MachineKind::kTorus)
            return torus_settings(options, command.torus, other);
        return ring_settings_of(command, options, other);
    };
    return {std::move(scene), size, settings,
            std::shared_ptr<ScopedTunedSource>(new ScopedTunedSource(use_tuned(command.render.no_tuned)))};
}

}  // namespace raya
