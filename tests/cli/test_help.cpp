// Help: the same by all ways to it, as wide as the terminal, with every option below a heading.
#include <pty.h>
#include <sys/wait.h>

#include <algorithm>
#include <sstream>

#include "host/cli/command_text.hpp"
#include "tests/cli/refusals.hpp"
#include "tests/cli/whole_tree.hpp"

namespace raya {
namespace {

std::string help_of(Words words, const std::string& columns = "") {
    const RunOutcome run = run_raya(std::move(words), {.variables = {{"COLUMNS", columns}}});
    INFO(run.told());
    REQUIRE(run.code == 0);
    CHECK(run.err.empty());
    return run.out;
}

/// What raya prints on a terminal of so many columns.
std::string on_terminal(Words words, unsigned short columns) {
    winsize size{};
    size.ws_col = columns;
    size.ws_row = 24;
    int terminal = -1;
    const pid_t child = ::forkpty(&terminal, nullptr, nullptr, &size);
    REQUIRE(child >= 0);
    if (child == 0) {
        ::unsetenv("COLUMNS");
        words.insert(words.begin(), "raya");
        ::execv(RAYA_PROGRAM, run_program_detail::pointers(words).data());
        ::_exit(127);
    }
    std::string text;
    std::array<char, 4096> block{};
    for (ssize_t got = 0; (got = ::read(terminal, block.data(), block.size())) > 0;)
        text.append(block.data(), static_cast<std::size_t>(got));
    int status = 0;
    ::waitpid(child, &status, 0);
    ::close(terminal);
    CHECK(WIFEXITED(status));
    CHECK(WEXITSTATUS(status) == 0);
    std::erase(text, '\r');
    return text;
}

TEST_CASE("raya help WORDS prints what --help prints", "[cli][help]") {
    CHECK(help_of({"help"}) == help_of({"--help"}));
    CHECK(help_of({"help", "render"}) == help_of({"render", "--help"}));
    CHECK(help_of({"help", "study"}) == help_of({"study", "-h"}));
    CHECK(help_of({"help", "study"}) == help_of({"study", "fig7", "--help"}));
    CHECK(help_of({"help", "help"}) == help_of({"help", "--help"}));
    CHECK_THAT(help_of({"help", "study"}),
               Catch::StartsWith("Usage: raya study STUDY") && Catch::Contains("Load of each PE, column split"));
    CHECK_THAT(help_of({"help", "page"}), !Catch::Contains("script"));  // pages have one, which sorts tables
}

TEST_CASE("help of what there is not is refused, with what was perhaps meant", "[cli][help]") {
    const ScratchFolder outputs;
    check_refused(outputs, {"help", "rendr"}, 2,
                  {"raya: help: no command rendr (did you mean render?); there are render"});
    check_refused(outputs, {"help", "study", "fig7"}, 2, {"study has no command fig7; see raya help study"});
    check_refused(outputs, {"help", "render", "fig7"}, 2, {"render has no command fig7; see raya help render"});
}

TEST_CASE("help is as wide as COLUMNS says, from 40 to 120, and else 80", "[cli][help]") {
    const std::string usual = help_of({"help", "render"});
    CHECK(longest_line(usual) <= 80);
    CHECK(longest_line(usual) > 70);
    for (const char* none : {"0", "x", "80x", "-3", "99999999", "184467440737095516150"})
        CHECK(help_of({"help", "render"}, none) == usual);
    CHECK(longest_line(help_of({"help", "render"}, "100")) > 90);
    CHECK(help_of({"help", "render"}, "10") == help_of({"help", "render"}, "40"));
    CHECK(help_of({"help", "render"}, "300") == help_of({"help", "render"}, "120"));
    CHECK(help_of({"help", "render"}, "60") != usual);
}

TEST_CASE("help is as wide as the terminal", "[cli][help]") {
    for (const unsigned short columns : std::initializer_list<unsigned short>{50, 97})
        CHECK(on_terminal({"help", "verify"}, columns) == help_of({"help", "verify"}, std::to_string(columns)));
    CHECK(on_terminal({"help", "verify"}, 0) == help_of({"help", "verify"}));
}

TEST_CASE("no command's help has a line that is too long", "[cli][help]") {
    for_each_command(tree_of_all(), [](const CommandText& command, const std::string& path) {
        for (const std::size_t width : {40u, 60u, 80u, 120u})
            for (const std::string& line : lines_of(help_text(command, path, width))) {
                CAPTURE(path, width, line);
                const std::size_t begin = line.find_first_not_of(' ');
                CHECK((line.size() <= width || line.find(' ', begin) == std::string::npos));
                CHECK((line.empty() || line.back() != ' '));
            }
    });
}

TEST_CASE("every option stands below a heading of its kind, those of all commands below the last", "[cli][help]") {
    for_each_command(tree_of_all(), [](const CommandText& command, const std::string& path) {
        CAPTURE(path);
        const std::vector<std::string> groups = groups_of(command);
        CHECK(std::find(groups.begin(), groups.end(), "Options") == groups.end());
        REQUIRE(!groups.empty());
        CHECK(groups.back() == "Common options");
        Words common;
        for (const OptionText& option : command.options)
            if (option.group == groups.back()) common.push_back(option.names.back());
        for (const char* name : {"--help", "--quiet", "--verbose"})
            CHECK(std::count(common.begin(), common.end(), name) == 1);
        CHECK(common.size() == (path == "raya" ? 4 : 3));  // --version
    });
}

TEST_CASE("a render's options stand where a reader looks for them", "[cli][help]") {
    const CommandText program = tree_of_all();
    const auto& render = *std::find_if(program.commands.begin(), program.commands.end(),
                                       [](const CommandText& one) { return one.name == "render"; });
    CHECK(groups_of(render) == Words{"Files", "Picture", "Camera and light", "Machine and mapping",
                                     "Kernels and device", "Frames", "Long images", "Torus machine", "Looking closer",
                                     "Common options"});
    const std::vector<std::pair<std::string, std::string>> rows = {{"--output", "Files"},
                                                                   {"--strict", "Files"},
                                                                   {"--size", "Picture"},
                                                                   {"--exposure", "Picture"},
                                                                   {"--antialias", "Picture"},
                                                                   {"--from", "Camera and light"},
                                                                   {"--light", "Camera and light"},
                                                                   {"--machine", "Machine and mapping"},
                                                                   {"--mapping", "Machine and mapping"},
                                                                   {"--accel", "Machine and mapping"},
                                                                   {"--format", "Kernels and device"},
                                                                   {"--device", "Kernels and device"},
                                                                   {"--no-tuned", "Kernels and device"},
                                                                   {"--nodes", "Torus machine"},
                                                                   {"--report", "Looking closer"},
                                                                   {"--page", "Looking closer"},
                                                                   {"--profile", "Looking closer"},
                                                                   {"--trace", "Looking closer"}};
    for (const auto& [name, group] : rows) {
        CAPTURE(name);
        const auto option = std::find_if(render.options.begin(), render.options.end(),
                                         [&, &wanted = name](const OptionText& o) { return o.names.back() == wanted; });
        REQUIRE(option != render.options.end());
        CHECK(option->group == group);
    }
}

}  // namespace
}  // namespace raya
