// Messages at each level of verbosity, and the progress of a command.
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cstdio>
#include <thread>

#include "host/base/log.hpp"

namespace raya {
namespace {

/// Returns the output of `action` on stderr at verbosity `level`.
template <class Action>
std::string output_at(int level, Action&& action) {
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::tmpfile(), &std::fclose);
    const int saved_stderr = ::dup(STDERR_FILENO);
    ::dup2(::fileno(file.get()), STDERR_FILENO);
    set_verbosity(level);
    action();
    set_verbosity(kDefaultVerbosity);
    ::dup2(saved_stderr, STDERR_FILENO);
    ::close(saved_stderr);
    std::string text(1000, ' ');
    std::rewind(file.get());
    text.resize(std::fread(text.data(), 1, text.size(), file.get()));
    return text;
}

TEST_CASE("messages are printed from their level on, with raya's name on each line", "[log]") {
    CHECK(output_at(kDetailed, [] { log_message(kVerbose, "one\ntwo\n\nthree\n"); }) ==
          "raya: one\nraya: two\nraya: \nraya: three\n");
    CHECK(output_at(kVerbose, [] { log_message(kDetailed, "one"); }).empty());
    CHECK(output_at(kQuiet, [] { warn("warning: it is late"); }) == "raya: warning: it is late\n");
    CHECK(output_at(kErrorsOnly, [] { warn("warning: it is late"); }).empty());
    CHECK(output_at(-7, [] { CHECK(verbosity() == kErrorsOnly); }).empty());
    CHECK(printable("a\x1b[2J\x7f\xc2\x9b\xc3\xa4\n\t") == "a\\x1b[2J\\x7f\\x9b\xc3\xa4\n\t");
}

TEST_CASE("a progress line has a bar and an estimate of the time left as soon as a part is done", "[log]") {
    CHECK(progress_line("building kernels", 0, 12.4) == "building kernels ... 12 s");
    CHECK(progress_line("rendering", 0.0009, 3) == "rendering ... 3 s");
    CHECK(progress_line("rendering", 0.25, 10) ==
          "[" + std::string(10, '#') + std::string(30, '.') + "]  25 %  30 s left");
    CHECK(progress_line("rendering", 1, 10) == "[" + std::string(40, '#') + "]  99 %  0 s left");
}

TEST_CASE("slow compiling prints its time", "[log]") {
    const std::string text = output_at(kDefaultVerbosity, [] {
        const std::jthread announcing = announce_compiling("toy");
        std::this_thread::sleep_for(std::chrono::milliseconds(1500));
    });
    CHECK_THAT(text, Catch::StartsWith("raya: compiling kernels for toy (first run only) ...\nraya: compiling kernels "
                                       "took 1."));
}

}  // namespace
}  // namespace raya
