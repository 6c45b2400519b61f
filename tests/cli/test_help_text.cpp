// Help of a small command line, at widths of terminals.
#include <catch2/catch.hpp>
#include <sstream>

#include "host/cli/command_text.hpp"

namespace raya {
namespace {

OptionText option(std::vector<std::string> names, std::string value, std::string help, std::string group) {
    OptionText text;
    text.names = std::move(names);
    text.value = std::move(value);
    text.help = std::move(help);
    text.group = std::move(group);
    return text;
}

CommandText small_command() {
    CommandText command;
    command.name = "draw";
    command.summary = "Draw one thing after another, each of them as it was said to be";
    command.examples = {
        {"raya draw scene.nff --output picture.png --colour red", "A red picture of a scene, in a file"},
        {"raya draw x", "Nothing"}};
    command.words = {option({"SCENE"}, "SCENE.nff", "What is drawn", "Files")};
    command.words[0].required = true;
    command.options = {option({"-o", "--output"}, "FILE", "Where it goes to; a long text that is about files", "Files"),
                       option({"--colour"}, "red|green", "What colour it has", "Looks"),
                       option({"--a-name-as-long-as-this"}, "VALUE", "What stands below its name", "Looks"),
                       option({"-q", "--quiet"}, "", "Say nothing", "Common options")};
    command.options[0].required = true;
    command.options[1].usual = "red";
    command.footer = "Exit codes: 0 done, 2 bad option or input, 3 device.\n\nEnvironment:\n  RAYA_X   what it is\n";
    return command;
}

TEST_CASE("help begins with usage, and its parts stand below headings", "[manual]") {
    CHECK(help_text(small_command(), "raya draw", 80) == R"(Usage: raya draw SCENE -o FILE [OPTIONS]

Draw one thing after another, each of them as it was said to be

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
                      What stands below its name

Common options:
  -q, --quiet         Say nothing

Exit codes: 0 done, 2 bad option or input, 3 device.

Environment:
  RAYA_X              what it is
)");
}

TEST_CASE("on a narrow terminal texts stand below names, and a shell's line goes on as a shell reads it", "[manual]") {
    CHECK(help_text(small_command(), "raya draw", 40) == R"(Usage: raya draw SCENE -o FILE [OPTIONS]

Draw one thing after another, each of
them as it was said to be

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
      What stands below its name

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

TEST_CASE("no line of help is longer than the terminal is wide, but for a word", "[manual]") {
    for (std::size_t width = 40; width <= 120; ++width)
        CHECK(longest_line(help_text(small_command(), "raya draw", width)) <= width);
    CommandText command = small_command();
    command.summary = "See " + std::string(50, 'x') + " for more";
    CHECK_THAT(help_text(command, "raya draw", 40), Catch::Contains("\nSee\n" + std::string(50, 'x') + "\nfor more\n"));
}

TEST_CASE("a command of commands lists them", "[manual]") {
    CommandText program;
    program.name = "raya";
    program.commands = {small_command()};
    CHECK(help_text(program, "raya", 80) ==
          "Usage: raya COMMAND [OPTIONS]\n\n\n\nCommands:\n  draw  Draw one thing after another, each of them as it "
          "was said to "
          "be\n");
}

}  // namespace
}  // namespace raya
