// stdout and stderr that are closed or full: what is lost on stdout is exit code 2, what is lost on stderr is lost.
#include "tests/cli/refusals.hpp"
#include "tests/cli/run_program.hpp"

namespace raya {
namespace {

/// A run of raya by a shell, with `redirections` of it; its own exit code.
int code_of(const std::string& arguments, const std::string& redirections) {
    std::string command = RAYA_PROGRAM;
    command.append(" ").append(arguments).append(" ").append(redirections);
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

TEST_CASE("a line that is lost on stdout is exit code 2", "[cli]") {
    for (const char* arguments : {"--version", "--help", "devices", "verify --only 'machine bus' --lanes 4"}) {
        CAPTURE(arguments);
        CHECK(code_of(arguments, ">/dev/null 2>/dev/null") == 0);
        CHECK(code_of(arguments, ">/dev/full 2>/dev/null") == 2);
        CHECK(code_of(arguments, ">&- 2>/dev/null") == 2);
    }
    const ScratchFolder folder;
    const std::string told = folder / "told";
    CHECK(code_of("devices", ">/dev/full 2>" + told) == 2);
    CHECK(file_contents(told).starts_with("raya: cannot write to stdout: No space left on device"));
}

TEST_CASE("where stderr is closed or full, the exit code is as ever", "[cli]") {
    for (const char* lost : {"2>/dev/full", "2>&-"}) {
        CAPTURE(lost);
        CHECK(code_of("rendr", lost) == 2);
        CHECK(code_of("render none.nff -o x.pfm", lost) == 2);
        CHECK(code_of("devices --nonsense", lost) == 2);
        CHECK(code_of("--version", std::string(">/dev/null ") + lost) == 0);
    }
}

TEST_CASE("a file that is opened while stdout is closed does not get what is printed", "[cli]") {
    const ScratchFolder folder;
    const std::string image = folder / "x.pfm";
    CHECK(code_of("render " + scene_file("planes") + " --size 4 --pes 4 --lanes 4 -o " + image, ">&- 2>&-") == 2);
    CHECK(file_contents(image).size() == std::string("PF\n4 4\n-1.0\n").size() + 4 * 4 * 3 * 4);
}

}  // namespace
}  // namespace raya
