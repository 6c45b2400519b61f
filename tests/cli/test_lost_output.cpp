// Closed and full stdout and stderr: if output on stdout is lost, the exit code is 2; lost output on stderr is ignored.
#include "tests/cli/refusals.hpp"
#include "tests/cli/run_program.hpp"

namespace raya {
namespace {

/// Runs raya in a shell with these redirections and returns its exit code.
int code_of(const std::string& arguments, const std::string& redirections) {
    std::string command = "'" RAYA_PROGRAM "'";
    command.append(" ").append(arguments).append(" ").append(redirections);
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

TEST_CASE("stdout: a lost line causes exit code 2", "[cli]") {
    for (const char* arguments : {"--version", "--help", "devices", "verify --only 'machine bus' --lanes 4"}) {
        CAPTURE(arguments);
        CHECK(code_of(arguments, ">/dev/null 2>/dev/null") == 0);
        CHECK(code_of(arguments, ">/dev/full 2>/dev/null") == 2);
        CHECK(code_of(arguments, ">&- 2>/dev/null") == 2);
    }
    const ScratchFolder folder;
    const std::string errors = folder / "errors";
    CHECK(code_of("devices", ">/dev/full 2>" + errors) == 2);
    CHECK(file_contents(errors).starts_with("raya: cannot write to stdout: No space left on device"));
}

TEST_CASE("stderr: if it is closed or full, the exit code does not change", "[cli]") {
    for (const char* redirection : {"2>/dev/full", "2>&-"}) {
        CAPTURE(redirection);
        CHECK(code_of("rendr", redirection) == 2);
        CHECK(code_of("render none.nff -o x.pfm", redirection) == 2);
        CHECK(code_of("devices --nonsense", redirection) == 2);
        CHECK(code_of("--version", std::string(">/dev/null ") + redirection) == 0);
    }
}

TEST_CASE("stdout: if it is closed, output does not go into a file that raya opens", "[cli]") {
    const ScratchFolder folder;
    const std::string image = folder / "x.pfm";
    CHECK(code_of("render '" + scene_file("planes") + "' --size 4 --pes 4 --lanes 4 -o " + image, ">&- 2>&-") == 2);
    CHECK(file_contents(image).size() == std::string("PF\n4 4\n-1.0\n").size() + 4 * 4 * 3 * 4);
}

}  // namespace
}  // namespace raya
