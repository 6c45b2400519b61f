// raya verify: checks a device, its driver and its compiler.
#include "host/cli/verify.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <future>
#include <iomanip>
#include <map>
#include <memory>
#include <sstream>

#include "host/base/log.hpp"
#include "host/base/whole_file.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/help.hpp"
#include "host/cli/options.hpp"
#include "host/cli/page.hpp"
#include "host/cli/parse.hpp"
#include "host/cli/render_command.hpp"
#include "host/error.hpp"
#include "host/model/number_format.hpp"
#include "host/verify/reproduce.hpp"
#include "host/verify/supervisor.hpp"
#include "host/verify/verify.hpp"
#include "host/version.hpp"

namespace raya {
namespace {

// A check that takes longer counts as hung: ten build budgets. A check builds at most six programs (test_verify.cpp),
// each within the budget; the rest is for its launches.
constexpr std::chrono::duration<double> kDefaultTimeout = 10 * kBuildBudget;
constexpr double kMaxTimeS = 1e6;

struct VerifyCommand {
    std::string device, report, page, junit, expect, reproduce, bisect, kernel_dir, only, skip, shard, as;
    std::uint32_t lanes = 0, repeat = 1;
    double timeout_s = kDefaultTimeout.count(), soak_s = 0;
    std::uint64_t seed = 1;
    std::uint32_t random = 0;
    bool brief = false, quick = false, full = false, list = false;

    Depth depth() const { return full ? Depth::kFull : brief ? Depth::kBrief : Depth::kQuick; }
};

/// Parses a command such as "render scene.nff --lanes 8"; "raya" may precede it. Quotes work as in a shell. Throws
/// UserError, with --as, if `raya render` would refuse the options.
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

// Sets the options that the render of --as has, too.
void take_render(VerifyCommand& command) {
    if (command.as.empty()) return;
    if (command.brief || command.quick || command.full || command.lanes != 0)
        throw UserError("--as with --brief, --quick, --full or --lanes: no effect; leave them out");
    const RenderOptions render = parse_render(command.as).render;
    read_scene(render.scene, render.strict);  // refuses outputs that would overwrite one of its files
    if (command.device.empty()) command.device = render.device;
    if (command.kernel_dir.empty()) command.kernel_dir = render.kernel_dir;
}

VerifySettings settings_of(const VerifyCommand& command) {
    VerifySettings settings{.depth = command.depth(),
                            .sources = {command.kernel_dir},
                            .only = command.bisect.empty() ? command.only : command.bisect,
                            .skip = command.skip,
                            .repeat = command.repeat,
                            .timeout_s = command.timeout_s,
                            .soak_s = command.soak_s,
                            .seed = command.seed,
                            .random = command.random,
                            .lanes = command.lanes,
                            .as = command.as};
    if (!command.shard.empty()) {
        const Shard shard = parse_shard(command.shard);
        settings.shard = shard.number, settings.shards = shard.count;
    }
    settings.expected_failures = read_expected_failures(command.expect);
    return settings;
}

void list_checks(const VerifyCommand& command, VerifySettings settings) {
    if (!command.as.empty()) settings.render = std::make_shared<RenderCase>(render_case(command.as));
    const bool all = command.device == "all";
    for (const cl::Device& device : all ? all_devices() : std::vector<cl::Device>{choose_device(command.device)})
        for (const std::string& name : check_names(device, settings))
            fmt::print("{}{}\n", all ? device_info(device).name + ": " : "", name);
}

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

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

// Prints the checks of one device. In a soak test (verify_at_random()), prints only failures, with all details only for
// the first failure of a check, and at the end how often each check failed.
class DeviceOutput {
  public:
    // `settings` must outlive this object. `index`: number of the device among those that --device selects.
    DeviceOutput(const VerifySettings& settings, std::size_t index) : settings_(settings), index_(index) {}

