// Verdict of a check, details of a failure, and the text form of 32-bit words in the files of known answers and
// reference images.
#pragma once
#include <fmt/core.h>

#include <cstdint>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "host/cl/commands.hpp"

namespace raya {

enum class Outcome {
    kPass,
    kFail,
    kSkip,
    kExpectedFail,   // failed, as VerifySettings::expected_failures says
    kUnexpectedPass  // passed, although VerifySettings::expected_failures lists the check
};

/// Returns true for an outcome that causes exit code 4.
inline bool is_unwanted(Outcome outcome) { return outcome == Outcome::kFail || outcome == Outcome::kUnexpectedPass; }

/// Details of a failed check. Unknown members are empty.
struct Fault {
    std::string where{};                  // first wrong operation, ray, word or pixel
    std::string expected{}, got{};        // bits of the results, and their meaning
    std::string options{};                // build options of the kernel
    std::vector<std::string> remedies{};  // see remedies_of(); set by supervise()
};

/// Outcome of a check, and the explanation of the outcome.
struct Verdict {
    Outcome outcome = Outcome::kPass;
    std::string result;  // one line: what was compared, why the check was skipped, or what is wrong
    Fault fault{};       // empty unless the outcome is kFail
};

inline Verdict passed(std::string result) { return {Outcome::kPass, std::move(result)}; }
inline Verdict skipped(std::string reason) { return {Outcome::kSkip, std::move(reason)}; }
inline Verdict failed(std::string result, Fault fault) { return {Outcome::kFail, std::move(result), std::move(fault)}; }

/// Adds the kernel's build options to a failure; returns any other verdict unchanged.
inline Verdict with_options(Verdict verdict, const std::string& options) {
    if (verdict.outcome == Outcome::kFail) verdict.fault.options = options;
    return verdict;
}

/// Fill value of result buffers before a launch. No check expects this value. So a check of a kernel that writes
/// nothing fails, even if an earlier launch has left correct results in the same memory.
inline constexpr std::uint32_t kPoison = 0xdeadbeef;

/// Parses a word written as 8 hexadecimal digits without trailing zeros: "3f8" is 0x3f800000. Throws std::logic_error
/// for text that does not begin with such a digit.
inline std::uint32_t word_of(std::string digits) {
    digits.resize(8, '0');
    return static_cast<std::uint32_t>(std::stoul(digits, nullptr, 16));
}

// Runs the kernels of one program on buffers with given contents, and reads the results.

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
