#include "host/cli/commands.hpp"

#include <cxxabi.h>
#include <fcntl.h>
#include <fmt/core.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <exception>
#include <new>
#include <string_view>
#include <system_error>
#include <typeinfo>

#include "host/base/child_process.hpp"
#include "host/base/encoding.hpp"
#include "host/base/interruption.hpp"
#include "host/base/whole_file.hpp"
#include "host/cl/driver.hpp"
#include "host/cli/help.hpp"
#include "host/cli/options.hpp"
#include "host/cli/page.hpp"
#include "host/cli/parse.hpp"
#include "host/cli/render_command.hpp"
#include "host/error.hpp"
#include "host/ranks/ranks.hpp"
#include "host/report/bench_report.hpp"
#include "host/report/scene_report.hpp"
#include "host/tune/store.hpp"
#include "host/tune/tune.hpp"
#include "host/verify/supervisor.hpp"
#include "host/version.hpp"

namespace raya {

namespace {

constexpr int kExitInternalError = 1;
constexpr int kExitCheckFailed = 4;

constexpr const char* kOutOfMemory =
    "out of memory on the host; remedy: fewer pixels, a smaller scene, or more memory (ulimit -v)";

/// Called by std::terminate(). Reports a std::bad_alloc that is thrown in a destructor, in a thread or before main(),
/// where no handler catches it.
[[noreturn]] void report_uncaught() {
    const std::type_info* const type = abi::__cxa_current_exception_type();
    if (type == nullptr || *type != typeid(std::bad_alloc)) __gnu_cxx::__verbose_terminate_handler();
    remove_file_in_progress();
    for (const std::string_view part : {"raya: ", kOutOfMemory, "\n"})
        if (::write(STDERR_FILENO, part.data(), part.size()) < 0) break;
    ::_exit(kExitUserError);
}

// Priority 101 runs this function before the constructors of CLI11's global objects, which allocate memory.
[[gnu::constructor(101)]] void install_terminate_handler() { std::set_terminate(report_uncaught); }

/// Opens /dev/null for closed standard descriptors, because the next open() would otherwise return them. Opens
/// /dev/null read-only, so that writing to a closed stdout still fails.
void open_standard_files() {
    for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        if (::fcntl(descriptor, F_GETFD) < 0 && ::open("/dev/null", O_RDONLY) < 0) return;
}

// Runs raya as a worker process. If the task fails, the last line of the worker's output contains the error.
int run_worker(const WorkerRequest& request) {
    const auto send_error = [&](const char* kind, const std::exception& error) {
        send_line(request.pipe, {{"error", error.what()}, {"kind", kind}});
        return kExitOk;
    };
    try {
        if (request.task == kTrialTask)
            run_trial(request.pipe, request.settings);
        else
            run_checks(request.pipe, request.settings);
        return kExitOk;
    } catch (const UserError& error) {
        return send_error("user", error);
    } catch (const DeviceError& error) {
        return send_error("device", error);
    } catch (const std::exception& error) {
        return send_error("internal", error);
    }
}

int parse_and_run(CLI::App& program, Ranks& ranks, int argc, char** argv) {
    try {
        if (ranks.has_several()) check_same_program(ranks, {argv + 1, argv + argc});
        parse_arguments(program, {argv + 1, argv + argc});
        return kExitOk;
    } catch (const CLI::ParseError& error) {
        return ranks.is_first() ? program.exit(error) : kExitOk;  // --help or --version, not an error
    } catch (const RankFailure& failure) {
        return ranks.fail(failure);
    } catch (const UserError& error) {
        return ranks.fail(error.what(), kExitUserError);
    } catch (const DeviceError& error) {
        return ranks.fail(error.what(), kExitDeviceError);
    } catch (const CheckFailure& failure) {
        return failure.summary.empty() ? kExitCheckFailed : ranks.fail(failure.summary, kExitCheckFailed);
    } catch (const std::bad_alloc&) {
        return ranks.fail(kOutOfMemory, kExitUserError);
    } catch (const std::exception& error) {
        const auto* const of_system = dynamic_cast<const std::system_error*>(&error);  // there can be no new thread
        if (of_system && of_system->code() == std::errc::resource_unavailable_try_again)
            return ranks.fail(kOutOfMemory, kExitUserError);
        if (std::ferror(stdout) != 0) return kExitOk;  // flush_stdout() reports the error
        return ranks.fail(std::string("internal error: ") + error.what(), kExitInternalError);
    }
}

/// Flushes stdout and returns `code`. If output is lost, reports this and returns kExitUserError instead of kExitOk.
int flush_stdout(Ranks& ranks, int code) {
    errno = 0;
    if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
    if (stdout_is_reserved()) return code;  // the text has gone to stderr, where lost text is not an error
    const std::string reason = errno != 0 ? ": " + std::generic_category().message(errno) : "";
    ranks.fail(fmt::format("cannot write to stdout{}; redirect it to a file system with free space", reason),
               kExitUserError);
    return code == kExitOk ? kExitUserError : code;
}

// Refuses several ranks for all commands except render, because the others would run once in every process.
void refuse_many_ranks(CLI::App& program, const Ranks& ranks) {
    if (!ranks.has_several()) return;
    for (CLI::App* command : program.get_subcommands({}))
        if (const std::string name = command->get_name(); name != "render")
            command->preparse_callback([name](std::size_t) {
                throw UserError(
                    fmt::format("{} runs in one process: only render supports several ranks; start it "
                                "without mpirun",
                                name));
            });
}

int run_with_ranks(Ranks& ranks, int argc, char** argv, const std::string& build) {
    const std::shared_ptr<CLI::App> program = make_program(ranks, build);
    refuse_many_ranks(*program, ranks);
    try {
        return ranks.close(flush_stdout(ranks, parse_and_run(*program, ranks, argc, argv)));
    } catch (const RankFailure& failure) {
        return ranks.fail(failure);
    }
}

// Reports an error that happens in every process before ranks exist. Only the first process prints the error.
int fail_at_start(const std::string& text, int code) {
    const std::optional<Launch> launch = find_launch();
    return !launch || launch->rank == 0 ? Ranks::single().fail(text, code) : code;
}

// Prints the JSON Schema of a kind of report. The build writes the schemas with this function.
int print_schema(const std::string& kind) {
    Json schema;
    if (kind == "render") schema = render_schema();
    if (kind == "explore") schema = explore_schema();
    if (kind == "bench")
        schema = schema_of<BenchReport>("raya bench --report",
                                        "Rates of kernels or, with `--variants`, of whole renders. `raya bench "
                                        "--compare` compares a later run with "
                                        "this report. `raya page` shows the report as a web page.");
    if (kind == "info")
        schema =
            schema_of<SceneReport>("raya info --json",
                                   "Contents of a scene, and the memory that it needs on each machine. `raya info` "
                                   "does not render and does not use a device.");
    if (kind == "verify")
        schema = schema_of<VerifyReport>("raya verify --report",
                                         "All checks of all devices, with details of failures (docs/verify.md). `raya "
                                         "page` shows the report as a web page.");
    if (kind == "tuned")
        schema = schema_of<TunedFile>(
            "raya/tuned-DEVICE.json",
            "Tuned values of a device, stored by `raya tune` in `$XDG_CACHE_HOME` or `~/.cache` (docs/tuning.md). "
            "Renders take their defaults from it. raya ignores a file whose format version, device, driver or version "
            "of raya differs.");
    fmt::print("{}\n", schema.dump(1));
    return schema.is_null() ? kExitUserError : kExitOk;
}

}  // namespace

std::shared_ptr<CLI::App> make_program(Ranks& ranks, const std::string& build) {
    auto owned_program = std::make_shared<CLI::App>(
        "A ray tracer on models of distributed-memory array machines, written as OpenCL kernels.", "raya");
    CLI::App& program = *owned_program;
    program.formatter(std::make_shared<HelpFormatter>());  // the commands inherit it
    add_examples(program, {{"raya render scenes/centre.nff -o centre.png",
                            "Render a scene on a ring of 256 PEs and print their load balance"},
                           {"raya render --help", "Print the help of render"}});
    program.require_subcommand(1);
    program
        .set_version_flag("--version", fmt::format("{} ({})", name_and_version(), build),
                          "Print version, commit and build")
        ->group(kGeneralOptions);
    add_render_command(program, ranks);
    add_explore_command(program);
    add_devices_command(program);
    add_machines_command(program);
    add_info_command(program);
    add_generate_command(program);
    add_bench_command(program);
    add_tune_command(program);
    add_study_command(program);
    add_page_command(program);
    add_verify_command(program);
    add_verbosity_options(program, ranks);
    // Runs before the command's callback. Only rank 0 checks files, because only rank 0 writes them.
    program.parse_complete_callback([&program, &ranks] {
        const CLI::App* command = &program;
        while (!command->get_subcommands().empty()) command = command->get_subcommands().front();
        if (ranks.is_first()) check_files(*command);
    });
    return owned_program;
}

int run_program(int argc, char** argv, const std::string& build) {
    open_standard_files();
    install_interrupt_handlers();
    // Only rank 0 reports a signal. Before MPI starts, because a signal may arrive while it starts.
    if (const std::optional<Launch> launch = find_launch(); launch && launch->rank != 0) suppress_interrupt_message();
    if (argc == 3 && argv[1] == std::string_view("__schema")) return print_schema(argv[2]);
    try {
        const auto request = worker_request(argc, argv);
        install_crash_handlers(request.has_value());  // the parent process reports a worker's crashes
        if (request) return run_worker(*request);
        const std::unique_ptr<Ranks> ranks = open_ranks();
        if (ranks)
            set_crash_prefix(fmt::format("rank {} on {}: ", ranks->rank(), ranks->host()),
                             failure_delay_s(ranks->rank()));
        return run_with_ranks(ranks ? *ranks : Ranks::single(), argc, argv, build);
    } catch (const UserError& error) {
        return fail_at_start(error.what(), kExitUserError);
    } catch (const DeviceError& error) {
        return fail_at_start(error.what(), kExitDeviceError);
    } catch (const RankFailure& failure) {
        return fail_at_start(failure.what(), failure.code);
    }
}

}  // namespace raya
