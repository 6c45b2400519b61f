// What OpenCL implementations do wrong, each as the smallest kernel that shows it: run on one device and compared with
// what is right and with what is known to be wrong there.
//   defects [DEVICE]     a line for each kernel of tests/portability: right, an expected failure with its reason, or
//   WRONG
// Exit code 0 where all is right or as expected, 1 where something is WRONG. An expected failure that is right by now
// is said.
#include <fmt/core.h>

#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "cl/commands.hpp"

namespace {
using namespace raya;

struct KnownFailure {
    std::string platform, device;  // parts of their names; empty: any
    cl_uint wrong = 0;             // what each work-item gives there
    std::string reason;
};

struct Defect {
    std::string name;  // of the .cl file
    cl_uint n = 0;
    std::size_t groups = 1, group_size = 1;
    cl_uint right = 0;  // what each work-item must give
    std::vector<KnownFailure> known;
};

const std::vector<Defect> kDefects = {
    {"long_loop", 65'535, 1, 1, 65'535, {}},
    {"long_loop",
     100'000,
     1,
     1,
     100'000,
     {{"rusticl", "llvmpipe", 65'535, "Mesa's llvmpipe ends every loop after 65,535 turns"}}},
    {"nested_loops", 200, 1, 1, 40'000, {}},
    {"nested_loops",
     1'000,
     1,
     1,
     1'000'000,
     {{"rusticl", "llvmpipe", 65'405,
       "Mesa's llvmpipe counts the turns of all loops of a work-item together and ends them after 65,535"}}},
};

cl_uint answer(const Defect& defect, Session& session, std::vector<cl_uint>& all) {
    std::ifstream file(RAYA_SOURCE_DIR "/tests/portability/" + defect.name + ".cl");
    const std::string source{std::istreambuf_iterator<char>(file), {}};
    Program program = session.build(defect.name + ".cl", source, {"-cl-std=CL1.2"});
    auto kernel = program.kernel<Buffer<cl_uint>&, cl_uint>("defect");
    all.assign(defect.groups * defect.group_size, 0);
    Buffer<cl_uint> out = session.buffer<cl_uint>("out", all.size());
    session.write("clear", out, all);
    session.launch("defect", kernel, defect.groups, defect.group_size, out, defect.n);
    session.read("read", out, all);
    for (const cl_uint value : all)
        if (value != defect.right) return value;
    return defect.right;
}

/// The line on one defect; true: right or expected.
bool report(const Defect& defect, Session& session) {
    const DeviceInfo& device = session.device();
    std::vector<cl_uint> all;
    const cl_uint got = answer(defect, session, all);
    const std::string what =
        fmt::format("{}, n = {}, {} x {} work-items", defect.name, defect.n, defect.groups, defect.group_size);
    for (const KnownFailure& known : defect.known) {
        if (device.platform.find(known.platform) == std::string::npos ||
            device.name.find(known.device) == std::string::npos)
            continue;
        if (got == defect.right) {
            fmt::print("{}: right by now, {} was expected: {}\n", what, known.wrong, known.reason);
            return true;
        }
        if (got != known.wrong) break;
        fmt::print("{}: expected failure, {} in place of {}: {}\n", what, got, defect.right, known.reason);
        return true;
    }
    fmt::print("{}: {}\n", what,
               got == defect.right ? "right" : fmt::format("WRONG: {} in place of {}", got, defect.right));
    return got == defect.right;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        Session session(choose_device(argc > 1 ? argv[1] : ""));
        fmt::print("{}, {}, driver {}\n", session.device().platform, session.device().name, session.device().driver);
        bool good = true;
        for (const Defect& defect : kDefects) good = report(defect, session) && good;
        return good ? 0 : 1;
    } catch (const std::exception& error) {
        fmt::print("{}\n", error.what());
        return 1;
    }
}
