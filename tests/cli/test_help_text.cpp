// help_text() of a small example program at several widths.
#include <catch2/catch.hpp>
#include <sstream>

#include "host/cli/help.hpp"
#include "tests/cli/run_program.hpp"

namespace raya {
namespace {

OptionText make_option(std::vector<std::string> names, std::string value, std::string help, std::string group) {
    OptionText text;
    text.names = std::move(names);
    text.placeholder = std::move(value);
    text.help = std::move(help);
    text.group = std::move(group);
    return text;
}

CommandText small_command() {
    CommandText command;
    command.name = "draw";
    command.summary = "Draw one object after another, in the order in which they occur";
    command.examples = {
        {"raya draw scene.nff --output picture.png --colour red", "A red picture of a scene, in a file"},
        {"raya draw x", "Nothing"}};
    command.arguments = {make_option({"SCENE"}, "SCENE.nff", "What is drawn", "Files")};
    command.arguments[0].required = true;
    command.options = {
        make_option({"-o", "--output"}, "FILE", "Where it goes to; a long text that is about files", "Files"),
        make_option({"--colour"}, "red|green", "What colour it has", "Looks"),
        make_option({"--a-name-as-long-as-this"}, "VALUE", "Its text is below its name", "Looks"),
        make_option({"-q", "--quiet"}, "", "Say nothing", "Common options")};
    command.options[0].required = true;
    command.options[1].default_value = "red";
    command.footer = "Exit codes: 0 done, 2 bad option or input, 3 device.\n\nEnvironment:\n  RAYA_X   what it is\n";
    return command;
}

TEST_CASE("help_text: usage first, then sections below headings", "[help]") {
    CHECK(help_text(small_command(), "raya draw", 80) == R"(Usage: raya draw SCENE -o FILE [OPTIONS]

Draw one object after another, in the order in which they occur

Examples:
  raya draw scene.nff --output picture.png --colour red
      A red picture of a scene, in a file
  raya draw x
      Nothing

Arguments:
  SCENE               What is drawn

Files:
  -o, --output FILE   Where it goes to; a long text that is about files

Looks:
  --colour red|green  What colour it has; default: red
  --a-name-as-long-as-this VALUE
                      Its text is below its name

Common options:
  -q, --quiet         Say nothing

Exit codes: 0 done, 2 bad option or input, 3 device.

Environment:
  RAYA_X              what it is
)");
}

TEST_CASE("help_text: in a narrow terminal texts are below names, and example lines continue with a backslash",
          "[help]") {
    CHECK(help_text(small_command(), "raya draw", 40) == R"(Usage: raya draw SCENE -o FILE [OPTIONS]

Draw one object after another, in the
order in which they occur

Examples:
  raya draw scene.nff --output \
      picture.png --colour red
      A red picture of a scene, in a
      file
  raya draw x
      Nothing

Arguments:
  SCENE
      What is drawn

Files:
  -o, --output FILE
      Where it goes to; a long text that
      is about files

Looks:
  --colour red|green
      What colour it has; default: red
  --a-name-as-long-as-this VALUE
      Its text is below its name

Common options:
  -q, --quiet
      Say nothing

Exit codes: 0 done, 2 bad option or
  input, 3 device.

Environment:
  RAYA_X
      what it is
)");
}

TEST_CASE("help_text: no line exceeds the width, except a single long word", "[help]") {
    for (std::size_t width = 40; width <= 120; ++width)
        CHECK(longest_line(help_text(small_command(), "raya draw", width)) <= width);
    CommandText command = small_command();
    command.summary = "See " + std::string(50, 'x') + " for more";
    CHECK_THAT(help_text(command, "raya draw", 40), Catch::Contains("\nSee\n" + std::string(50, 'x') + "\nfor more\n"));
}

TEST_CASE("help_text: a command with subcommands lists them", "[help]") {
    CommandText program;
    program.name = "raya";
    program.commands = {small_command()};
    CHECK(help_text(program, "raya", 80) ==
          "Usage: raya COMMAND [OPTIONS]\n\n\n\nCommands:\n  draw  Draw one object after another, in the order in "
          "which they occur\n");
}

TEST_CASE("short_form: has the options with a brief text and the general ones, and names --help-all", "[help]") {
    CommandText command = small_command();
    CHECK(help_text(short_form(command, "raya draw"), "raya draw", 80) == help_text(command, "raya draw", 80));
    command.options[1].brief = "Its colour";
    command.options[3].group = kGeneralOptions;
    CHECK(help_text(short_form(command, "raya draw"), "raya draw", 80) == help_text(command, "raya draw", 80));
    command.options.resize(8, command.options[1]);
    const CommandText text = short_form(command, "raya draw");
    REQUIRE(text.options.size() == 6);
    CHECK(text.options[0].names.back() == "--colour");
    CHECK(text.options[0].help == "Its colour");
    CHECK(text.options[1].help == command.options[3].help);
    CHECK(text.footer.starts_with("raya draw --help-all prints all 8 options in full.\n\nExit codes: "));
}

}  // namespace
}  // namespace raya
