// Progress of a command on a terminal.
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cstdio>
#include <thread>

#include "host/base/log.hpp"

namespace raya {
namespace {

TEST_CASE("a stage of unknown length shows its time so far", "[progress]") {
    CHECK(progress_line("building kernels", {}, 0) == "building kernels ... 0 s");
    CHECK(progress_line("building kernels", {}, 12.4) == "building kernels ... 12 s");
    CHECK(progress_line("rendering", StageProgress{0.0009, 3}, 3) == "rendering ... 3 s");
}

TEST_CASE("a known fraction shows a bar and the estimated time left", "[progress]") {
    CHECK(progress_line("rendering", StageProgress{0.25, 10}, 10) ==
          "[" + std::string(10, '#') + std::string(30, '.') + "]  25 %  30 s left");
    CHECK(progress_line("rendering", StageProgress{0.001, 1}, 1) == "[" + std::string(40, '.') + "]   0 %  999 s left");
}

TEST_CASE("without a new fraction the time left counts down to 0, and then the time so far is shown", "[progress]") {
    const std::string quarter = "[" + std::string(10, '#') + std::string(30, '.') + "]  25 %  ";
    CHECK(progress_line("rendering", StageProgress{0.25, 10}, 25) == quarter + "15 s left");
    CHECK(progress_line("rendering", StageProgress{0.25, 10}, 60) == quarter + "60 s so far");
}

TEST_CASE("a running command shows at most 99 percent", "[progress]") {
    CHECK(progress_line("rendering", StageProgress{1, 10}, 10) == "[" + std::string(40, '#') + "]  99 %  10 s so far");
}

TEST_CASE("slow compiling prints its time and a remedy", "[progress]") {
    using namespace std::chrono_literals;
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::tmpfile(), &std::fclose);
    const int saved_stderr = ::dup(STDERR_FILENO);
    ::dup2(::fileno(file.get()), STDERR_FILENO);
    {
        const std::jthread announcing = announce_compiling("toy", 50ms);
        std::this_thread::sleep_for(1500ms);
    }
    ::dup2(saved_stderr, STDERR_FILENO);
    ::close(saved_stderr);
    std::string text(1000, ' ');
    std::rewind(file.get());
    text.resize(std::fread(text.data(), 1, text.size(), file.get()));
    CHECK_THAT(text,
               Catch::StartsWith("raya: compiling kernels for toy (first run only) ...\nraya: still compiling after "));
    CHECK_THAT(text,
               Catch::Contains("POCL_WORK_GROUP_METHOD=loops") && Catch::Contains("raya: compiling kernels took "));
}

TEST_CASE("a bar without a terminal is not active", "[progress]") {
    ProgressBar inactive(false, "reading");
    CHECK_FALSE(inactive.active());
    inactive.stage("rendering");
    inactive.update(0.5);
}

}  // namespace
}  // namespace raya