    // The callbacks of SupervisorSink.
    void device(const DeviceChecks& device, const std::vector<std::string>& unusable_devices, std::size_t devices) {
        device_count_ = devices;
        if (soaks() && devices > 1) prefix_ = device.name + ": ";
        if (is_quiet()) return;
        if (index_ == 0)
            for (const std::string& line : unusable_devices) print(line + "\n");
        print(fmt::format("{} ({}, driver {})\n", device.name, device.platform, device.driver));
    }
    void running(const std::string& layer, const std::string& name, double seconds) const {
        if (shows_progress()) show_status(fmt::format("{}running {} {} ... {:.0f} s", prefix_, layer, name, seconds));
    }
    void finished(const Check& check) {
        const bool unwanted = is_unwanted(check.verdict.outcome);
        const std::string lines = check_lines(check);
        if (soaks()) {
            auto& [runs, failures, first_s] = counts_[check.layer + " " + check.name];
            ++runs;
            if (!unwanted) return;
            const double seconds = seconds_since(start_);
            if (failures++ == 0) first_s = seconds;
            print(fmt::format("{}after {:.1f} s: {}", prefix_, seconds,
                              failures == 1 ? lines : first_line(lines) + "\n"));
        } else if (!is_quiet() || unwanted) {
            print(prefix_ + lines);
        }
    }

    // Prints the counts after the last check.
    void ended(const DeviceChecks& all) const {
        std::string lines;
        for (const auto& [name, count] : counts_)
            if (count.failures > 0)
                lines += fmt::format("{}: failed {} of {}, first after {:.1f} s\n", name, count.failures,
                                     counted(count.runs, "time"), count.first_s);
        if (soaks()) lines += fmt::format("random checks with --seed {}\n", settings_.seed);
        if (!is_quiet() || device_count_ == 1 || !all.all_passed())
            lines += fmt::format("{}: {}\n", all.name, closing_text(all.checks, all.seconds));
        if (!lines.empty()) print(lines);
    }

  private:
    struct Count {
        std::size_t runs = 0, failures = 0;
        double first_s = 0;  // time of the first failure
    };

    bool soaks() const { return settings_.soak_s > 0; }

