// Builds the test kernels of this folder for every width of lanes, with and without the compiler's optimiser.
#pragma once
#include <fmt/format.h>

#include <cstdint>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "host/cl/commands.hpp"
#include "host/kernels/kernels.hpp"
#include "tests/paths.h"

namespace raya {

/// One way to build a kernel. All ways must give the same bits.
struct Variant {
    std::uint32_t lanes = 1;
    bool optimised = true;
    NumberFormat format{};

    std::string name() const {
        return fmt::format("{} {} lanes{}", format_name(format), lanes, optimised ? "" : ", -cl-opt-disable");
    }
};

/// The first is the one that the others are compared with.
inline const std::vector<Variant>& variants() {
    static const std::vector<Variant> all = {{1, true},  {4, true},  {8, true},  {16, true},
                                             {1, false}, {4, false}, {8, false}, {16, false}};
    return all;
}

/// Rows of every test are a multiple of this, so that all widths take the same rows.
inline constexpr std::size_t kMostLanes = 16;

class KernelRunner {
  public:
    /// Builds a file, given from tests/kernels/ on. Throws std::runtime_error where it is missing, DeviceError where it
    /// does not build.
    KernelRunner(const std::string& file, const Variant& variant)
        : lanes_(variant.lanes), session_(choose_device("")), program_(build(file, variant)) {}

    /// A buffer that holds `values`.
    template <class T>
    Buffer<T> filled(const std::string& name, const std::vector<T>& values) {
        Buffer<T> buffer = session_.buffer<T>(name, values.size());
        session_.write(name, buffer, values);
        return buffer;
    }

    /// A buffer of `size` elements that are all `value`.
    template <class T>
    Buffer<T> constant(const std::string& name, std::size_t size, T value) {
        Buffer<T> buffer = session_.buffer<T>(name, size);
        session_.fill(name, buffer, value);
        return buffer;
    }

    template <class T>
    std::vector<T> read(const Buffer<T>& buffer) {
        std::vector<T> values(buffer.size());
        session_.read(buffer.name(), buffer, values);
        return values;
    }

    /// Runs a kernel that takes V rows of `rows` in each work-group of one work-item.
    template <class... Args>
    void run(const std::string& kernel_name, std::size_t rows, std::type_identity_t<Args>... args) {
        if (rows % kMostLanes != 0) throw std::invalid_argument("rows must be a multiple of the widest lanes");
        auto kernel = program_.kernel<Args...>(kernel_name);
        session_.launch(kernel_name, kernel, rows / lanes_, 1, args...);
    }

  private:
    static std::string text_of(const std::string& file) {
        std::ifstream in(RAYA_SOURCE_DIR "/tests/kernels/" + file, std::ios::binary);
        if (!in) throw std::runtime_error("no test kernel " + file);
        return {std::istreambuf_iterator<char>(in), {}};
    }

    Program build(const std::string& file, const Variant& variant) {
        KernelOptions options;
        options.lanes = variant.lanes;
        options.format = variant.format;
        options.words_local = false;  // where the words lie is the ring's business, not that of the pieces
        KernelSources sources;
        if (!variant.optimised) sources.more_options = {"-cl-opt-disable"};
        return Kernels(session_, options, sources).build("tests/kernels/" + file, text_of("lanes.clh") + text_of(file));
    }

    std::uint32_t lanes_;
    Session session_;
    Program program_;
};

}  // namespace raya
