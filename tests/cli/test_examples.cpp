// The examples in help: each is what the parser takes, and those that take seconds are run.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/cli/refusals.hpp"
#include "tests/cli/whole_tree.hpp"

namespace raya {
namespace {

namespace fs = std::filesystem;

/// The words behind each "raya" of a shell's line, up to what ends that call.
std::vector<Words> calls_in(std::string line) {
    for (const char* sign : {"<(", ")", "|", "&&", ">"})
        for (std::size_t at = 0; (at = line.find(sign, at)) != std::string::npos; at += std::string(sign).size() + 2)
            line.replace(at, std::string(sign).size(), std::string(" ") + sign + ' ');
    std::vector<Words> calls;
    bool inside = false;
    for (const std::string& word : words_of(line)) {
        if (word == "raya")
            calls.emplace_back();
        else if (inside && word != "|" && word != "&&" && word != ">" && word != ")")
            calls.back().push_back(word);
        inside = word == "raya" || (inside && word != "|" && word != "&&" && word != ">" && word != ")");
    }
    return calls;
}

struct Taken {};  // thrown where the command would run

/// What the parser says against it; empty: nothing.
std::string refusal_of(const Words& call) {
    const std::shared_ptr<CLI::App> program = parser_of_all();
    program->parse_complete_callback([] { throw Taken{}; });
    try {
        program->parse(Words{call.rbegin(), call.rend()});
        return "nothing was parsed";
    } catch (const Taken&) {
        return "";
    } catch (const std::exception& error) {
        return error.what();
    }
}

/// The files and folders that a call is told to write.
Words outputs_of(const Words& call) {
    Words files;
    for (std::size_t i = 0; i + 1 < call.size(); ++i)
        for (const char* option : {"-o", "--output", "--report", "--page", "--cost", "--trace", "--packets"})
            if (call[i] == option && call[i + 1] != "-") files.push_back(call[i + 1]);
    return files;
}

/// What takes longer than a test may, asks for what may not be here, or is of another shell.
bool is_left_out(const std::string& path, const std::string& line) {
    if (path == "raya study") return !contains(line, " --size 64 ");
    for (const char* part : {"raya study all", "mpirun", "man -l", "raya bench", "source <("})
        if (contains(line, part)) return true;
    return line == "raya verify";
}

TEST_CASE("every command has two examples, each with a word on what it does", "[cli][help]") {
    for_each_command(tree_of_all(), [](const CommandText& command, const std::string& path) {
        CAPTURE(path);
        CHECK(command.examples.size() == 2);
        for (const ExampleText& example : command.examples) {
            CAPTURE(example.command);
            CHECK(!example.says.empty());
            CHECK((contains(example.command, path + ' ') || example.command.ends_with(path) || path == "raya"));
        }
    });
}

TEST_CASE("every example is what the parser takes, of scenes that there are", "[cli][help]") {
    for_each_command(tree_of_all(), [](const CommandText& command, const std::string&) {
        for (const ExampleText& example : command.examples) {
            CAPTURE(example.command);
            const std::vector<Words> calls = calls_in(example.command);
            CHECK(!calls.empty());
            for (const Words& call : calls) {
                CHECK(refusal_of(call) == "");
                for (const std::string& word : call)
                    if (word.starts_with("scenes/")) CHECK(fs::exists(fs::path(RAYA_SOURCE_DIR) / word));
            }
        }
    });
}

TEST_CASE("what is wrong in an example is seen", "[cli][help]") {
    CHECK(calls_in("a=b raya x -o - | raya y >z && raya w") == std::vector<Words>{{"x", "-o", "-"}, {"y"}, {"w"}});
    CHECK(calls_in("source <(raya completion bash)") == std::vector<Words>{{"completion", "bash"}});
    for (const Words& call : {Words{"rendr", "x.nff"}, Words{"render", "x.nff", "-o", "x.png", "--no-such-option"},
                              Words{"render", "x.nff", "-o"}, Words{"render", "x.nff"},
                              Words{"generate", "random", "many", "-o", "x.nff"}, Words{"study", "fig7"}})
        CHECK(refusal_of(call) != "");
}

TEST_CASE("examples do what they say", "[.][long][cli][help]") {
    const ScratchFolder folder;
    fs::create_directory_symlink(RAYA_SOURCE_DIR "/scenes", folder / "scenes");
    fs::create_directory(folder / "bin");
    fs::create_symlink(RAYA_PROGRAM, folder / "bin/raya");
    int count = 0;
    for_each_command(tree_of_all(), [&](const CommandText& command, const std::string& path) {
        for (const ExampleText& example : command.examples) {
            if (is_left_out(path, example.command)) continue;
            CAPTURE(example.command);
            std::ofstream(folder / "example.sh")
                << "cd " << folder.path().string() << " && PATH=$PWD/bin:$PATH && set -eo pipefail\n{ "
                << example.command << "; } >told 2>errors\n";
            const int status = std::system(("bash " + (folder / "example.sh").string()).c_str());
            INFO(file_contents(folder / "errors"));
            CHECK(status == 0);
            for (const Words& call : calls_in(example.command))
                for (const std::string& file : outputs_of(call)) CHECK(fs::exists(folder / file));
            ++count;
        }
    });
    CHECK(count >= 30);
}

}  // namespace
}  // namespace raya
