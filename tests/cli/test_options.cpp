// Every option of every command, from the rows of the parser: help and examples; unusual values; no output overwrites
// an input or another output. The parser runs in this process, because there are thousands of cases.
#include <catch2/catch.hpp>
#include <filesystem>
#include <regex>

#include "host/base/whole_file.hpp"
#include "host/cli/help.hpp"
#include "host/cli/parse.hpp"
#include "host/error.hpp"
#include "tests/base/scratch_folder.hpp"
#include "tests/cli/all_commands.hpp"
#include "tests/kernels/write_kernels.hpp"
#include "tests/thorough.hpp"

namespace raya {
namespace {
namespace fs = std::filesystem;

struct Accepted {};  // thrown instead of running the command

/// Returns the message with which the program refuses the arguments; "" if it accepts them. `runs`: also checks files
/// and runs the command. Exceptions other than UserError end the test.
std::string refusal(const Arguments& arguments, bool runs = false) {
    const std::shared_ptr<CLI::App> program = make_full_parser();
    if (!runs) program->parse_complete_callback([] { throw Accepted{}; });
    try {
        parse_arguments(*program, arguments);
    } catch (const UserError& error) {
        return error.what();
    } catch (const Accepted&) {
    }
    return "";
}

void check_refused_in_process(const Arguments& arguments, const CLI::Option& option, bool runs = false) {
    const std::string text = refusal(arguments, runs);
    std::string line;
    for (const std::string& argument : arguments) line += argument.substr(0, 60) + ' ';
    INFO(line << "\n" << text.substr(0, 2000));
    CHECK_FALSE(contains(text, "\n"));
    bool is_named = contains(text, option.get_name());
    for (const std::string& name : option.get_snames()) is_named = is_named || contains(text, "-" + name);
    CHECK(is_named);
}

/// Returns the command with arguments for all that it requires, except `options`, whose values are `values`.
Arguments required(CLI::App& command, Arguments arguments, const Arguments& options, const Arguments& values = {},
                   const std::string& folder = "x/") {
    for (const CLI::Option* option : command.get_options()) {
        const std::string name = option->get_name();
        const auto at = std::find(options.begin(), options.end(), name);
        const bool is_given = at != options.end();
        if (is_given ? values.empty() : !option->get_required()) continue;
        if (!option->get_positional()) arguments.push_back(name);
        arguments.push_back(is_given ? values[static_cast<std::size_t>(at - options.begin())]
                            : contains("COUNT XxYxZ", option->get_type_name()) ? "5"
                                                                               : folder + name);
    }
    return arguments;
}

/// Calls `each(command, path, option)` for every option, without positional arguments.
void for_each_option(const std::function<void(CLI::App&, const Arguments&, const CLI::Option&)>& each) {
    const auto program = make_full_parser();
    for_each_command(*program, [&](CLI::App& command, const Arguments& path) {
        for (const CLI::Option* option : listed_options(command))
            if (!option->get_positional()) each(command, path, *option);
    });
}

const Arguments kOddValues = {"x", "-1", "1e400", "99999999999999999999", "nan", "\x1b[31m"};

TEST_CASE("every flag refuses a value; every option refuses none, an empty one and two; odd ones cause no other error",
          "[cli][every]") {
    for_each_option([](CLI::App& command, const Arguments& path, const CLI::Option& option) {
        const Arguments start = required(command, path, {option.get_name()});
        const std::string name = option.get_name();
        if (option.get_items_expected_max() == 0) {
            for (const std::string& value : quick_rotating(kOddValues + Arguments{"", "true", "none", "2"}))
                check_refused_in_process(start + Arguments{name + '=' + value}, option);
            return;
        }
        for (const Arguments& refused : quick_rotating(std::vector<Arguments>{{name + '='}, {name, ""}, {name}}))
            check_refused_in_process(start + refused, option);
        if (option.get_items_expected_max() == 1 && option.get_delimiter() == '\0')
            check_refused_in_process(start + Arguments{name, "1", name, "1"}, option);
        for (const std::string& value : quick_rotating(kOddValues))
            CHECK_NOTHROW(refusal(start + Arguments{name, value}));
    });
}

TEST_CASE("render: refuses odd values before it opens a device", "[cli][every]") {
    const ScratchFolder folder;
    const Arguments any_text = {"--output", "--device", "--kernel-dir"};
    for_each_option([&](CLI::App& command, const Arguments&, const CLI::Option& option) {
        const std::string name = option.get_name();
        const bool is_file = std::regex_search(option.get_type_name(), std::regex("FILE|IMAGE"));
        if (command.get_name() != "render" || option.get_items_expected_max() == 0 || is_file) return;
        if (std::find(any_text.begin(), any_text.end(), name) != any_text.end()) return;
        for (const std::string& value : kOddValues)
            if (value != "-1" || name != "--exposure")
                check_refused_in_process(
                    {"render", scene_file("planes"), "-o", folder / "x.ppm", "--device", "no-such-device", name, value},
                    option, true);
    });
}

/// Returns the arguments of each call of raya in a shell command line.
std::vector<Arguments> calls_in(const std::string& line) {
    std::vector<Arguments> calls;
    bool in_call = false;
    for (const std::string& token : tokens_of(std::regex_replace(line, std::regex("<\\(|\\)|>|\\|"), " | "))) {
        if (token == "raya")
            calls.emplace_back();
        else if (in_call && token != "|" && token != "&&")
            calls.back().push_back(token);
        in_call = token == "raya" || (in_call && token != "|" && token != "&&");
    }
    return calls;
}

TEST_CASE("help: two examples that the parser accepts, 80 columns, options below headings; short help of 65 lines",
          "[cli][help]") {
    const auto program = make_full_parser();
    const auto& formatter = dynamic_cast<HelpFormatter&>(*program->get_formatter());
    for_each_command(*program, [&](CLI::App& command, const Arguments& path) {
        CAPTURE(path);
        for (const CLI::AppFormatMode mode : {CLI::AppFormatMode::Normal, CLI::AppFormatMode::All}) {
            const std::vector<std::string> lines = lines_of(formatter.make_help(&command, "raya", mode));
            CHECK((mode == CLI::AppFormatMode::All || !has_short_help(command) || lines.size() <= 65));
            for (const std::string& line : lines)
                CHECK((line.size() <= 80 || line.find(' ', line.find_first_not_of(' ')) == std::string::npos));
        }
        CHECK(listed_options(command).back()->get_group() == kGeneralOptions);
        for (const CLI::Option* option : listed_options(command))
            CHECK((option->get_positional() || option->get_group() != "Options"));
        const std::vector<ExampleText>& examples = formatter.examples.at(&command);
        CHECK(examples.size() == 2);
        for (const ExampleText& example : examples) {
            CAPTURE(example.command);
            CHECK(!example.description.empty());
            CHECK(!calls_in(example.command).empty());
            for (const Arguments& call : calls_in(example.command)) {
                if (call.front() != "study" && call.back() != "--help") CHECK(refusal(call) == "");
                for (const std::string& argument : call)
                    if (argument.starts_with("scenes/")) CHECK(fs::exists(fs::path(RAYA_SOURCE_DIR) / argument));
            }
        }
    });
    CHECK(calls_in("a=b raya x -o - | raya y >z && raya w") == std::vector<Arguments>{{"x", "-o", "-"}, {"y"}, {"w"}});
    CHECK(refusal({"render", "x.nff", "-o", "x.png", "--no-such-option"}) != "");
}

// The pairs of options [first, second] of a command with these uses.
std::vector<Arguments> pairs_of(const CLI::App& command, FileUse first_use, FileUse second_use) {
    std::vector<Arguments> pairs;
    for (const CLI::Option* a : command.get_options())
        for (const CLI::Option* b : command.get_options())
            if (file_use_of(*a) == first_use && file_use_of(*b) == second_use &&
                (first_use != second_use || a->get_name() < b->get_name()))
                pairs.push_back({a->get_name(), b->get_name()});
    return pairs;
}

TEST_CASE("file options: every option that names a file declares its use; no command overwrites a file of its own",
          "[cli][file_options]") {
    const auto program = make_full_parser();
    const ScratchFolder others, kernels;
    write_kernels(kernels.path());
    const std::string kernel = kernels / "ring/trace.cl";
    fs::create_symlink(fs::path(kernel), others / "kernel_link");
    std::size_t pairs = 0;
    for_each_command(*program, [&](CLI::App& command, const Arguments& path) {
        for (const CLI::Option* option : command.get_options()) {
            CAPTURE(path, option->get_name());
            const bool names_file =
                std::regex_search(option->get_type_name(), std::regex("FILE|IMAGE|SCENE|DIR|REPORT"));
            CHECK((file_use_of(*option) != FileUse::kNone) == names_file);
        }
        const auto check = [&](FileUse first, FileUse second, const Arguments& values) {
            for (const Arguments& options : pairs_of(command, first, second)) {
                ++pairs;
                const Arguments arguments = required(command, path, options, values, others / "");
                CAPTURE(arguments);
                const std::string message = refusal(arguments, true);
                for (const std::string& option : options) CHECK_THAT(message, Catch::Contains(option));
            }
        };
        const Arguments names = {"file", "./file", "sub/../file", "folder_link/file", "link", "link2", "hard"};
        for (const std::string& name : quick_rotating(names))
            for (const auto& [use, exists] :
                 {std::pair{FileUse::kRead, true}, {FileUse::kWritten, true}, {FileUse::kWritten, false}}) {
                const ScratchFolder folder;  // a new one, because the process remembers inputs
                fs::create_directory(folder / "sub");
                fs::create_directory_symlink(".", folder / "folder_link");
                fs::create_symlink("file", folder / "link");
                fs::create_symlink(fs::path(folder / "link"), folder / "link2");
                if (exists) write_whole_file(folder / "file", "content");
                if (exists) fs::create_hard_link(folder / "file", folder / "hard");
                // An output replaces a link to nothing.
                if (!exists && (name == "hard" || name.starts_with("link"))) continue;
                check(use, FileUse::kWritten, {folder / "file", folder / name});
                check(use, FileUse::kWritten, {folder / name, folder / "file"});
                if (use == FileUse::kRead) check(use, FileUse::kWrittenFolder, {folder / name, folder.path()});
                CHECK((!exists || file_contents(folder / "file") == "content"));
            }
        for (const std::string& name : {kernel, (others / "kernel_link").string()})
            check(FileUse::kKernelFolder, FileUse::kWritten, {kernels.path(), name});
    });
    CHECK(pairs > 100);
}

}  // namespace
}  // namespace raya
