// Every option of every command with values that nobody means: one line that names the option, exit code 2, and no
// internal error. In this process, as there are thousands of cases.
#include <catch2/catch.hpp>
#include <set>

#include "host/cli/parse_failure.hpp"
#include "host/error.hpp"
#include "tests/base/scratch_folder.hpp"
#include "tests/cli/run_program.hpp"
#include "tests/cli/whole_tree.hpp"
#include "tests/thorough.hpp"

namespace raya {
namespace {

constexpr const char* kNoDevice = "no-such-device";
const Words kOddValues = {"x", "-1", "1e400", "99999999999999999999", "nan", "\x1b[31m"};

struct Command {
    Words path;  // "generate", "balls"
    CommandText text;
};

std::vector<Command> all_commands() {
    std::vector<Command> commands;
    for_each_command(tree_of_all(), [&](const CommandText& command, const std::string& path) {
        std::istringstream words(path);
        commands.push_back({Words(std::istream_iterator<std::string>(words), {}), command});
        commands.back().path.erase(commands.back().path.begin());  // raya
    });
    return commands;
}

Words operator+(Words words, const Words& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

struct Opened : CLI::App {
    using CLI::App::final_callback_;
};

/// What the program says of these words; "" if it takes them. Other exceptions than a refusal end the test.
std::string refusal(const Words& words, bool runs) {
    const std::shared_ptr<CLI::App> program = parser_of_all();
    if (!runs)
        for (CLI::App* at = program.get(); at != nullptr;) {
            at->callback([kept = at->*(&Opened::final_callback_)] {});  // it owns what the options fill
            const auto next = at->get_subcommands([&](const CLI::App* one) {
                return std::find(words.begin(), words.end(), one->get_name()) != words.end();
            });
            at = next.empty() ? nullptr : next.front();
        }
    try {
        parse_words(*program, words);
    } catch (const UserError& error) {
        return error.what();
    }
    return "";
}

bool names_option(const std::string& text, const OptionText& option) {
    return std::any_of(option.names.begin(), option.names.end(),
                       [&](const std::string& name) { return contains(text, name); });
}

void check_refused_in_words(const Words& words, const OptionText& option, bool runs = false) {
    const std::string text = refusal(words, runs);
    std::string line;
    for (const std::string& word : words) line += word.substr(0, 60) + ' ';
    INFO(line << "\n" << text);
    CHECK_FALSE(text.empty());
    CHECK(text.size() < 2000);
    CHECK_FALSE(contains(text, "\n"));
    CHECK(names_option(text, option));
}

TEST_CASE("a flag takes no value, whatever it is", "[cli][every]") {
    for (const Command& command : all_commands())
        for (const OptionText& option : command.text.options)
            if (option.is_flag())
                for (const std::string& name : option.names)
                    for (const std::string& value : by_turns(kOddValues + Words{"", "true", "none", "2", "{}"}))
                        check_refused_in_words(command.path + Words{name + '=' + value}, option);
}

TEST_CASE("an option takes no empty value, none that is too long, and one value once", "[cli][every]") {
    for (const Command& command : all_commands())
        for (const OptionText& option : command.text.options) {
            if (option.is_flag()) continue;
            const std::string& name = option.names.back();
            const std::vector<Words> refused = {
                {name + '='},           {name + '=', "1"}, {name, ""}, {name}, {name, std::string(1 << 20, 'x')},
                {name + '=' + std::string(1 << 20, '9')}};
            for (const Words& words : by_turns(refused)) check_refused_in_words(command.path + words, option);
            if (!option.repeated) check_refused_in_words(command.path + Words{name, "1", name, "1"}, option);
        }
}

TEST_CASE("odd values of every option are refused, or are legal: no internal error", "[cli][every]") {
    for (const Command& command : all_commands())
        for (const OptionText& option : command.text.options)
            for (const std::string& value : by_turns(kOddValues))
                if (!option.is_flag()) CHECK_NOTHROW(refusal(command.path + Words{option.names.back(), value}, false));
}

TEST_CASE("odd values of render's options are refused before a device is asked for", "[cli][every]") {
    const ScratchFolder folder;
    const std::set<std::string> any_text = {"--output", "--device", "--kernel-dir"};
    const std::set<std::string> may_be_negative = {"--exposure", "--turn"};
    const auto commands = all_commands();
    const auto render =
        std::find_if(commands.begin(), commands.end(), [](const Command& c) { return c.path == Words{"render"}; });
    for (const OptionText& option : render->text.options) {
        const std::string& name = option.names.back();
        const bool is_file = contains(option.value, "FILE") || contains(option.value, "IMAGE");
        if (option.is_flag() || is_file || any_text.count(name) > 0) continue;
        for (const std::string& value : kOddValues)
            if (value != "-1" || may_be_negative.count(name) == 0)
                check_refused_in_words(
                    {"render", scene_file("planes"), "-o", folder / "x.ppm", "--device", kNoDevice, name, value},
                    option, true);
    }
}

TEST_CASE("the words behind -- are arguments, and a refusal says so", "[cli][every]") {
    CHECK_THAT(refusal({"render", "--", "-x.nff", "--size", "16"}, false),
               Catch::Contains("unexpected argument '--size' after --"));
    CHECK(refusal({"render", "-o", "x.ppm", "--size", "16", "--", "-x.nff"}, false).empty());
    CHECK_THAT(refusal({"info", "--", "-x.nff"}, true), Catch::StartsWith("-x.nff: "));
}

TEST_CASE("the word that was meant is named for values, options and commands", "[cli][every]") {
    const auto of_render = [&](const std::string& option, const std::string& value) {
        return refusal({"render", scene_file("planes"), "-o", "x.ppm", "--device", kNoDevice, option, value}, true);
    };
    CHECK_THAT(of_render("--machine", "sap"), Catch::Contains("--machine sap (did you mean spa?): no such machine"));
    CHECK_THAT(of_render("--mapping", "block"), Catch::Contains("(did you mean blocks?)"));
    CHECK_THAT(of_render("--accel", "gird"), Catch::Contains("(did you mean grid?)"));
    CHECK_THAT(of_render("--fold", "blok"), Catch::Contains("(did you mean block?)"));
    CHECK_THAT(of_render("--format", "sap22"), Catch::Contains("(did you mean spa22?)"));
    CHECK_THAT(of_render("--tone", "rheinhard"), Catch::Contains("(did you mean reinhard?)"));
    CHECK_THAT(of_render("--mapping", "grid:4"), !Catch::Contains("did you mean"));
    CHECK_THAT(of_render("--width", "4"), Catch::Contains("no option --width (did you mean --size?)"));
    CHECK_THAT(refusal({"version"}, false), Catch::Contains("no command version (did you mean --version?)"));
}

}  // namespace
}  // namespace raya
