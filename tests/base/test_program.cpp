// Another program: what goes in, what comes out, and how it ended.
#include <sys/stat.h>
#include <sys/wait.h>

#include <catch2/catch.hpp>
#include <cerrno>

#include "host/base/program.hpp"
#include "host/base/whole_file.hpp"
#include "tests/base/scratch_folder.hpp"

namespace raya {
namespace {

TEST_CASE("a program reads its input and tells what it prints, each stream apart", "[program]") {
    const std::string input(100'000, 'x');  // more than a pipe holds
    const ProgramRun run = run_program({"/bin/sh", "-c", "cat; echo said >&2"}, input + "\n");
    CHECK(run.succeeded());
    CHECK(run.out == input + "\n");
    CHECK(run.err == "said\n");
    CHECK(run_program({"cat"}).out.empty());  // found by PATH; nothing to read
    CHECK(run_program({"cat", "/dev/stdin"}, "by its name").out == "by its name");
}

TEST_CASE("no shell sees a program's arguments", "[program]") {
    const std::string hostile = "a b;'$(exit 3)\"*";
    CHECK(run_program({"printf", "%s|", hostile, ""}).out == hostile + "||");
}

TEST_CASE("how a program ended, or why it did not start", "[program]") {
    const ProgramRun failed = run_program({"/bin/sh", "-c", "exit 5"}),
                     killed = run_program({"/bin/sh", "-c", "kill -9 $$"});
    CHECK_FALSE(failed.succeeded());
    CHECK(ending_text(failed.status) == "exit code 5");
    CHECK_FALSE(killed.succeeded());
    CHECK(ending_text(killed.status) == "signal 9 (SIGKILL)");
    const ProgramRun none = run_program({"/nowhere/program"});
    CHECK_FALSE(none.succeeded());
    CHECK(none.not_started == ENOENT);
}

TEST_CASE("the last line that says something", "[program]") {
    CHECK(last_line("one\ntwo.\n\n .\n") == "two");
    CHECK(last_line("one") == "one");
    CHECK(last_line("one\r\n") == "one");
    CHECK(last_line(" \n.\n").empty());
    CHECK(last_line({}).empty());
    CHECK(last_line("a\n" + std::string(1000, 'x')) == std::string(300, 'x'));
}

TEST_CASE("a program beside this one is found there alone, and only if it can be run", "[program]") {
    CHECK(program_beside_this("test_base"));  // this one
    CHECK_FALSE(program_beside_this("sh"));
    CHECK_FALSE(program_beside_this("CMakeFiles"));  // a folder
    CHECK_FALSE(program_beside_this("CTestTestfile.cmake"));
}

}  // namespace
}  // namespace raya
