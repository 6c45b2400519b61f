// --keep and --resume: a render that was stopped goes on, and nothing that is kept is lost by mistake.
#include <filesystem>

#include "host/base/whole_file.hpp"
#include "tests/cli/refusals.hpp"
#include "tests/document.hpp"

namespace raya {
namespace {

namespace fs = std::filesystem;

Words render_of(const ScratchFolder& folder, const Words& more = {}) {
    Words words = {"render",         scene_file("centre"), "--size",         "256", "--lanes", "1", "-o",
                   folder / "x.pfm", "--report",           folder / "x.json"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

TEST_CASE("an interrupted render goes on, with the same picture", "[cli][keep]") {
    const ScratchFolder folder;
    REQUIRE(run_raya(render_of(folder)).code == 0);
    const std::string picture = file_contents(folder / "x.pfm");
    const Words keep = {"--keep", folder / "s.rst", "--keep-every", "0"};
    // Stopped later and later, until a state is there.
    bool interrupted = false;
    for (int ms = 40; ms <= 2000 && !interrupted; ms += ms / 2) {
        fs::remove(folder / "x.pfm");
        fs::remove(folder / "s.rst");
        Surroundings around;
        around.signal = SIGINT;
        around.signal_after_ms = ms;
        const RunOutcome run = run_raya(render_of(folder, keep), around);
        INFO(run.told());
        REQUIRE((run.code == 0 || run.code == 128 + SIGINT));
        if (run.code == 0) {
            CHECK_FALSE(fs::exists(folder / "s.rst"));
            CHECK((file_contents(folder / "x.pfm") == picture));
        }
        interrupted = run.code != 0 && fs::exists(folder / "s.rst");
    }
    REQUIRE(interrupted);
    Words resume = keep;
    resume.emplace_back("--resume");
    const RunOutcome run = run_raya(render_of(folder, resume));
    INFO(run.told());
    REQUIRE(run.code == 0);
    CHECK((file_contents(folder / "x.pfm") == picture));
    CHECK_FALSE(fs::exists(folder / "s.rst"));
    const Document report = Document::parse(file_contents(folder / "x.json"));
    CHECK_THAT(run.err, Catch::Contains("goes on at "));
    CHECK(report["measured"]["earlier_s"] < report["measured"]["render_s"]);
}

TEST_CASE("what cannot be kept or resumed is refused", "[cli][keep]") {
    const ScratchFolder folder;
    const auto refused = [&](const Words& more, const Words& message) {
        check_refused(folder, render_of(folder, more), 2, message);
    };
    refused({"--resume"}, {"--resume", "--keep FILE.rst"});
    refused({"--keep-every", "5"}, {"--keep-every", "--keep FILE.rst"});
    refused({"--keep", "-"}, {"--keep -"});
    refused({"--keep", folder / "s.rst", "--keep-every", "-1"}, {"--keep-every -1", "0..86400"});
    refused({"--keep", folder / "none/s.rst"}, {"none"});
    refused({"--keep", folder / "x.pfm"}, {"--keep", "the same file as --output"});
    refused({"--keep", folder / "s.rst", "--machine", "torus"}, {"--keep", "--machine torus", "grande"});
    refused({"--keep", folder / "s.rst", "--frames", "1:2", "--turn", "90"}, {"--keep", "one image"});
}

TEST_CASE("a file that is there is neither written over nor taken for a state", "[cli][keep]") {
    const ScratchFolder folder;
    const std::string file = folder / "s.rst";
    const auto refused = [&](const Words& more, const std::string& message) {
        const std::string before = file_contents(file);
        const RunOutcome run = run_raya(render_of(folder, more));
        INFO(run.told());
        CHECK(run.code == 2);
        CHECK_THAT(run.err, Catch::Contains("--keep " + file) && Catch::Contains(message));
        CHECK_THAT(run.err, !Catch::Contains("remove"));  // a scene is not to be deleted
        CHECK(file_contents(file) == before);
        CHECK(folder.entries() == 1);
    };
    for (const std::string& content :
         {std::string("hours of work"), file_contents(scene_file("planes")), std::string()}) {
        write_whole_file(file, content);
        refused({"--keep", file}, "is not a checkpoint; name another file");
        refused({"--keep", file, "--resume"}, "is not a checkpoint; name another file");
    }
    write_whole_file(file, "raya state 2\nhours of work");
    refused({"--keep", file}, "give --resume");
}

}  // namespace
}  // namespace raya
