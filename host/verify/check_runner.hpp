// Runs the kernels of one program on buffers with given contents, and reads the results.
#pragma once
#include <cstdint>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "host/cl/commands.hpp"
#include "host/verify/verdict.hpp"

namespace raya {

/// Maximum number of lanes. A row is one set of operands, processed by one lane. Checks pad the rows to a multiple of
/// kMaxLanes, so that builds with any number of lanes test the same rows.
inline constexpr std::size_t kMaxLanes = 16;

/// A program with kernels of checks, and the session in which they run.
class CheckRunner {
  public:
    /// `lanes`: V, the number of lanes for which the program is built.
    CheckRunner(Session& session, Program program, std::uint32_t lanes = 1)
        : session_(session), program_(std::move(program)), lanes_(lanes) {}

    const std::string& options() const { return program_.options(); }

    template <class T>
    Buffer<T> filled(const std::string& name, const std::vector<T>& values) {
        Buffer<T> buffer = session_.buffer<T>(name, values.size());
        session_.write(name, buffer, values);
        return buffer;
    }

    /// Returns a buffer of `count` elements equal to `value`.
    template <class T>
    Buffer<T> constant(const std::string& name, std::size_t count, T value) {
        Buffer<T> buffer = session_.buffer<T>(name, count);
        session_.fill(name, buffer, value);
        return buffer;
    }

    /// Returns a result buffer filled with kPoison.
    Buffer<std::uint32_t> poisoned(const std::string& name, std::size_t count) {
        return constant(name, count, kPoison);
    }

    template <class T>
    std::vector<T> read(const Buffer<T>& buffer) {
        std::vector<T> values(buffer.size());
        session_.read(buffer.name(), buffer, values);
        return values;
    }

    template <class... Args>
    void run(const std::string& kernel, std::size_t groups, std::size_t group_size,
             std::type_identity_t<Args>... args) {
        auto function = program_.kernel<Args...>(kernel);
        session_.launch(kernel, function, groups, group_size, args...);
    }

    /// Launches a kernel on `rows` rows: `rows` / V work-groups of one work-item, each of which processes V rows.
    /// Throws std::invalid_argument unless `rows` is a multiple of kMaxLanes.
    template <class... Args>
    void run_rows(const std::string& kernel, std::size_t rows, std::type_identity_t<Args>... args) {
        if (rows % kMaxLanes != 0) throw std::invalid_argument("rows must be a multiple of kMaxLanes");
        run<Args...>(kernel, rows / lanes_, 1, args...);
    }

  private:
    Session& session_;
    Program program_;
    std::uint32_t lanes_;
};

}  // namespace raya
