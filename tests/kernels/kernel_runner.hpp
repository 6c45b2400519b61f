// Builds and runs test kernels for several numbers of lanes, with and without compiler optimisation.
#pragma once
#include <fmt/core.h>

#include <cstdint>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include "host/cl/commands.hpp"
#include "host/cl/kernel_options.hpp"
#include "host/verify/verdict.hpp"
#include "tests/paths.h"

namespace raya {

/// A base class of KernelRunner that owns the session, so that the session exists before CheckRunner uses it.
struct SessionOwner {
    Session session{choose_device("")};
};

/// Build options of a kernel. All builds with the same format and no patches must give the same bits.
struct TestBuild {
    std::uint32_t lanes = 1;
    bool optimised = true;
    NumberFormat format{};
    std::vector<SourcePatch> patches{};
    std::vector<std::string> more_options{};

    std::string name() const {
        return fmt::format("{} {} lanes{}", format_name(format), lanes, optimised ? "" : ", -cl-opt-disable");
    }
};

/// Builds in fp32, with and without optimisation. Tests compare all results with the first.
inline const std::vector<TestBuild>& test_builds() {
    static const std::vector<TestBuild> all = {{1, true}, {4, true}, {16, true}, {1, false}};
    return all;
}

/// Builds and runs a file of test kernels on the default device.
class KernelRunner : private SessionOwner, public CheckRunner {
  public:
    /// Builds `file`, a path relative to the project's root. Throws std::runtime_error if the file is missing,
    /// DeviceError if the build fails.
    KernelRunner(const std::string& file, const TestBuild& test_build)
        : CheckRunner(session, build(session, file, test_build), test_build.lanes) {}

  private:
    static Program build(Session& session, const std::string& file, const TestBuild& test_build) {
        std::ifstream in(RAYA_SOURCE_DIR "/" + file, std::ios::binary);
        if (!in) throw std::runtime_error("test kernel " + file + " is missing");
        KernelOptions options;
        options.lanes = test_build.lanes;
        options.format = test_build.format;
        options.words_local = false;  // test kernels take the job's words in global memory
        KernelSources sources;
        sources.patches = test_build.patches;
        sources.more_options = test_build.more_options;
        if (!test_build.optimised) sources.more_options.emplace_back("-cl-opt-disable");
        const Kernels kernels(session, options, sources);
        // A kernel of the checks is built as raya verify builds it, so that the driver's cache has it.
        if (file.starts_with("kernels/")) return kernels.program(file.substr(8));
        return kernels.build(file, {std::istreambuf_iterator<char>(in), {}});
    }
};

}  // namespace raya