    const VerifySettings& settings_;
    std::size_t index_ = 0, device_count_ = 1;
    Clock::time_point start_ = Clock::now();
    std::map<std::string, Count> counts_;  // by "LAYER NAME"
    std::string prefix_;                   // the device's name, if several soak tests run at once
};

void print_device_totals(const std::vector<DeviceChecks>& device_checks) {
    std::vector<Check> checks;
    double seconds = 0;
    for (const DeviceChecks& device : device_checks) {
        checks.insert(checks.end(), device.checks.begin(), device.checks.end());
        seconds += device.seconds;
    }
    fmt::print("{}: {}\n", counted(device_checks.size(), "device"), closing_text(checks, seconds));
}

// Verifies device number `index` of those that --device selects, and prints each check. Before the first check, calls
// `take_count` with the number of selected devices.
DeviceChecks verify_device(const VerifyCommand& command, std::size_t index, const VerifySettings& settings,
                           const std::function<void(std::size_t)>& take_count) {
    DeviceOutput output(settings, index);
    const SupervisorSink sink{
        .device =
            [&](const DeviceChecks& device, const std::vector<std::string>& unusable_devices, std::size_t devices) {
                output.device(device, unusable_devices, devices);
                take_count(devices);
            },
        .running = std::bind_front(&DeviceOutput::running, &output),
        .finished = std::bind_front(&DeviceOutput::finished, &output)};
    DeviceChecks result = supervise(command.device, index, settings, sink);
    output.ended(result);
    return result;
}

// Verifies the devices that --device selects: in a soak test all at once, otherwise one after another.
std::vector<DeviceChecks> verify_devices(const VerifyCommand& command, const VerifySettings& settings) {
    std::vector<std::future<DeviceChecks>> others;
    const auto add_others = [&](std::size_t devices) {
        const std::launch policy = settings.soak_s > 0 ? std::launch::async : std::launch::deferred;
        while (others.size() + 1 < devices)
            others.push_back(std::async(policy, [&command, &settings, index = others.size() + 1] {
                return verify_device(command, index, settings, [](std::size_t) {});
            }));
    };
    std::vector<DeviceChecks> all = {verify_device(command, 0, settings, add_others)};
    for (std::future<DeviceChecks>& other : others) all.push_back(other.get());
    return all;
}

// Bisects the first failure of the device and writes its case, if the options say so.
void analyse_first_failure(const VerifyCommand& command, const DeviceChecks& device, const VerifySettings& settings) {
    const auto check =
        std::ranges::find_if(device.checks, [](const Check& c) { return c.verdict.outcome == Outcome::kFail; });
    if (check == device.checks.end()) return;
    const std::string name = check->layer + " " + check->name;
    if (!command.bisect.empty())
        bisect(command.device, device, settings, name, [](const std::string& line) {
            fmt::print("{}\n", line);
            std::fflush(stdout);
        });
    if (!command.reproduce.empty()) try {
            fmt::print("{}", reproduce(command.device, device, settings, *check, command.reproduce));
        } catch (const UserError& error) {
            warn(error.what());
        }
    if (command.bisect.empty() && command.reproduce.empty() && !is_quiet())
        fmt::print(
            "--reproduce DIR writes the first failure as a C program, for a bug report; --bisect \"{}\" finds settings "
            "with which it passes\n",
            name);
}

void run_verify(VerifyCommand command) {
    take_render(command);
    if (command.brief + command.quick + command.full > 1) throw UserError("--brief, --quick, --full: give one of them");
    if (!command.page.empty()) check_page_name("--page", command.page);
    const VerifySettings settings = settings_of(command);
    if (command.list) return list_checks(command, settings);
    if (!command.reproduce.empty()) check_case_folder(command.reproduce);
    if ((!command.reproduce.empty() || !command.bisect.empty()) && (command.device == "all" || settings.soak_s > 0))
        throw UserError(
            "--reproduce, --bisect: not with --device all or --soak; remedy: repeat the failed check with "
            "--only, --lanes and --device");
    Warnings warnings;
    warn_of_build_options(warnings);
    const std::vector<DeviceChecks> device_checks = verify_devices(command, settings);
    if (device_checks.size() > 1) print_device_totals(device_checks);
    for (const std::string& text : unmatched_patterns(settings.expected_failures, device_checks))
        warn(text + "; raya verify --full --list prints the names of all checks");
    write_report_and_page({command.report, command.page},
                          to_json(VerifyReport{settings.depth, settings.as, device_checks}));
    if (!command.junit.empty()) write_whole_file(command.junit, junit_report("raya verify", device_checks));
    if (std::ranges::all_of(device_checks, &DeviceChecks::all_passed)) return;
    if (device_checks.size() == 1 && settings.soak_s == 0)
        analyse_first_failure(command, device_checks.front(), settings);
    throw CheckFailure{};
}

}  // namespace

void add_verify_command(CLI::App& program) {
    CLI::App* command = program.add_subcommand(
        "verify", "Check arithmetic, hits, machines and images of a device, its driver and its compiler bit for bit");
    add_examples(*command, {{"raya verify", "Run the default checks and print a line for each check"},
                            {"raya verify --brief --only number --report verify.json",
                             "Run only the brief checks of arithmetic, and write a report"}});
    const auto options = std::make_shared<VerifyCommand>();
    OptionGroup group(*command, "Checks");
    command->add_flag("--quick", options->quick,
                      "Check with the device's default lanes, common formats and images (the default depth)");
    command->add_flag("--brief", options->brief,
                      "Few kernels with few rays: for simulators, and for compilers that take a minute for a kernel");
    command->add_flag(
        "--full", options->full,
        "All formats, lanes and group sizes: about five minutes with PoCL on an idle CPU, longer if the compiler is "
        "slow on wide vectors");
    add_value(
        *command, "--lanes V", options->lanes,
        "Check only this number of lanes, for compilers that are slow on wide vectors; if not given: the device's "
        "default number of lanes, or with --full, every number of lanes")
        ->check(CLI::IsMember({1, 4, 8, 16}));
    add_value(*command, "--as \"render ...\"", options->as,
              "Check only what this render uses, such as \"render scene.nff --lanes 8 --accel bvh\": its format and "
              "lanes, its image, and reference images with its options");
    add_value(*command, "--only TEXT", options->only,
              "Run only checks whose printed \"LAYER NAME\" contains this text: number, \"image glass\", spa22, ...; * "
              "stands for any text");
    add_value(*command, "--skip TEXT", options->skip,
              "Run no check whose \"LAYER NAME\" contains this text, as for --only");
    command->add_flag("--list", options->list, "Print the names of the selected checks, and run none");
    in_range(add_value(*command, "--repeat N", options->repeat,
                       "Number of runs of each check; it fails if one of them fails"),
             1, 1e6);
    add_value(*command, "--shard I/N", options->shard,
              "Run the I-th of N parts of the selected checks, to divide them over N jobs");
    in_range(add_value(*command, "--timeout S", options->timeout_s,
                       "Seconds after which a check counts as failed and its process is ended, builds included; 0: "
                       "never"),
             0, kMaxTimeS, "seconds")
        ->capture_default_str();
    in_range(add_value(*command, "--soak TIME", options->soak_s,
                       "Run random checks with random numbers of lanes for this time, such as 60s, 30m, 2h; print only "
                       "failures"),
             0, kMaxTimeS, "seconds")
        ->transform(CLI::AsNumberWithUnit(std::map<std::string, double>{{"s", 1}, {"m", 60}, {"h", 3600}}));
    in_range(add_value(*command, "--random N", options->random,
                       "Run N random kernels, whose exact results raya computes on the host, instead of the checks"),
             1, 1e9);
    add_value(*command, "--seed N", options->seed,
              "Seed of --soak and --random: the same seed gives the same sequence of checks and kernels")
        ->default_str("1");
    add_file(
        *command, FileUse::kRead, "--expect FILE", options->expect,
        "Checks that are known to fail, one on each line: PATTERN | REASON | LINK, with a pattern as for --only. Their "
        "failures do not count; if one passes, the exit code is 4");
    add_device_option(*command, options->device);
    command->get_option("--device")
        ->description(command->get_option("--device")->get_description() +
                      "; all: every usable device, in turn or, with --soak, at once");
    group.next(kKernels);
    add_kernel_source_options(*command, options->kernel_dir);
    group.next(kDiagnostics);
    add_file(*command, FileUse::kWritten, "--report FILE.json", options->report,
             "Write all checks and their failures as JSON; -: stdout; the lines about the checks then go to stderr");
    add_file(*command, FileUse::kWritten, "--junit FILE.xml", options->junit, "Write the results as JUnit XML");
    add_file(
        *command, FileUse::kWrittenFolder, "--reproduce DIR", options->reproduce,
        "If a check fails: write the kernel launch that computes wrong words as a self-contained case, a C program "
        "with kernel, inputs and expected words, into this new folder");
    CLI::Option* const bisected =
        add_value(*command, "--bisect TEXT", options->bisect,
                  "Run the checks whose names contain this text, as --only; then find the smallest change of build "
                  "options, macros, lanes, groups or PoCL's variables with which the first that fails passes");
    bisected->excludes("--only");
    add_file(*command, FileUse::kWritten, "--page FILE.html", options->page,
             "Write all checks, and the first failure in full, as an HTML page; raya page makes the same page from a "
             "report");
    command->callback([options] { run_verify(*options); });
}

void members_of(Members& m, const VerifyReport& report) {
    m("kind", kVerifyReportKind, "Identifies the report: `raya verify`.");
    m("program", name_and_version(), "raya and its version.");
    m("depth", depth_name(report.depth), "Extent of the checks: `brief`, `quick` or `full`.");
    m.when(!report.as.empty(), "as", report.as, "The render of --as, if only its checks ran.");
    m("devices", report.devices, "Checked devices.");
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
