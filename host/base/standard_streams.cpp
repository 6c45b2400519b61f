#include "host/base/standard_streams.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <system_error>
#include <utility>

#include "host/base/log.hpp"
#include "host/base/whole_file.hpp"
#include "host/error.hpp"

namespace raya {
namespace {

constexpr int kNotReserved = -1;
constexpr int kTaken = -2;  // take_stdout() has returned the descriptor

int reserved_stdout = kNotReserved;  // descriptor of a duplicate of stdout, or one of the two values above

}  // namespace

bool is_standard_stream(const std::filesystem::path& path) { return path.native() == "-"; }

std::string input_name(const std::filesystem::path& path) { return is_standard_stream(path) ? "stdin" : path.string(); }

std::string output_name(const std::filesystem::path& path) {
    return is_standard_stream(path) ? "stdout" : path.string();
}

int take_stdin() {
    static bool taken = false;
    if (std::exchange(taken, true))
        throw UnreadableFile("stdin can be read only once; give - once and name files for the other inputs");
    if (::isatty(STDIN_FILENO) != 0)
        print_log("raya: reading stdin from the terminal; end with Ctrl-D on a line of its own\n");
    return STDIN_FILENO;
}

void reserve_stdout() {
    if (reserved_stdout != kNotReserved) return;
    std::fflush(stdout);
    reserved_stdout = ::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    if (reserved_stdout < 0 || TEMP_FAILURE_RETRY(::dup2(STDERR_FILENO, STDOUT_FILENO)) < 0)
        throw UserError("cannot reserve stdout for a file: " + std::generic_category().message(errno));
}

void restore_stdout() {
    if (reserved_stdout >= 0) ::dup2(reserved_stdout, STDOUT_FILENO);
}

bool stdout_is_reserved() { return reserved_stdout != kNotReserved; }

int take_stdout() {
    reserve_stdout();
    const int descriptor = std::exchange(reserved_stdout, kTaken);
    if (descriptor == kTaken) throw UserError("only one file can go to stdout; name files for the other outputs");
    return descriptor;
}

void refuse_bytes_on_terminal(const std::filesystem::path& path) {
    if (!is_standard_stream(path) || ::isatty(stdout_is_reserved() ? reserved_stdout : STDOUT_FILENO) == 0) return;
    throw UserError(
        "-: stdout is a terminal and the output is binary; redirect it to a file or a program (raya ... | program)");
}

}  // namespace raya
