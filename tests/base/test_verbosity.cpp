// What is said at which level.
#include <fcntl.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <fstream>
#include <iterator>

#include "host/base/say.hpp"
#include "tests/base/scratch_folder.hpp"

namespace raya {
namespace {

/// What `action` says on stderr at that level.
template <class Action>
std::string said_at(int level, Action&& action) {
    const ScratchFolder folder;
    const std::string file = folder / "stderr";
    const int kept = ::dup(STDERR_FILENO), opened = ::open(file.c_str(), O_WRONLY | O_CREAT, 0600);
    ::dup2(opened, STDERR_FILENO);
    set_verbosity(level);
    action();
    set_verbosity(kUsual);
    ::dup2(kept, STDERR_FILENO);
    ::close(kept);
    ::close(opened);
    std::ifstream text(file);
    return {std::istreambuf_iterator<char>(text), {}};
}

TEST_CASE("what is told has raya's name in front of each line", "[verbosity]") {
    CHECK(said_at(kVerbose, [] { tell(kVerbose, "one"); }) == "raya: one\n");
    CHECK(said_at(kDetailed, [] { tell(kVerbose, "one\ntwo\n\nthree\n"); }) ==
          "raya: one\nraya: two\nraya: \nraya: three\n");
    CHECK(said_at(kDetailed, [] { tell(kDetailed, ""); }).empty());
    CHECK(said_at(kVerbose, [] { tell(kDetailed, "one"); }).empty());
    CHECK(said_at(kUsual, [] { tell(kVerbose, "one"); }).empty());
}

TEST_CASE("a warning is said at every level but the lowest", "[verbosity]") {
    for (const int level : {kQuiet, kUsual, kVerbose, kDetailed})
        CHECK(said_at(level, [] { warn("warning: it is late"); }) == "raya: warning: it is late\n");
    CHECK(said_at(kSilent, [] { warn("warning: it is late"); }).empty());
}

TEST_CASE("levels beyond the last are the last", "[verbosity]") {
    set_verbosity(-7);
    CHECK(verbosity() == kSilent);
    set_verbosity(7);
    CHECK(verbosity() == kDetailed);
    set_verbosity(kUsual);
}

}  // namespace
}  // namespace raya
