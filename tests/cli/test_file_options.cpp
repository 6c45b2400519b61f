// No output of a command overwrites an input or another output of it, by whatever names: all commands, all pairs of
// their file options. The parser runs in this process: it refuses before any callback.
#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <regex>

#include "host/base/whole_file.hpp"
#include "host/cl/device.hpp"
#include "host/cli/file_options.hpp"
#include "host/error.hpp"
#include "host/tune/store.hpp"
#include "tests/cli/refusals.hpp"
#include "tests/cli/whole_tree.hpp"
#include "tests/kernels/write_kernels.hpp"
#include "tests/thorough.hpp"

namespace raya {
namespace {

namespace fs = std::filesystem;

using Path = std::vector<std::string>;  // of a command: {"generate", "random"}

void for_each_command(CLI::App& command, const Path& path, const std::function<void(CLI::App&, const Path&)>& see) {
    see(command, path);
    for (CLI::App* one : command.get_subcommands({})) {
        Path below = path;
        below.push_back(one->get_name());
        for_each_command(*one, below, see);
    }
}

TEST_CASE("every option whose value is a file or a folder says what is done with it", "[cli][file_options]") {
    const auto parser = parser_of_all();
    const std::regex file("FILE|IMAGE|SCENE[.]nff|DIR|REPORT");
    std::size_t files = 0;
    for_each_command(*parser, {}, [&](CLI::App& command, const Path& path) {
        for (CLI::Option* option : command.get_options()) {
            CAPTURE(path, option->get_name());
            const bool names_file = std::regex_search(option->get_type_name(), file);
            CHECK((file_use(*option) != FileUse::kNone) == names_file);
            files += names_file;
        }
    });
    CHECK(files > 35);
}

/// A line that gives two options of a command their values, and its other required ones any.
Words line_of(CLI::App& command, const Path& path, const Words& two_options, const Words& two_values,
              const ScratchFolder& others) {
    Words words = path;
    for (const CLI::Option* option : command.get_options()) {
        const std::string name = option->get_name();
        const auto at = std::find(two_options.begin(), two_options.end(), name);
        if (at == two_options.end() && !option->get_required()) continue;
        if (!option->get_positional()) words.push_back(name);
        if (at != two_options.end())
            words.push_back(two_values[static_cast<std::size_t>(at - two_options.begin())]);
        else
            words.push_back(option->get_type_name() == "COUNT" ? "5" : others / name);
    }
    return words;
}

void check_refused_by_parser(const Words& words, const Words& options) {
    CAPTURE(words);
    std::string message = "nothing";
    try {
        parser_of_all()->parse(Words(words.rbegin(), words.rend()));  // the last word first
    } catch (const UserError& error) {                                // exit code 2
        message = error.what();
    }
    for (const std::string& option : options) CHECK_THAT(message, Catch::Contains(option));
}

std::vector<Words> pairs_of(CLI::App& command, FileUse one, FileUse other) {
    std::vector<Words> pairs;
    for (CLI::Option* a : command.get_options())
        for (CLI::Option* b : command.get_options())
            if (file_use(*a) == one && file_use(*b) == other && (one != other || a->get_name() < b->get_name()))
                pairs.push_back({a->get_name(), b->get_name()});
    return pairs;
}

/// `see` with two names of one file, which `exists` or does not.
void for_each_two_names(bool exists, const std::function<void(const Words&)>& see) {
    Words others = {"file", "./file", "sub/../file", "way/file", "link", "link2"};
    if (exists) others.push_back("hard");
    for (const std::string& other : by_turns(others)) {
        const ScratchFolder folder;
        fs::create_directory(folder / "sub");
        fs::create_directory_symlink(".", folder / "way");
        fs::create_symlink("file", folder / "link");
        fs::create_symlink(fs::path(folder / "link"), folder / "link2");
        if (exists) write_whole_file(folder / "file", "content");
        if (exists) fs::create_hard_link(folder / "file", folder / "hard");
        see({folder / "file", folder / other});
        see({folder / other, folder / "file"});
        CHECK(fs::exists(folder / "file") == exists);
        if (exists) CHECK(file_contents(folder / "file") == "content");
    }
}

TEST_CASE("no command overwrites a file that it reads or writes, by whatever names", "[cli][file_options]") {
    const auto parser = parser_of_all();
    const ScratchFolder others;
    std::size_t pairs = 0;
    for_each_command(*parser, {}, [&](CLI::App& command, const Path& path) {
        const auto check = [&](FileUse one, bool exists) {
            for (const Words& options : pairs_of(command, one, FileUse::kWritten)) {
                ++pairs;
                for_each_two_names(exists, [&](const Words& names) {
                    check_refused_by_parser(line_of(command, path, options, names, others), options);
                });
            }
        };
        check(FileUse::kRead, true);
        check(FileUse::kWritten, true);
        check(FileUse::kWritten, false);
    });
    CHECK(pairs > 70);
    CHECK(others.entries() == 0);
}

TEST_CASE("no command overwrites kernels that it reads, or what it reads in the folder that it fills",
          "[cli][file_options]") {
    const auto parser = parser_of_all();
    const ScratchFolder others, kernels, folder;
    write_kernels(kernels.path());
    const std::string kernel = file_contents(kernels / "ring/trace.cl");
    fs::create_symlink(fs::path(kernels / "ring/trace.cl"), others / "link");
    write_whole_file(folder / "fig7.csv", "content");
    fs::create_symlink(fs::path(folder / "fig7.csv"), others / "scene.nff");
    std::size_t pairs = 0;
    for_each_command(*parser, {}, [&](CLI::App& command, const Path& path) {
        const auto check = [&](FileUse one, FileUse other, const Words& values) {
            for (const Words& options : pairs_of(command, one, other)) {
                ++pairs;
                check_refused_by_parser(line_of(command, path, options, values, others), options);
            }
        };
        check(FileUse::kKernelFolder, FileUse::kWritten, {kernels.path(), kernels / "ring/trace.cl"});
        check(FileUse::kKernelFolder, FileUse::kWritten, {kernels.path(), others / "link"});
        check(FileUse::kRead, FileUse::kWrittenFolder, {folder / "fig7.csv", folder.path()});
        check(FileUse::kRead, FileUse::kWrittenFolder, {others / "scene.nff", folder.path()});
    });
    CHECK(pairs > 25);
    CHECK((file_contents(kernels / "ring/trace.cl") == kernel));
    CHECK(file_contents(folder / "fig7.csv") == "content");
}

/// A run that must not touch `file`, which holds a scene.
void check_kept(const std::string& file, const Words& words, const Words& message) {
    const std::string before = file_contents(file);
    const RunOutcome run = run_raya(words);
    INFO(run.told());
    CHECK(run.code == 2);
    CHECK(run.out.empty());
    for (const std::string& part : message) CHECK_THAT(run.err, Catch::Contains(part));
    CHECK(file_contents(file) == before);
}

TEST_CASE("outputs that follow from options overwrite nothing", "[cli][file_options]") {
    const ScratchFolder folder;
    const std::string scene = scene_file("planes"), image = folder / "a.ppm";
    const auto copy = [&](const std::string& name) {
        fs::copy(scene, folder / name);
        return folder / name;
    };
    const Words frames = {"-o", image, "--frames", "1:4", "--turn", "90", "--size", "4"};
    const auto of = [&](const std::string& input, Words words) {
        words.insert(words.begin(), {"render", input});
        return words;
    };
    const std::string third = copy("a-0003.ppm"), record = copy("a-frames.json"), report = copy("r-0002.json"),
                      platform = copy("p.xml"), history = copy("p.replay");
    check_kept(third, of(third, frames), {"--output", "a-0003.ppm", "SCENE"});
    check_kept(record, of(record, frames), {"--frames", "a-frames.json", "SCENE"});
    Words reports = frames;
    reports.insert(reports.end(), {"--report", folder / "r.json"});
    check_kept(report, of(report, reports), {"--report", "r-0002.json", "SCENE"});
    fs::create_symlink("r-0003.json", folder / "a-0004.ppm");
    check_kept(scene, of(scene, reports), {"--report", "r-0003.json", "--output", "a-0004.ppm"});
    const Words packets = {"-o", image, "--machine", "torus", "--packets", folder / "p.csv.gz", "--replay", "simgrid"};
    for (const std::string& file : {platform, history})
        check_kept(file, of(file, packets), {"--replay", file, "SCENE"});
    CHECK_FALSE(fs::exists(image));
}

TEST_CASE("tune does not overwrite what it keeps with its report", "[cli][file_options]") {
    const ScratchFolder cache;
    const DeviceInfo device = device_info(choose_device(""));
    fs::create_directory(cache / "raya");
    const std::string file = cache / "raya" / tuned_file_name(device);
    write_whole_file(file, "content");
    const RunOutcome run =
        run_raya({"tune", "--seconds", "1", "--report", file}, {.variables = {{"XDG_CACHE_HOME", cache.path()}}});
    INFO(run.told());
    CHECK(run.code == 2);
    CHECK_THAT(run.err, Catch::Contains("tune ") && Catch::Contains("the same file as --report"));
    CHECK(file_contents(file) == "content");
}

}  // namespace
}  // namespace raya
