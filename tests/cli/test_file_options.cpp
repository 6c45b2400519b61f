// No output of a command overwrites its input or another output, even under another name of the same file. Tests all
// pairs of file options of all commands. The parser runs in this process. It refuses the arguments before it
// calls a command's callback.
#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <regex>

#include "host/base/whole_file.hpp"
#include "host/cl/device.hpp"
#include "host/cli/options.hpp"
#include "host/error.hpp"
#include "host/tune/store.hpp"
#include "tests/cli/all_commands.hpp"
#include "tests/cli/refusals.hpp"
#include "tests/kernels/write_kernels.hpp"
#include "tests/thorough.hpp"

namespace raya {
namespace {

namespace fs = std::filesystem;

using Path = std::vector<std::string>;  // command path: {"generate", "random"}

void for_each_command(CLI::App& command, const Path& path, const std::function<void(CLI::App&, const Path&)>& visit) {
    visit(command, path);
    for (CLI::App* subcommand : command.get_subcommands({})) {
        Path subcommand_path = path;
        subcommand_path.push_back(subcommand->get_name());
        for_each_command(*subcommand, subcommand_path, visit);
    }
}

TEST_CASE("file options: every option that names a file or folder declares how it is used", "[cli][file_options]") {
    const auto parser = make_full_parser();
    const std::regex file("FILE|IMAGE|SCENE|DIR|REPORT");
    std::size_t files = 0;
    for_each_command(*parser, {}, [&](CLI::App& command, const Path& path) {
        for (CLI::Option* option : command.get_options()) {
            CAPTURE(path, option->get_name());
            const bool names_file = std::regex_search(option->get_type_name(), file);
            CHECK((file_use_of(*option) != FileUse::kNone) == names_file);
            files += names_file;
        }
    });
    CHECK(files > 35);
}

/// Returns arguments that set `two_options` of a command to `two_values`, and its other required options to arbitrary
/// valid values.
Arguments arguments_for(CLI::App& command, const Path& path, const Arguments& two_options, const Arguments& two_values,
                        const ScratchFolder& other_files) {
    Arguments arguments = path;
    for (const CLI::Option* option : command.get_options()) {
        const std::string name = option->get_name();
        const auto at = std::find(two_options.begin(), two_options.end(), name);
        if (at == two_options.end() && !option->get_required()) continue;
        if (!option->get_positional()) arguments.push_back(name);
        if (at != two_options.end())
            arguments.push_back(two_values[static_cast<std::size_t>(at - two_options.begin())]);
        else
            arguments.push_back(option->get_type_name() == "COUNT" ? "5" : other_files / name);
    }
    return arguments;
}

void check_refused_by_parser(const Arguments& arguments, const Arguments& options) {
    CAPTURE(arguments);
    std::string message = "accepted";
    try {
        make_full_parser()->parse(
            Arguments(arguments.rbegin(), arguments.rend()));  // CLI11 expects the arguments in reverse
    } catch (const UserError& error) {                         // raya would exit with code 2
        message = error.what();
    }
    for (const std::string& option : options) CHECK_THAT(message, Catch::Contains(option));
}

std::vector<Arguments> pairs_of(CLI::App& command, FileUse first_use, FileUse second_use) {
    std::vector<Arguments> pairs;
    for (CLI::Option* a : command.get_options())
        for (CLI::Option* b : command.get_options())
            if (file_use_of(*a) == first_use && file_use_of(*b) == second_use &&
                (first_use != second_use || a->get_name() < b->get_name()))
                pairs.push_back({a->get_name(), b->get_name()});
    return pairs;
}

/// Calls `visit` with two names of the same file, for several kinds of names. `exists`: the file exists.
void for_each_two_names(bool exists, const std::function<void(const Arguments&)>& visit) {
    Arguments names = {"file", "./file", "sub/../file", "folder_link/file", "link", "link2"};
    if (exists) names.push_back("hard");
    for (const std::string& name : quick_rotating(names)) {
        const ScratchFolder folder;
        fs::create_directory(folder / "sub");
        fs::create_directory_symlink(".", folder / "folder_link");
        fs::create_symlink("file", folder / "link");
        fs::create_symlink(fs::path(folder / "link"), folder / "link2");
        if (exists) write_whole_file(folder / "file", "content");
        if (exists) fs::create_hard_link(folder / "file", folder / "hard");
        visit({folder / "file", folder / name});
        visit({folder / name, folder / "file"});
        CHECK(fs::exists(folder / "file") == exists);
        if (exists) CHECK(file_contents(folder / "file") == "content");
    }
}

TEST_CASE("file options: no command overwrites a file that it reads or writes, under any name", "[cli][file_options]") {
    const auto parser = make_full_parser();
    const ScratchFolder other_files;
    std::size_t pairs = 0;
    for_each_command(*parser, {}, [&](CLI::App& command, const Path& path) {
        const auto check = [&](FileUse use, bool exists) {
            for (const Arguments& options : pairs_of(command, use, FileUse::kWritten)) {
                ++pairs;
                for_each_two_names(exists, [&](const Arguments& names) {
                    check_refused_by_parser(arguments_for(command, path, options, names, other_files), options);
                });
            }
        };
        check(FileUse::kRead, true);
        check(FileUse::kWritten, true);
        check(FileUse::kWritten, false);
    });
    CHECK(pairs > 70);
    CHECK(other_files.entries() == 0);
}

TEST_CASE("file options: no command overwrites kernels that it reads, or an input in its output folder",
          "[cli][file_options]") {
    const auto parser = make_full_parser();
    const ScratchFolder other_files, kernels, folder;
    write_kernels(kernels.path());
    const std::string kernel = file_contents(kernels / "ring/trace.cl");
    fs::create_symlink(fs::path(kernels / "ring/trace.cl"), other_files / "link");
    write_whole_file(folder / "fig7.csv", "content");
    fs::create_symlink(fs::path(folder / "fig7.csv"), other_files / "scene.nff");
    std::size_t pairs = 0;
    for_each_command(*parser, {}, [&](CLI::App& command, const Path& path) {
        const auto check = [&](FileUse first_use, FileUse second_use, const Arguments& values) {
            for (const Arguments& options : pairs_of(command, first_use, second_use)) {
                ++pairs;
                check_refused_by_parser(arguments_for(command, path, options, values, other_files), options);
            }
        };
        check(FileUse::kKernelFolder, FileUse::kWritten, {kernels.path(), kernels / "ring/trace.cl"});
        check(FileUse::kKernelFolder, FileUse::kWritten, {kernels.path(), other_files / "link"});
        check(FileUse::kRead, FileUse::kWrittenFolder, {folder / "fig7.csv", folder.path()});
        check(FileUse::kRead, FileUse::kWrittenFolder, {other_files / "scene.nff", folder.path()});
    });
    CHECK(pairs > 25);
    CHECK((file_contents(kernels / "ring/trace.cl") == kernel));
    CHECK(file_contents(folder / "fig7.csv") == "content");
}

}  // namespace
}  // namespace raya
