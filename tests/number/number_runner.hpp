// Builds operations.cl for a format, lanes and options, and runs its kernels on rows of operands.
#pragma once
#include <fmt/format.h>

#include <bit>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include "host/cl/commands.hpp"
#include "host/kernels/kernels.hpp"
#include "host/machine/number_format.hpp"
#include "tests/paths.h"

namespace raya {

/// Three operands a row, column by column. The number of rows is a multiple of kMostLanes, see pad().
struct Operands {
    std::vector<float> a, b, c;

    std::size_t rows() const { return a.size(); }
    void add(float x, float y, float z) {
        a.push_back(x);
        b.push_back(y);
        c.push_back(z);
    }

    static constexpr std::size_t kMostLanes = 16;
    /// Adds rows of ones until all widths of lanes take the same rows.
    void pad() {
        while (rows() % kMostLanes != 0) add(1, 1, 1);
    }
};

/// [result][row]: bits.
using Results = std::vector<std::vector<std::uint32_t>>;

/// Six of `operations`, in its order.
inline const std::vector<std::string>& operation_names() {
    static const std::vector<std::string> names = {"add", "sub", "mul", "div", "sqrt", "mad"};
    return names;
}

/// 16, or what RAYA_NUMBER_LANES says: some compilers take very long for wide kernels.
inline std::uint32_t widest_lanes() {
    const char* text = std::getenv("RAYA_NUMBER_LANES");
    return text == nullptr ? 16 : static_cast<std::uint32_t>(std::stoul(text));
}

/// One way to build the layer.
struct NumberBuild {
    NumberFormat format;
    std::uint32_t lanes = widest_lanes();
    bool refines_division = false;          // RAYA_EXACT_DIVIDE=0, on a device whose division and root err
    std::vector<SourcePatch> patches = {};  // of the layer

    std::string name() const {
        return fmt::format("{}, {} lanes{}", format_name(format), lanes, refines_division ? ", refined" : "");
    }
};

/// Rows of the random tests: RAYA_NUMBER_CASES, rounded up to a multiple of kMostLanes.
inline std::size_t number_cases(std::size_t usual) {
    const char* text = std::getenv("RAYA_NUMBER_CASES");
    const std::size_t wanted = text == nullptr ? usual : std::stoul(text);
    return (wanted + Operands::kMostLanes - 1) / Operands::kMostLanes * Operands::kMostLanes;
}

/// RAYA_NUMBER_CASES asks for more than the usual run.
inline bool is_long_run(std::size_t usual) { return number_cases(usual) > 2 * usual; }

class NumberRunner {
  public:
    explicit NumberRunner(const NumberBuild& build)
        : lanes_(build.lanes), session_(choose_device("")), program_(built(build)) {}

    const DeviceInfo& device() const { return session_.device(); }

    /// The `count` result columns of `kernel`.
    Results run(const std::string& kernel, const Operands& operands, std::size_t count) {
        const std::size_t rows = operands.rows();
        if (rows % Operands::kMostLanes != 0) throw std::invalid_argument("rows must be a multiple of the most lanes");
        auto from = session_.buffer<float>("operands", 3 * rows);
        auto to = session_.buffer<std::uint32_t>("results", count * rows);
        session_.write("a", from, operands.a);
        session_.write("b", from, operands.b, rows);
        session_.write("c", from, operands.c, 2 * rows);
        auto function = program_.kernel<const Buffer<float>&, cl_uint, Buffer<std::uint32_t>&>(kernel);
        session_.launch(kernel, function, rows / lanes_, 1, from, static_cast<cl_uint>(rows), to);
        Results results(count, std::vector<std::uint32_t>(rows));
        for (std::size_t k = 0; k < count; ++k) session_.read("results", to, results[k], k * rows);
        return results;
    }

  private:
    Program built(const NumberBuild& build) {
        std::ifstream in(RAYA_SOURCE_DIR "/tests/number/operations.cl", std::ios::binary);
        if (!in) throw std::runtime_error("no operations.cl");
        const KernelOptions options{
            .lanes = build.lanes, .format = build.format, .exact_divide = !build.refines_division};
        KernelSources sources{.patches = build.patches};
        if (build.refines_division) sources.more_options = {"-DRAYA_TEST_DEVICE_ERROR"};
        return Kernels(session_, options, sources)
            .build("tests/number/operations.cl", {std::istreambuf_iterator<char>(in), {}});
    }

    std::uint32_t lanes_;
    Session session_;
    Program program_;
};

}  // namespace raya
