// Help: `help` and `--help` print the same text, as wide as the terminal, with every option below a heading.
#include <pty.h>
#include <sys/wait.h>

#include <algorithm>
#include <sstream>

#include "host/cli/help.hpp"
#include "tests/cli/all_commands.hpp"
#include "tests/cli/refusals.hpp"

namespace raya {
namespace {

std::string help_of(Arguments arguments, const std::string& columns = "") {
    const RunOutcome run = run_raya(std::move(arguments), {.variables = {{"COLUMNS", columns}}});
    INFO(run.describe());
    REQUIRE(run.code == 0);
    CHECK(run.err.empty());
    return run.out;
}

/// Returns the output of raya on a terminal with `columns` columns.
std::string output_on_terminal(Arguments arguments, unsigned short columns) {
    winsize window{};
    window.ws_col = columns;
    window.ws_row = 24;
    int terminal = -1;
    const pid_t child = ::forkpty(&terminal, nullptr, nullptr, &window);
    REQUIRE(child >= 0);
    if (child == 0) {
        ::unsetenv("COLUMNS");
        arguments.insert(arguments.begin(), "raya");
        ::execv(RAYA_PROGRAM, run_program_detail::pointers(arguments).data());
        ::_exit(127);
    }
    std::string text;
    std::array<char, 4096> block{};
    for (ssize_t bytes_read = 0; (bytes_read = ::read(terminal, block.data(), block.size())) > 0;)
        text.append(block.data(), static_cast<std::size_t>(bytes_read));
    int status = 0;
    ::waitpid(child, &status, 0);
    ::close(terminal);
    CHECK(WIFEXITED(status));
    CHECK(WEXITSTATUS(status) == 0);
    std::erase(text, '\r');
    return text;
}

TEST_CASE("help COMMAND: prints the same as COMMAND --help", "[cli][help]") {
    CHECK(help_of({"help"}) == help_of({"--help"}));
    CHECK(help_of({"help", "render"}) == help_of({"render", "--help"}));
    CHECK(help_of({"help", "help"}) == help_of({"help", "--help"}));
    CHECK_THAT(help_of({"help", "page"}), !Catch::Contains("script"));  // scripts are an implementation detail
}

TEST_CASE("help: the error for an unknown command names the closest command, or the help to read", "[cli][help]") {
    const ScratchFolder outputs;
    check_refused(outputs, {"help", "rendr"}, 2,
                  {"raya: help: no command rendr (did you mean render?); commands: render"});
    check_refused(outputs, {"help", "render", "fig7"}, 2, {"render has no command fig7; see raya help render"});
}

TEST_CASE("help: is as wide as COLUMNS, clamped to 40..120; by default 80 columns", "[cli][help]") {
    const std::string default_help = help_of({"help", "render"});
    CHECK(longest_line(default_help) <= 80);
    CHECK(longest_line(default_help) > 70);
    for (const char* invalid : {"0", "x", "80x", "-3", "99999999", "184467440737095516150"})
        CHECK(help_of({"help", "render"}, invalid) == default_help);
    CHECK(longest_line(help_of({"help", "render"}, "100")) > 90);
    CHECK(help_of({"help", "render"}, "10") == help_of({"help", "render"}, "40"));
    CHECK(help_of({"help", "render"}, "300") == help_of({"help", "render"}, "120"));
    CHECK(help_of({"help", "render"}, "60") != default_help);
}

TEST_CASE("help: is as wide as the terminal", "[cli][help]") {
    for (const unsigned short columns : std::initializer_list<unsigned short>{50, 97})
        CHECK(output_on_terminal({"help", "verify"}, columns) == help_of({"help", "verify"}, std::to_string(columns)));
    CHECK(output_on_terminal({"help", "verify"}, 0) == help_of({"help", "verify"}));
}

TEST_CASE("help: no line of several words is longer than the width", "[cli][help]") {
    for_each_command(text_of_all_commands(), [](const CommandText& command, const std::string& path) {
        for (const std::size_t width : {40u, 60u, 80u, 120u})
            for (const std::string& line : lines_of(help_text(command, path, width))) {
                CAPTURE(path, width, line);
                const std::size_t begin = line.find_first_not_of(' ');
                CHECK((line.size() <= width || line.find(' ', begin) == std::string::npos));
                CHECK((line.empty() || line.back() != ' '));
            }
    });
}

TEST_CASE("help: every option is below a heading; \"General options\" is the last", "[cli][help]") {
    for_each_command(text_of_all_commands(), [](const CommandText& command, const std::string& path) {
        CAPTURE(path);
        const std::vector<std::string> groups = groups_of(command);
        CHECK(std::find(groups.begin(), groups.end(), "Options") == groups.end());
        REQUIRE(!groups.empty());
        CHECK(groups.back() == "General options");
        Arguments general;
        for (const OptionText& option : command.options)
            if (option.group == groups.back()) general.push_back(option.names.back());
        for (const char* name : {"--help", "--quiet", "--verbose"})
            CHECK(std::count(general.begin(), general.end(), name) == 1);
        const bool has_short_help = std::count(general.begin(), general.end(), "--help-all") == 1;
        CHECK(has_short_help == has_short_form(command));
        CHECK(general.size() == (path == "raya" || has_short_help ? 4 : 3));  // the fourth: --version or --help-all
    });
}

TEST_CASE("help: commands with a short help have one of at most 65 lines", "[cli][help]") {
    for_each_command(text_of_all_commands(), [](const CommandText& command, const std::string& path) {
        CAPTURE(path);
        if (!has_short_form(command)) return;
        Arguments short_arguments = tokens_of(path);
        short_arguments.erase(short_arguments.begin());  // removes "raya"
        Arguments long_arguments = short_arguments;
        short_arguments.emplace_back("--help");
        long_arguments.emplace_back("--help-all");
        const std::string text = help_of(short_arguments);
        CHECK(lines_of(text).size() <= 65);
        CHECK(longest_line(text) <= 80);
        CHECK_THAT(text, Catch::Contains(path + " --help-all prints all "));
        CHECK(text == help_text(short_form(command, path), path, 80));
        CHECK(help_of(long_arguments) == help_text(command, path, 80));
    });
}

TEST_CASE("help render: has the groups of options in this order", "[cli][help]") {
    const CommandText program = text_of_all_commands();
    const auto& render = *std::find_if(program.commands.begin(), program.commands.end(),
                                       [](const CommandText& command) { return command.name == "render"; });
    CHECK(groups_of(render) == Arguments{"Files", "Image", "Camera and light", "Machine and mapping",
                                         "Kernels and device", "Torus machine", "Diagnostics", "General options"});
    const std::vector<std::pair<std::string, std::string>> expected_groups = {{"--output", "Files"},
                                                                              {"--strict", "Files"},
                                                                              {"--size", "Image"},
                                                                              {"--exposure", "Image"},
                                                                              {"--antialias", "Image"},
                                                                              {"--from", "Camera and light"},
                                                                              {"--light", "Camera and light"},
                                                                              {"--machine", "Machine and mapping"},
                                                                              {"--mapping", "Machine and mapping"},
                                                                              {"--accel", "Machine and mapping"},
                                                                              {"--format", "Kernels and device"},
                                                                              {"--device", "Kernels and device"},
                                                                              {"--no-tuned", "Kernels and device"},
                                                                              {"--nodes", "Torus machine"},
                                                                              {"--report", "Diagnostics"},
                                                                              {"--page", "Diagnostics"},
                                                                              {"--profile", "Diagnostics"},
                                                                              {"--trace", "Diagnostics"}};
    for (const auto& [name, group] : expected_groups) {
        CAPTURE(name);
        const auto option = std::find_if(render.options.begin(), render.options.end(),
                                         [&, &wanted = name](const OptionText& o) { return o.names.back() == wanted; });
        REQUIRE(option != render.options.end());
        CHECK(option->group == group);
    }
}

}  // namespace
}  // namespace raya
