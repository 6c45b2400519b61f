// Every option of every command with unusual values: raya accepts the value, or refuses it in one line that names the
// option, and never ends with an internal error. The parser runs in this process, because there are thousands of cases.
#include <catch2/catch.hpp>
#include <set>

#include "host/cli/parse.hpp"
#include "host/error.hpp"
#include "tests/base/scratch_folder.hpp"
#include "tests/cli/all_commands.hpp"
#include "tests/cli/run_program.hpp"
#include "tests/thorough.hpp"

namespace raya {
namespace {

constexpr const char* kNoDevice = "no-such-device";
const Arguments kOddValues = {"x", "-1", "1e400", "99999999999999999999", "nan", "\x1b[31m"};

struct Command {
    Arguments path;  // {"generate", "balls"}
    CommandText text;
};

std::vector<Command> all_commands() {
    std::vector<Command> commands;
    for_each_command(text_of_all_commands(), [&](const CommandText& command, const std::string& path) {
        std::istringstream tokens(path);
        commands.push_back({Arguments(std::istream_iterator<std::string>(tokens), {}), command});
        commands.back().path.erase(commands.back().path.begin());  // removes "raya"
    });
    return commands;
}

Arguments operator+(Arguments arguments, const Arguments& extra_arguments) {
    arguments.insert(arguments.end(), extra_arguments.begin(), extra_arguments.end());
    return arguments;
}

// Returns command and subcommand with the arguments that they require besides `option`: newer versions of CLI11 report
// missing ones first.
Arguments start_of(const Command& command, const OptionText& option) {
    Arguments arguments = command.path;
    for (const auto& group : {command.text.arguments, command.text.options})
        for (const OptionText& other : group) {
            if (!other.required || other.names == option.names) continue;
            if (!other.is_argument()) arguments.push_back(other.names.back());
            arguments.push_back(other.choices.empty() ? "8" : other.choices.front());
        }
    return arguments;
}

struct ExposedApp : CLI::App {
    using CLI::App::final_callback_;
};

/// Returns the message with which the program refuses the arguments; "" if it accepts them. `runs_command`: also
/// runs the command's callback. Exceptions other than UserError end the test.
std::string refusal(const Arguments& arguments, bool runs_command) {
    const std::shared_ptr<CLI::App> program = make_full_parser();
    if (!runs_command)
        for (CLI::App* command = program.get(); command != nullptr;) {
            command->callback(
                [owner = command->*(&ExposedApp::final_callback_)] {});  // keeps the options' variables alive
            const auto selected = command->get_subcommands([&](const CLI::App* subcommand) {
                return std::find(arguments.begin(), arguments.end(), subcommand->get_name()) != arguments.end();
            });
            command = selected.empty() ? nullptr : selected.front();
        }
    try {
        parse_arguments(*program, arguments);
    } catch (const UserError& error) {
        return error.what();
    }
    return "";
}

bool names_option(const std::string& text, const OptionText& option) {
    return std::any_of(option.names.begin(), option.names.end(),
                       [&](const std::string& name) { return contains(text, name); });
}

void check_refused_in_process(const Arguments& arguments, const OptionText& option, bool runs_command = false) {
    const std::string text = refusal(arguments, runs_command);
    std::string line;
    for (const std::string& argument : arguments) line += argument.substr(0, 60) + ' ';
    INFO(line << "\n" << text);
    CHECK_FALSE(text.empty());
    CHECK(text.size() < 2000);
    CHECK_FALSE(contains(text, "\n"));
    CHECK(names_option(text, option));
}

TEST_CASE("every flag: refuses a value", "[cli][every]") {
    for (const Command& command : all_commands())
        for (const OptionText& option : command.text.options)
            if (option.is_flag())
                for (const std::string& name : option.names)
                    for (const std::string& value :
                         quick_rotating(kOddValues + Arguments{"", "true", "none", "2", "{}"}))
                        check_refused_in_process(start_of(command, option) + Arguments{name + '=' + value}, option);
}

TEST_CASE("every option: refuses an empty value, a value of 1 MB, and two values", "[cli][every]") {
    for (const Command& command : all_commands())
        for (const OptionText& option : command.text.options) {
            if (option.is_flag()) continue;
            const std::string& name = option.names.back();
            const std::vector<Arguments> refused = {{name + '='},
                                                    {name + '=', "1"},
                                                    {name, ""},
                                                    {name},
                                                    {name, std::string(1 << 20, 'x')},
                                                    {name + '=' + std::string(1 << 20, '9')}};
            for (const Arguments& arguments : quick_rotating(refused))
                check_refused_in_process(start_of(command, option) + arguments, option);
            if (!option.repeated)
                check_refused_in_process(start_of(command, option) + Arguments{name, "1", name, "1"}, option);
        }
}

TEST_CASE("every option: odd values cause no internal error", "[cli][every]") {
    for (const Command& command : all_commands())
        for (const OptionText& option : command.text.options)
            for (const std::string& value : quick_rotating(kOddValues))
                if (!option.is_flag())
                    CHECK_NOTHROW(refusal(command.path + Arguments{option.names.back(), value}, false));
}

TEST_CASE("render: refuses odd values before it opens a device", "[cli][every]") {
    const ScratchFolder folder;
    const std::set<std::string> accept_any_text = {"--output", "--device", "--kernel-dir"};
    const std::set<std::string> accept_negative = {"--exposure"};
    const auto commands = all_commands();
    const auto render =
        std::find_if(commands.begin(), commands.end(), [](const Command& c) { return c.path == Arguments{"render"}; });
    for (const OptionText& option : render->text.options) {
        const std::string& name = option.names.back();
        const bool is_file = contains(option.placeholder, "FILE") || contains(option.placeholder, "IMAGE");
        if (option.is_flag() || is_file || accept_any_text.count(name) > 0) continue;
        for (const std::string& value : kOddValues)
            if (value != "-1" || accept_negative.count(name) == 0)
                check_refused_in_process(
                    {"render", scene_file("planes"), "-o", folder / "x.ppm", "--device", kNoDevice, name, value},
                    option, true);
    }
}

TEST_CASE("--: arguments after -- are positional", "[cli][every]") {
    CHECK(!refusal({"render", "--", "-x.nff", "--size", "16"}, false).empty());
    CHECK(refusal({"render", "-o", "x.ppm", "--size", "16", "--", "-x.nff"}, false).empty());
    CHECK_THAT(refusal({"info", "--", "-x.nff"}, true), Catch::StartsWith("-x.nff: "));
}

TEST_CASE("refusals: name the closest value, option or command", "[cli][every]") {
    const auto render_refusal = [&](const std::string& option, const std::string& value) {
        return refusal({"render", scene_file("planes"), "-o", "x.ppm", "--device", kNoDevice, option, value}, true);
    };
    CHECK_THAT(render_refusal("--machine", "sap"),
               Catch::Contains("--machine sap (did you mean spa?): no such machine"));
    CHECK_THAT(render_refusal("--mapping", "block"), Catch::Contains("(did you mean blocks?)"));
    CHECK_THAT(render_refusal("--accel", "gird"), Catch::Contains("(did you mean grid?)"));
    CHECK_THAT(render_refusal("--fold", "blok"), Catch::Contains("(did you mean block?)"));
    CHECK_THAT(render_refusal("--format", "sap22"), Catch::Contains("(did you mean spa22?)"));
    CHECK_THAT(render_refusal("--mapping", "grid:4"), !Catch::Contains("did you mean"));
    CHECK_THAT(refusal({"version"}, false), Catch::Contains("no command version (did you mean --version?)"));
}

}  // namespace
}  // namespace raya
