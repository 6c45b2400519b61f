// render --checkpoint and --resume: resumed renders, and files that a checkpoint must not overwrite.
#include <filesystem>

#include "host/base/checkpoint.hpp"
#include "host/base/whole_file.hpp"
#include "tests/cli/refusals.hpp"
#include "tests/document.hpp"

namespace raya {
namespace {

namespace fs = std::filesystem;

Arguments render_arguments(const ScratchFolder& folder, const Arguments& extra_options = {}) {
    Arguments arguments = {"render",         scene_file("centre"), "--size",         "256", "--lanes", "1", "-o",
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

TEST_CASE("render --checkpoint, --resume: refuse missing, invalid and conflicting options", "[cli][checkpoint]") {
    const ScratchFolder folder;
    const auto refused = [&](const Arguments& extra_options, const Arguments& message) {
        check_refused(folder, render_arguments(folder, extra_options), 2, message);
    };
    refused({"--resume"}, {"--resume requires --checkpoint"});
    refused({"--checkpoint-every", "5"}, {"--checkpoint-every requires --checkpoint"});
    refused({"--checkpoint", "-"}, {"--checkpoint -"});
    refused({"--checkpoint", folder / "s.rst", "--checkpoint-every", "-1"}, {"--checkpoint-every -1", "0..86400"});
    refused({"--checkpoint", folder / "none/s.rst"}, {"none"});
    refused({"--checkpoint", folder / "x.pfm"}, {"--checkpoint", "the same file as --output"});
    for (const Arguments& records :
         {Arguments{"--packets", folder / "p.csv.gz"}, {"--async"}, {"--trace", folder / "t.json"}}) {
        Arguments torus = {"--checkpoint", folder / "s.rst", "--machine", "torus"};
        torus.insert(torus.end(), records.begin(), records.end());
        refused(torus, {"--checkpoint with --machine torus", records.front()});
    }
}

TEST_CASE("render --checkpoint: refuses a file that is not a checkpoint, and leaves it unchanged",
          "[cli][checkpoint]") {
    const ScratchFolder folder;
    const std::string file = folder / "s.rst";
    const auto refused = [&](const Arguments& extra_options, const std::string& message) {
        const std::string before = file_contents(file);
        const RunOutcome run = run_raya(render_arguments(folder, extra_options));
        INFO(run.describe());
        CHECK(run.code == 2);
        CHECK_THAT(run.err, Catch::Contains("--checkpoint " + file) && Catch::Contains(message));
        CHECK_THAT(run.err,
                   !Catch::Contains("remove"));  // the file may be a scene, so raya must not advise removing it
        CHECK(file_contents(file) == before);
        CHECK(folder.entries() == 1);
    };
    for (const std::string& content :
         {std::string("hours of work"), file_contents(scene_file("planes")), std::string()}) {
        write_whole_file(file, content);
        refused({"--checkpoint", file}, "is not a checkpoint; name another file");
        refused({"--checkpoint", file, "--resume"}, "is not a checkpoint; name another file");
    }
    write_whole_file(file, std::string(kStateMagic) + "hours of work");
    refused({"--checkpoint", file}, "add --resume");
}

}  // namespace
}  // namespace raya
