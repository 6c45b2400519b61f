// render --checkpoint and --resume: a resumed render.
#include <filesystem>

#include "host/base/checkpoint.hpp"
#include "host/base/whole_file.hpp"
#include "tests/cli/refusals.hpp"
#include "tests/document.hpp"

namespace raya {
namespace {

namespace fs = std::filesystem;

Arguments render_arguments(const ScratchFolder& folder, const Arguments& extra_options = {}) {
    Arguments arguments = {"render",         scene_file("centre"), "--size",         "512", "--lanes", "4", "-o",
                           folder / "x.pfm", "--report",           folder / "x.json"};
    arguments.insert(arguments.end(), extra_options.begin(), extra_options.end());
    return arguments;
}

TEST_CASE("render --checkpoint: a resumed render writes the same image file as a single run", "[cli][checkpoint]") {
    const ScratchFolder folder;
    REQUIRE(run_raya(render_arguments(folder)).code == 0);
    const std::string image_bytes = file_contents(folder / "x.pfm");
    const Arguments checkpoint = {"--checkpoint", folder / "s.rst", "--checkpoint-every", "0"};
    // Interrupts the render, each time after a longer delay, until a checkpoint exists.
    bool interrupted = false;
    for (int ms = 40; ms <= 2000 && !interrupted; ms += ms / 2) {
        fs::remove(folder / "x.pfm");
        fs::remove(folder / "s.rst");
        RunOptions run_options;
        run_options.signal = SIGINT;
        run_options.signal_after_ms = ms;
        const RunOutcome run = run_raya(render_arguments(folder, checkpoint), run_options);
        INFO(run.describe());
        REQUIRE((run.code == 0 || run.code == 128 + SIGINT));
        if (run.code == 0) {
            CHECK_FALSE(fs::exists(folder / "s.rst"));
            CHECK((file_contents(folder / "x.pfm") == image_bytes));
        }
        interrupted = run.code != 0 && fs::exists(folder / "s.rst");
    }
    REQUIRE(interrupted);
    Arguments resume = checkpoint;
    resume.emplace_back("--resume");
    const RunOutcome run = run_raya(render_arguments(folder, resume));
    INFO(run.describe());
    REQUIRE(run.code == 0);
    CHECK((file_contents(folder / "x.pfm") == image_bytes));
    CHECK_FALSE(fs::exists(folder / "s.rst"));
    const Document report = Document::parse(file_contents(folder / "x.json"));
    CHECK_THAT(run.err, Catch::Contains("continuing at "));
    CHECK(report["measured"]["earlier_s"] < report["measured"]["render_s"]);
}

}  // namespace
}  // namespace raya
