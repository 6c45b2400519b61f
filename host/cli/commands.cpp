#include "host/cli/commands.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdio>
#include <new>
#include <string>
#include <system_error>
#include <vector>

#include "host/cl/driver_call.hpp"
#include "host/cli/parse_failure.hpp"
#include "host/error.hpp"
#include "host/files/interruption.hpp"
#include "host/files/say.hpp"

namespace raya {
namespace {

constexpr int kExitBug = 1;
constexpr int kExitCheckFailed = 4;

int fail(const std::string& text, int code) {
    say(fmt::format("raya: {}\n", text));
    return code;
}

/// The next files to be opened would be taken for those that are closed. Nothing can be written to a descriptor for
/// reading, so that what is lost on stdout is seen.
void open_standard_files() {
    for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        if (::fcntl(descriptor, F_GETFD) < 0 && ::open("/dev/null", O_RDONLY) < 0) return;
}

int parse_and_run(CLI::App& program, int argc, char** argv) {
    try {
        program.parse(argc, argv);
        return kExitOk;
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return program.exit(error);  // help, version
        return fail(parse_failure_text(program, error, {argv + 1, argv + argc}), kExitUserError);
    } catch (const UserError& error) {
        return fail(error.what(), kExitUserError);
    } catch (const DeviceError& error) {
        return fail(error.what(), kExitDeviceError);
    } catch (const CheckFailure& failure) {
        return failure.summary.empty() ? kExitCheckFailed : fail(failure.summary, kExitCheckFailed);
    } catch (const std::bad_alloc&) {
        return fail("out of memory on the host; remedy: fewer pixels, a smaller scene, or more memory", kExitUserError);
    } catch (const std::exception& error) {
        if (std::ferror(stdout) != 0) return kExitOk;  // it is what could not be printed
        return fail(std::string("internal error: ") + error.what(), kExitBug);
    }
}

/// `code`, unless a line that was printed is lost.
int printed(int code) {
    errno = 0;
    if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
    const std::string reason = errno != 0 ? ": " + std::generic_category().message(errno) : "";
    fail(fmt::format("cannot write to stdout{}; name a place with room for it", reason), kExitUserError);
    return code == kExitOk ? kExitUserError : code;
}

}  // namespace

int run_program(int argc, char** argv) {
    open_standard_files();
    end_cleanly_when_interrupted();
    explain_driver_crashes();
    CLI::App program{"raya traces rays on models of distributed-memory array machines, written as OpenCL kernels.",
                     "raya"};
    program.require_subcommand(1);
    program.set_version_flag("--version", "raya " RAYA_VERSION);
    program.footer(
        "Exit codes: 0 done, 2 bad option or input, 3 device or driver failure, 4 a check failed, 1 a fault of raya's "
        "own.");
    add_render_command(program);
    add_devices_command(program);
    add_generate_command(program);
    add_bench_command(program);
    add_study_command(program);
    add_verify_command(program);
    return printed(parse_and_run(program, argc, argv));
}

}  // namespace raya
