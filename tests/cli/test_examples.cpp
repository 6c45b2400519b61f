// The examples in help: the parser accepts every example, and the fast ones run successfully.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/cli/all_commands.hpp"
#include "tests/cli/refusals.hpp"

namespace raya {
namespace {

namespace fs = std::filesystem;

/// Returns the arguments of each call of raya in a shell command line.
std::vector<Arguments> calls_in(std::string line) {
    for (const char* separator : {"<(", ")", "|", "&&", ">"})
        for (std::size_t at = 0; (at = line.find(separator, at)) != std::string::npos;
             at += std::string(separator).size() + 2)
            line.replace(at, std::string(separator).size(), std::string(" ") + separator + ' ');
    std::vector<Arguments> calls;
    bool in_call = false;
    for (const std::string& token : tokens_of(line)) {
        if (token == "raya")
            calls.emplace_back();
        else if (in_call && token != "|" && token != "&&" && token != ">" && token != ")")
            calls.back().push_back(token);
        in_call = token == "raya" || (in_call && token != "|" && token != "&&" && token != ">" && token != ")");
    }
    return calls;
}

struct Accepted {};  // thrown instead of running the command

/// Returns the message with which the parser refuses the call; empty if the parser accepts the call.
std::string refusal_of(const Arguments& call) {
    const std::shared_ptr<CLI::App> program = make_full_parser();
    program->parse_complete_callback([] { throw Accepted{}; });
    try {
        program->parse(Arguments{call.rbegin(), call.rend()});
        return "nothing was parsed";
    } catch (const Accepted&) {
        return "";
    } catch (const std::exception& error) {
        return error.what();
    }
}

/// Returns the files and folders that a call writes.
Arguments outputs_of(const Arguments& call) {
    Arguments files;
    for (std::size_t i = 0; i + 1 < call.size(); ++i)
        for (const char* option : {"-o", "--output", "--report", "--page", "--cost", "--trace", "--packets"})
            if (call[i] == option && call[i + 1] != "-") files.push_back(call[i + 1]);
    return files;
}

/// Returns true for examples that are not run: they take long, need other software, or are for another shell.
bool is_skipped(const std::string& line) {
    for (const char* part : {"raya study all", "mpirun", "man -l", "raya bench", "source <("})
        if (contains(line, part)) return true;
    return line == "raya verify";
}

TEST_CASE("help: every command has two examples, each with a description", "[cli][help]") {
    for_each_command(text_of_all_commands(), [](const CommandText& command, const std::string& path) {
        CAPTURE(path);
        CHECK(command.examples.size() == 2);
        for (const ExampleText& example : command.examples) {
            CAPTURE(example.command);
            CHECK(!example.description.empty());
            CHECK((contains(example.command, path + ' ') || example.command.ends_with(path) || path == "raya"));
        }
    });
}

TEST_CASE("help: the parser accepts every example, and its scenes exist", "[cli][help]") {
    for_each_command(text_of_all_commands(), [](const CommandText& command, const std::string&) {
        for (const ExampleText& example : command.examples) {
            CAPTURE(example.command);
            const std::vector<Arguments> calls = calls_in(example.command);
            CHECK(!calls.empty());
            for (const Arguments& call : calls) {
                CHECK(refusal_of(call) == "");
                for (const std::string& argument : call)
                    if (argument.starts_with("scenes/")) CHECK(fs::exists(fs::path(RAYA_SOURCE_DIR) / argument));
            }
        }
    });
}

TEST_CASE("help: the parser refuses wrong examples (control)", "[cli][help]") {
    CHECK(calls_in("a=b raya x -o - | raya y >z && raya w") == std::vector<Arguments>{{"x", "-o", "-"}, {"y"}, {"w"}});
    for (const Arguments& call :
         {Arguments{"rendr", "x.nff"}, Arguments{"render", "x.nff", "-o", "x.png", "--no-such-option"},
          Arguments{"render", "x.nff", "-o"}, Arguments{"render", "x.nff"},
          Arguments{"generate", "random", "many", "-o", "x.nff"}})
        CHECK(refusal_of(call) != "");
}

TEST_CASE("help: the examples run and write their files", "[.][long][cli][help]") {
    const ScratchFolder folder;
    fs::create_directory_symlink(RAYA_SOURCE_DIR "/scenes", folder / "scenes");
    fs::create_directory(folder / "bin");
    fs::create_symlink(RAYA_PROGRAM, folder / "bin/raya");
    int count = 0;
    for_each_command(text_of_all_commands(), [&](const CommandText& command, const std::string&) {
        for (const ExampleText& example : command.examples) {
            if (is_skipped(example.command)) continue;
            CAPTURE(example.command);
            std::ofstream(folder / "example.sh")
                << "cd " << folder.path().string() << " && PATH=$PWD/bin:$PATH && set -eo pipefail\n{ "
                << example.command << "; } >output 2>errors\n";
            const int status = std::system(("bash " + (folder / "example.sh").string()).c_str());
            INFO(file_contents(folder / "errors"));
            CHECK(status == 0);
            for (const Arguments& call : calls_in(example.command))
                for (const std::string& file : outputs_of(call)) CHECK(fs::exists(folder / file));
            ++count;
        }
    });
    CHECK(count >= 30);
}

}  // namespace
}  // namespace raya
