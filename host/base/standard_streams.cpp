#include "host/base/standard_streams.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <system_error>
#include <utility>

#include "host/base/say.hpp"
#include "host/base/whole_file.hpp"
#include "host/error.hpp"

namespace raya {
namespace {

constexpr int kNone = -1;
constexpr int kGiven = -2;  // to who writes the file

int kept_stdout = kNone;  // a duplicate, since stdout itself has become stderr

}  // namespace

bool is_standard_stream(const std::filesystem::path& path) { return path.native() == "-"; }

std::string input_name(const std::filesystem::path& path) { return is_standard_stream(path) ? "stdin" : path.string(); }

std::string output_name(const std::filesystem::path& path) {
    return is_standard_stream(path) ? "stdout" : path.string();
}

int take_stdin() {
    static bool taken = false;
    if (std::exchange(taken, true))
        throw UnreadableFile("stdin can be read once, and was; give - once and name files for the rest");
    if (::isatty(STDIN_FILENO) != 0) say("raya: reads stdin, a terminal; Ctrl-D on a line of its own ends it\n");
    return STDIN_FILENO;
}

void keep_stdout_for_file() {
    if (kept_stdout != kNone) return;
    std::fflush(stdout);
    kept_stdout = ::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    if (kept_stdout < 0 || TEMP_FAILURE_RETRY(::dup2(STDERR_FILENO, STDOUT_FILENO)) < 0)
        throw UserError("cannot keep stdout for a file: " + std::generic_category().message(errno));
}

bool stdout_is_for_file() { return kept_stdout != kNone; }

int take_stdout() {
    keep_stdout_for_file();
    const int given = std::exchange(kept_stdout, kGiven);
    if (given == kGiven) throw UserError("only one file can go to stdout; name files for the others");
    return given;
}

void refuse_bytes_on_terminal(const std::filesystem::path& path) {
    if (!is_standard_stream(path) || ::isatty(stdout_is_for_file() ? kept_stdout : STDOUT_FILENO) == 0) return;
    throw UserError(
        "-: stdout is a terminal, and what would be written there is no text; send it into a file or a program (raya "
        "... | program)");
}

}  // namespace raya
