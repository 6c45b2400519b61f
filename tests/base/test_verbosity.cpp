// Messages at each level of verbosity.
#include <fcntl.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <fstream>
#include <iterator>

#include "host/base/log.hpp"
#include "tests/base/scratch_folder.hpp"

namespace raya {
namespace {

/// Returns the output of `action` on stderr at verbosity `level`.
template <class Action>
std::string output_at(int level, Action&& action) {
    const ScratchFolder folder;
    const std::string file = folder / "stderr";
    const int saved_stderr = ::dup(STDERR_FILENO), output_file = ::open(file.c_str(), O_WRONLY | O_CREAT, 0600);
    ::dup2(output_file, STDERR_FILENO);
    set_verbosity(level);
    action();
    set_verbosity(kDefaultVerbosity);
    ::dup2(saved_stderr, STDERR_FILENO);
    ::close(saved_stderr);
    ::close(output_file);
    std::ifstream text(file);
    return {std::istreambuf_iterator<char>(text), {}};
}

TEST_CASE("each line of a message starts with raya's name", "[verbosity]") {
    CHECK(output_at(kVerbose, [] { log_message(kVerbose, "one"); }) == "raya: one\n");
    CHECK(output_at(kDetailed, [] { log_message(kVerbose, "one\ntwo\n\nthree\n"); }) ==
          "raya: one\nraya: two\nraya: \nraya: three\n");
    CHECK(output_at(kDetailed, [] { log_message(kDetailed, ""); }).empty());
    CHECK(output_at(kVerbose, [] { log_message(kDetailed, "one"); }).empty());
    CHECK(output_at(kDefaultVerbosity, [] { log_message(kVerbose, "one"); }).empty());
}

TEST_CASE("a warning is printed at every level except the lowest", "[verbosity]") {
    for (const int level : {kQuiet, kDefaultVerbosity, kVerbose, kDetailed})
        CHECK(output_at(level, [] { warn("warning: it is late"); }) == "raya: warning: it is late\n");
    CHECK(output_at(kErrorsOnly, [] { warn("warning: it is late"); }).empty());
}

TEST_CASE("levels out of range are clamped", "[verbosity]") {
    set_verbosity(-7);
    CHECK(verbosity() == kErrorsOnly);
    set_verbosity(7);
    CHECK(verbosity() == kDetailed);
    set_verbosity(kDefaultVerbosity);
}

}  // namespace
}  // namespace raya
