// Tests a device for known defects of OpenCL implementations: runs a minimal kernel for each defect, and compares the
// result with the correct result and with known wrong results.
// Usage: defects [DEVICE [PLATFORM NAME]]
//   Prints a line for each run of a kernel of tests/portability: right, an expected failure with its reason, or WRONG.
//   The line also states if an expected failure no longer occurs. PLATFORM and NAME replace the names of the device, so
//   that a test can expect the failures of another device.
// Each kernel runs in its own process, because some kernels crash the compiler.
// Exit code: 0 if all results are right or expected, 1 if one is WRONG.
#include <fmt/core.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

#include "host/base/encoding.hpp"
#include "host/cl/commands.hpp"
#include "host/cl/kernel_source.hpp"
#include "host/verify/verify.hpp"
#include "tests/paths.h"

namespace {
using namespace raya;

constexpr cl_uint kAnyWrong = 0xffffffff;  // the wrong result differs from run to run

struct KnownFailure {
    // Part of the name of the platform, and patterns (id_matches()) of "DEVICE, driver VERSION", with --il followed by
    // ", SPIR-V", separated by |; empty: any.
    std::string platform, device;
    cl_uint wrong = 0;     // the wrong result of each work-item, or kAnyWrong
    bool crashes = false;  // true: a signal ends the process, without a result
    std::string reason;
};

// The structure argument of struct_argument.cl.
struct Sides {
    std::array<cl_uint, 3> side;
};

struct Defect {
    std::string name;          // name of the .cl file, without ".cl"
    cl_uint n = 0, right = 0;  // argument of the kernel, correct result of each work-item
    KnownFailure known{};      // without a reason: none
    std::string options{};     // for the compiler
    std::size_t group_size = 1;
};

const char *const kPocl = "Portable Computing Language", *const kMesa = "rusticl";

const std::vector<Defect> kDefects = {
    {"long_loop", 65'535, 65'535},
    {"long_loop",
     100'000,
     100'000,
     {kMesa, "llvmpipe", 65'535, false, "Mesa's llvmpipe ends every loop after 65,535 iterations"}},
    {"nested_loops", 200, 40'000},
    {"nested_loops",
     1'000,
     1'000'000,
     {kMesa, "llvmpipe", 65'405, false,
      "Mesa's llvmpipe counts the iterations of all loops of a work-item together and ends them after 65,535"}},
    {"struct_argument",
     20,
     20,
     {kMesa, "llvmpipe", 0, true,
      "Mesa's llvmpipe crashes on an array inside a structure that is a kernel's argument"}},
    {"struct_after_barrier",
     32,
     32,
     {kPocl, "driver 3.0", 5, false, "PoCL 3.0 takes a private structure of another work-item after a barrier"},
     "",
     32},
    {"wide_vector",
     20,
     40,
     {kPocl, "skylake-avx512*driver 7.1", 402, false,
      "PoCL 7.1 passes vectors of 512 bits to builtin functions in the registers of another calling convention"},
     "-cl-opt-disable"},
    {"widest_vector",
     21,
     21,
     {kPocl, "driver 6.0*SPIR-V", 0, false,
      "PoCL 6.0, for SPIR-V, passes vectors that are larger than a register in memory that it does not write"}},
    {"early_return",
     21,
     22,
     {kPocl, "driver 7.1*SPIR-V", 0, true,
      "PoCL 7.1 crashes while it compiles the SPIR-V of a private variable to which nothing is written"}},
    {"sign_bits",
     7,
     7,
     {kMesa, "llvmpipe (LLVM 19*", 0, true, "LLVM 19 divides by zero in ComputeNumSignBits() of llvmpipe's code"},
     "",
     2},
    {"fall_through",
     0,
     0x01010101,
     {kPocl, "driver 7.1", 0, true, "PoCL 7.1 aborts on a switch whose case has a loop and falls through to the next"}},
    {"loop_break",
     3,
     7,
     {kPocl, "driver 6.0|driver 7.1", 5, false,
      "PoCL 6.0 and 7.1 take the condition of the last work-item for all, in a loop in a loop before a barrier"},
     "",
     4},
    {"fixpoint",
     0,
     1,
     {kPocl, "driver 6.0", 0, true, "PoCL 6.0 aborts if InstCombine of LLVM needs a second iteration (pocl 1608)"},
     "",
     8},
    {"neighbour",
     7,
     7,
     {kPocl, "driver 7.1", 28, false, "PoCL 7.1 reads local memory again after a barrier, when it has changed"},
     "",
     4},
    {"narrow_switch",
     3,
     7,
     {"Oclgrind", "", 6, false, "Oclgrind 21.10 computes with integers of 2 bits as with 8 bits"}},
    {"largest_inverse",
     5,
     ~5U,
     {"Intel(R) OpenCL", "driver 2026", kAnyWrong, false,
      "Intel's CPU runtime makes another atomic operation of a local atomic_max() of an inverted number"}},
};

// Runs the kernel. Returns the first wrong result, or the correct one.
cl_uint run_kernel(const Defect& defect, Session& session) {
    std::ifstream file(RAYA_SOURCE_DIR "/tests/portability/" + defect.name + ".cl");
    const std::string source{std::istreambuf_iterator<char>(file), {}};
    Program program = session.build(defect.name + ".cl", source, {"-cl-std=CL1.2", defect.options});
    std::vector<cl_uint> results(defect.group_size, 0);
    Buffer<cl_uint> out = session.buffer<cl_uint>("out", results.size());
    session.write("clear", out, results);
    if (defect.name == "struct_argument") {
        auto kernel = program.kernel<Buffer<cl_uint>&, Sides>("defect");
        session.launch("defect", kernel, 1, defect.group_size, out, Sides{{10, 20, 30}});
    } else {
        auto kernel = program.kernel<Buffer<cl_uint>&, cl_uint>("defect");
        session.launch("defect", kernel, 1, defect.group_size, out, defect.n);
    }
    session.read("read", out, results);
    for (const cl_uint value : results)
        if (value != defect.right) return value;
    return defect.right;
}

std::string text_of(const Defect& defect) {
    return fmt::format("{}, n = {}, {} x {} work-items{}{}", defect.name, defect.n, 1, defect.group_size,
                       defect.options.empty() ? "" : ", ", defect.options);
}

// Returns true if the failure is known for this device.
bool occurs_on(const KnownFailure& known, const DeviceInfo& device) {
    const std::string text = device.name + ", driver " + device.driver + (uses_il() ? ", SPIR-V" : "");
    return !known.reason.empty() && device.platform.find(known.platform) != std::string::npos &&
           std::ranges::any_of(split(known.device, '|'), [&](const auto& p) { return id_matches(text, p); });
}

/// Prints the output line for a defect of `device`, the device of `session`; returns true if the result is right or an
/// expected failure.
bool report(const Defect& defect, Session& session, const DeviceInfo& device) {
    const cl_uint got = run_kernel(defect, session);
    const std::string description = text_of(defect);
    const KnownFailure& known = defect.known;
    const bool is_right = got == defect.right, is_known = occurs_on(known, device);
    const bool fails_as_known =
        is_known && !is_right && !known.crashes && (got == known.wrong || known.wrong == kAnyWrong);
    if (is_known && is_right)
        fmt::print("{}: right, {} was expected: {}\n", description,
                   known.crashes ? "a crash" : std::to_string(known.wrong), known.reason);
    else if (fails_as_known)
        fmt::print("{}: expected failure, {} instead of {}: {}\n", description, got, defect.right, known.reason);
    else
        fmt::print("{}: {}\n", description,
                   is_right ? "right" : fmt::format("WRONG: {} instead of {}", got, defect.right));
    return is_right || fails_as_known;
}

/// Prints the output line for a defect whose process a signal has ended; returns true if the crash is expected.
bool report_crash(const Defect& defect, int signal, const DeviceInfo& device) {
    const bool is_known = defect.known.crashes && occurs_on(defect.known, device);
    if (is_known)
        fmt::print("{}: expected failure, signal {} instead of {}: {}\n", text_of(defect), signal, defect.right,
                   defect.known.reason);
    else
        fmt::print("{}: WRONG: ended by signal {}\n", text_of(defect), signal);
    return is_known;
}

/// Runs `body`, which returns an exit code, in a child process; returns the status of waitpid(). The parent never uses
/// OpenCL, because drivers do not work after a fork.
int run_in_child(const std::function<int()>& body) {
    std::fflush(stdout);
    const pid_t child = ::fork();
    if (child == 0) {
        int code = 1;
        try {
            code = body();
        } catch (const std::exception& error) {
            fmt::print("{}\n", error.what());
        }
        std::fflush(stdout);
        ::_exit(code);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    return status;
}

bool succeeded(int status) { return WIFEXITED(status) && WEXITSTATUS(status) == 0; }

}  // namespace

int main(int argc, char** argv) {
    const std::string device = argc > 1 ? argv[1] : "";
    const auto info_of_device = [&] {
        DeviceInfo info = device_info(choose_device(device));
        if (argc > 3) info.platform = argv[2], info.name = argv[3];
        return info;
    };
    bool all_right = succeeded(run_in_child([&] {
        const DeviceInfo info = info_of_device();
        fmt::print("{}, {}, driver {}\n", info.platform, info.name, info.driver);
        return 0;
    }));
    if (!all_right) return 1;
    for (const Defect& defect : kDefects) {
        int status = run_in_child([&] {
            Session session(choose_device(device));
            return report(defect, session, info_of_device()) ? 0 : 1;
        });
        if (WIFSIGNALED(status))
            status = run_in_child(
                [&, signal = WTERMSIG(status)] { return report_crash(defect, signal, info_of_device()) ? 0 : 1; });
        all_right = succeeded(status) && all_right;
    }
    return all_right ? 0 : 1;
}
