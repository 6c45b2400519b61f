#include "host/cli/commands.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <new>

#include "host/error.hpp"
#include "host/files/interruption.hpp"

namespace raya {
namespace {

constexpr int kExitBug = 1;
constexpr int kExitCheckFailed = 4;

int fail(const char* kind, const std::exception& error, int code) {
    fmt::print(stderr, "raya: {}{}\n", kind, error.what());
    return code;
}

}  // namespace

int run_program(int argc, char** argv) {
    end_cleanly_when_interrupted();
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
    try {
        program.parse(argc, argv);
        return kExitOk;
    } catch (const CLI::ParseError& error) {
        return program.exit(error) == 0 ? kExitOk : kExitUserError;
    } catch (const UserError& error) {
        return fail("", error, kExitUserError);
    } catch (const DeviceError& error) {
        return fail("", error, kExitDeviceError);
    } catch (const CheckFailure& failure) {
        if (!failure.summary.empty()) fmt::print(stderr, "raya: {}\n", failure.summary);
        return kExitCheckFailed;
    } catch (const std::bad_alloc&) {
        fmt::print(stderr, "raya: out of memory on the host; remedy: fewer pixels, a smaller scene, or more memory\n");
        return kExitUserError;
    } catch (const std::exception& error) {
        return fail("internal error: ", error, kExitBug);
    }
}

}  // namespace raya
