// raya study: the files that the studies of tools/lab write, and refused options.
#include <sys/stat.h>

#include <filesystem>
#include <set>

#include "host/version.hpp"
#include "tests/cli/device_with_fault.hpp"
#include "tests/cli/refusals.hpp"
#include "tests/document.hpp"
#include "tests/paths.h"
#include "tests/thorough.hpp"

#if RAYA_STUDIES
namespace raya {
namespace {

using Files = std::set<std::string>;

Files files_in(const std::filesystem::path& folder) {
    Files files;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) files.insert(entry.path().filename());
    return files;
}

Arguments study_arguments(const std::string& name, const ScratchFolder& outputs, const Arguments& options = {}) {
    Arguments arguments = {"study", name, "-o", outputs / "made/x"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return arguments;
}

TEST_CASE("study: writes figures, tables, JSON and a document", "[cli]") {
    const ScratchFolder outputs;
    const RunOutcome run = run_raya(study_arguments("fig8", outputs, {"--size", "32"}));
    INFO(run.describe());
    REQUIRE(run.code == 0);
    CHECK(run.err.empty());
    for (const char* part : {"u(0)", "u(8)", "u(16)", "p with the lowest u, of all 32", "fig8.md"})
        CHECK_THAT(run.out, Catch::Contains(part));
    const std::filesystem::path folder = outputs / "made/x";
    CHECK(files_in(folder) == Files{"fig8-all.png", "fig8-all.svg", "fig8-families.csv", "fig8-near.csv", "fig8.csv",
                                    "fig8.json", "fig8.md", "fig8.png", "fig8.svg", "index.html", "manifest.json"});
    const auto json = Document::parse(file_contents(folder / "fig8.json"));
    CHECK(json["study"] == "fig8");
    for (const auto& [key, value] :
         {std::pair<const char*, Document>{"scene", "centre"}, {"size", 32}, {"pes", 32}, {"pictures", 108}})
        CHECK(json["settings"][key] == value);
    CHECK(json["tables"][1]["name"] == "fig8");
    CHECK(json["tables"][1]["rows"].size() == 32);
    CHECK(json["tables"][1]["rows"][31][0] == 31);
    CHECK(json["run"]["command"] == "raya study fig8 --size 32 -o DIR");
    CHECK(json["run"]["version"] == std::string("raya ") + raya_version());
    CHECK_FALSE(json["run"]["device"].get<std::string>().empty());
    const std::string document = file_contents(folder / "index.html");
    for (const char* part : {"<svg ", "raya study fig8 --size 32 -o DIR", "</html>"})
        CHECK_THAT(document, Catch::Contains(part));
    const std::string csv = file_contents(folder / "fig8.csv"), markdown = file_contents(folder / "fig8.md");
    CHECK(csv.starts_with("p,u,mean u,+-,least u,largest u,"));
    CHECK(std::count(csv.begin(), csv.end(), '\n') == 33);
    CHECK_THAT(markdown, Catch::Contains("## Main figures") && Catch::Contains("(fig8-all.svg)"));
}

// raya looks for the SimGrid program in its own folder, so a copy of raya in another folder does not find it.
TEST_CASE("study simgrid: without SimGrid the error names the package, and study all skips this study", "[cli]") {
    const ScratchFolder outputs, copy_folder;
    const RunOptions copy_options{.program = copy_folder / "raya"};
    std::filesystem::copy_file(RAYA_PROGRAM, copy_options.program);
    std::filesystem::create_directory_symlink(std::filesystem::path(RAYA_PROGRAM).parent_path() / "python",
                                              copy_folder / "python");
    check_refused(outputs, study_arguments("simgrid", outputs), 2,
                  {"study simgrid", "tools/setup --studies", "libsimgrid-dev"}, copy_options);
    check_refused(outputs, study_arguments("all", outputs, {outputs / "missing.nff"}), 2,
                  {"study simgrid is skipped", "missing.nff"}, copy_options);
}

TEST_CASE("study NAME SCENE: uses the given scene", "[cli]") {
    const ScratchFolder outputs;
    const std::string name = GENERATE(from_range(quick(1, {"fig13", "fig7", "fig8", "fig12"})));
    const RunOutcome run = run_raya(study_arguments(name, outputs, {scene_file("glass"), "--size", "20"}));
    INFO(run.describe());
    REQUIRE(run.code == 0);
    const auto json = Document::parse(file_contents(outputs / "made/x" / (name + ".json")));
    CHECK(json["settings"]["scene"] == "glass.nff");
    CHECK(json["settings"]["size"] == 20);
    CHECK_FALSE(contains(run.out, "calibrated"));
}

TEST_CASE("study FILE.py: runs a user's study", "[cli]") {
    const ScratchFolder outputs;
    const RunOutcome run = run_raya(study_arguments(RAYA_SOURCE_DIR "/docs/my_study.py", outputs, {"--size", "32"}));
    INFO(run.describe());
    REQUIRE(run.code == 0);
    CHECK(files_in(outputs / "made/x") == Files{"index.html", "manifest.json", "my-study.csv", "my-study.json",
                                                "my-study.md", "my-study.png", "my-study.svg"});
}

TEST_CASE("study: shards merge to the results of one process, and a manifest repeats them", "[cli]") {
    const ScratchFolder outputs;
    const Arguments fig8 = {"study", "fig8", "--size", "32", "--views", "20"};
    const auto run_with = [&](Arguments arguments, const Arguments& more, int code) {
        arguments.insert(arguments.end(), more.begin(), more.end());
        const RunOutcome run = run_raya(arguments);
        INFO(run.describe());
        REQUIRE(run.code == code);
        return run.out;
    };
    run_with(fig8, {"-o", outputs / "out"}, 0);
    run_with(fig8, {"--shard", "2/2", "-o", outputs / "s2"}, 0);
    CHECK(run_with({"study", "--missing", outputs / "s2"}, {}, 4) == "1/2 absent\n");
    const ScratchFolder empty;
    check_refused(empty, {"study", "fig8", "--merge", outputs / "s2", "-o", empty / "merged"}, 2,
                  {"shard 1/2 is absent"});
    const std::string computed = run_with(fig8, {"--shard", "1/2", "-o", outputs / "s1"}, 0);
    CHECK_THAT(computed, Catch::Contains("s1: shard 1/2 of study fig8: 14 of 14 results computed now"));
    run_with({"study", "fig8", "--merge", outputs / "s1", outputs / "s2", "-o", outputs / "merged"}, {}, 0);
    const Files files = files_in(outputs / "out");
    REQUIRE(files == files_in(outputs / "merged"));
    for (const std::string& file : files)
        CHECK(file_contents(outputs.path() / "out" / file) == file_contents(outputs.path() / "merged" / file));
    const std::string checked = run_with({"study", "--check", outputs / "out/manifest.json"}, {}, 0);
    CHECK_THAT(checked, Catch::Contains("the same results: of the data files, 4 equal, 0 different"));
}

TEST_CASE("study --help, help study: list the studies and the options", "[cli]") {
    const RunOutcome help = run_raya({"help", "study"});
    INFO(help.describe());
    CHECK(help.code == 0);
    CHECK_THAT(help.out, Catch::StartsWith("Usage: raya study [STUDY|all|FILE.py] [SCENE...] -o DIR") &&
                             Catch::Contains("Load of each PE, column split") && Catch::Contains("-o, --output DIR"));
    for (const Arguments& same : {Arguments{"study", "-h"}, {"study", "fig7", "--help"}, {"study", "--help-all"}})
        CHECK(run_raya(same).out == help.out);
}

TEST_CASE("study: refuses wrong names, sizes, scenes and devices, and leaves no folder", "[cli]") {
    const ScratchFolder outputs;
    check_refused(outputs, study_arguments("fig6", outputs), 2, {"no study fig6 (did you mean fig7?)", "FILE.py"});
    check_refused(outputs, study_arguments(outputs / "none.py", outputs), 2, {"none.py: no such file"});
    for (const char* size : quick(1, {"16", "0", "8", "5000"}))
        check_refused(outputs, study_arguments("fig8", outputs, {"--size", size}), 2,
                      {std::string("--size ") + size + ":", "17..4096"});
    for (const char* size : quick(1, {"32x16", "-1", "1e2", "wide", ""}))
        check_refused(outputs, study_arguments("fig8", outputs, {"--size", size}), 2, {"--size"});
    for (const char* network : quick(1, {"1,nan", "30", "1,2,3", "-1,0", "2e9,1", "fast,1"}))
        check_refused(outputs, study_arguments("ranks", outputs, {"--network", network}), 2, {"--network"});
    check_refused(outputs, study_arguments("fig8", outputs, {"--size", "99999999999"}), 2, {"--size", "99999999999"});
    check_refused(outputs, study_arguments("fig8", outputs, {outputs / "none.nff"}), 2, {"none.nff", "cannot read"});
    check_refused(outputs, study_arguments("images", outputs, {scene_file("glass"), outputs / "none.nff"}), 2,
                  {"none.nff"});
    check_refused(outputs, study_arguments("fig8", outputs, {scene_file("glass"), scene_file("cones")}), 2,
                  {"fig8 takes one scene", "2 were given"});
    check_refused(outputs, {"study", "fig7", "fig8", "-o", outputs / "z"}, 2, {"fig8 is a study", "raya study all"});
    check_refused(outputs, {"study", "fig7", scene_file("glass"), "-o", "-"}, 2,
                  {"-o -: a study writes several files"});
    check_refused(outputs, {"study", "fig8"}, 2, {"--output is required"});
    for (const Arguments& no_study : {Arguments{"study"}, {"study", "--merge", outputs / "none"}})
        check_refused(outputs, no_study, 2, {"STUDY is required"});
    for (const char* shard : quick(1, {"0/3", "4/3", "1", "a/b"}))
        check_refused(outputs, study_arguments("fig8", outputs, {"--shard", shard}), 2, {"--shard", "must be I/N"});
    check_refused(outputs, study_arguments("table2", outputs, {"--shard", "1/2"}), 2, {"has no ensembles to divide"});
    for (const char* option : quick(1, {"--merge", "--missing", "--check"}))
        check_refused(outputs, {"study", option, outputs / "none", "--seed", "2"}, 2, {option, "excludes --seed"});
    check_refused(outputs, {"study", "fig8", "--merge", outputs / "none", "-o", outputs / "x"}, 2,
                  {"none: contains no shard"});
    check_refused(outputs, {"study", "--missing", outputs / "none"}, 2, {"none: contains no shard"});
    check_refused(outputs, {"study", "--check", outputs / "none"}, 2, {"none: is not a manifest", "No such file"});
    check_refused(outputs, {"study", "fig8", "-o", ""}, 2, {"--output", "must not be empty"});
    check_refused(outputs, study_arguments("fig8", outputs, {"--device", "no such device"}), 3, {"no such device"});
    check_refused(outputs, study_arguments("fig8", outputs, {"--size", "17"}), 3, {"CL_OUT_OF_RESOURCES"},
                  device_with_fault("clEnqueueNDRangeKernel 1 -5"));
    check_refused(outputs, study_arguments("fig8", outputs), 2, {"cannot start /nonexistent", "python3", "RAYA_PYTHON"},
                  {.variables = {{"RAYA_PYTHON", "/nonexistent"}}});
}

TEST_CASE("study: refuses a folder that it cannot create or write, before rendering", "[cli]") {
    const ScratchFolder outputs;
    check_refused(outputs, {"study", "fig8", "-o", "/dev/null/x"}, 2, {"/dev/null/x", "cannot create directory"});
    const ScratchFolder read_only;
    ::chmod(read_only.path().c_str(), 0555);
    for (const char* name : quick(1, {"all", "fig8"}))
        check_refused(read_only, {"study", name, "-o", read_only.path(), "--size", "32"}, 2, {"not writable"},
                      {.variables = {}, .as_nobody = true});
    ::chmod(read_only.path().c_str(), 0755);
}

}  // namespace
}  // namespace raya
#endif
