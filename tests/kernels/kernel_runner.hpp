// Builds test kernels for all numbers of lanes, with and without the compiler's optimiser.
#pragma once
#include <fmt/core.h>

#include <cstdint>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include "host/cl/commands.hpp"
#include "host/cl/kernels.hpp"
#include "host/verify/check_runner.hpp"
#include "tests/paths.h"

namespace raya {

/// A base class that makes the session before other bases use it.
struct OwnSession {
    Session session{choose_device("")};
};

/// A variant of a kernel's build. All variants of a format must give the same bits.
struct Variant {
    std::uint32_t lanes = 1;
    bool optimised = true;
    NumberFormat format{};
    std::vector<SourcePatch> patches{};
    std::vector<std::string> more_options{};

    std::string name() const {
        return fmt::format("{} {} lanes{}", format_name(format), lanes, optimised ? "" : ", -cl-opt-disable");
    }
};

/// All variants in fp32; the others are compared with the first.
inline const std::vector<Variant>& variants() {
    static const std::vector<Variant> all = {{1, true},  {4, true},  {8, true},  {16, true},
                                             {1, false}, {4, false}, {8, false}, {16, false}};
    return all;
}

/// Builds and runs a file of test kernels on the default device.
class KernelRunner : private OwnSession, public CheckRunner {
  public:
    /// Builds a file, a path from the project's root. Throws std::runtime_error if it is missing, DeviceError if it
    /// does not build.
    KernelRunner(const std::string& file, const Variant& variant)
        : CheckRunner(session, build(session, file, variant), variant.lanes) {}

  private:
    static Program build(Session& session, const std::string& file, const Variant& variant) {
        std::ifstream in(RAYA_SOURCE_DIR "/" + file, std::ios::binary);
        if (!in) throw std::runtime_error("no test kernel " + file);
        KernelOptions options;
        options.lanes = variant.lanes;
        options.format = variant.format;
        options.words_local = false;  // the probes pass the job's words in global memory
        KernelSources sources;
        sources.patches = variant.patches;
        sources.more_options = variant.more_options;
        if (!variant.optimised) sources.more_options.emplace_back("-cl-opt-disable");
        return Kernels(session, options, sources).build(file, {std::istreambuf_iterator<char>(in), {}});
    }
};

}  // namespace raya
