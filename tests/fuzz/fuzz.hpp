// Checks and helpers of the fuzz targets.
#pragma once
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <string_view>

#include "host/base/child_process.hpp"

namespace raya::fuzz {

/// Prints a finding and aborts.
[[noreturn]] inline void report_finding(const char* finding, std::string_view detail) {
    std::fprintf(stderr, "finding: %s: %.*s\n", finding, static_cast<int>(detail.size()), detail.data());
    std::abort();
}

/// Requires that an error message has at most 2000 characters and contains the file's name, followed by a reason.
inline void check_refusal(std::string_view message, std::string_view file) {
    const std::size_t at = message.find(file);
    if (at == std::string_view::npos) report_finding("an error message without the file's name", message);
    if (message.size() < at + file.size() + 4) report_finding("an error message without a reason", message);
    constexpr std::size_t kMaxLength = 2000;  // a message must not repeat the whole input
    if (message.size() > kMaxLength) report_finding("an error message that is too long", message);
}

/// Calls check_refusal(). Also requires that a line number follows the file's name, as in "FILE:LINE" or "FILE, line
/// LINE".
inline void check_refusal_with_line(std::string_view message, std::string_view file) {
    check_refusal(message, file);
    std::string_view rest = message.substr(message.find(file) + file.size());
    constexpr std::string_view kLine = ", line ";
    rest.remove_prefix(rest.starts_with(kLine) ? kLine.size() : 1);
    const std::size_t end = rest.find_first_not_of("0123456789");
    if (end == 0 || end == std::string_view::npos || rest[0] == '0')
        report_finding("an error message without a line number", message);
}

/// A temporary folder in /dev/shm, for readers that take a file name.
class ScratchFolder {
  public:
    ScratchFolder() : folder_(set_tmpdir_and_get_prefix()) {}
    std::string path(const std::string& name) const { return (folder_ / name).string(); }
    /// Writes the file and returns its path.
    std::string write(const std::string& name, std::string_view bytes) const {
        std::ofstream file(path(name), std::ios::binary | std::ios::trunc);
        file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        if (!file.flush()) report_finding("the scratch file cannot be written", path(name));
        return path(name);
    }

  private:
    // Sets TMPDIR, unless it is set, to a file system in memory. Returns the prefix of the folder's name.
    static const char* set_tmpdir_and_get_prefix() {
        ::setenv("TMPDIR", "/dev/shm", 0);
        return "raya-fuzz";
    }
    TemporaryFolder folder_;
};

/// Returns the input of a fuzz target as text.
inline std::string_view text_of(const std::uint8_t* data, std::size_t size) {
    return {reinterpret_cast<const char*>(data), size};
}

}  // namespace raya::fuzz
