// Manual pages and completions of a small program, whose texts contain characters that man and shells interpret.
#include <catch2/catch.hpp>

#include "host/cli/command_text.hpp"
#include "host/cli/completion.hpp"

namespace raya {
namespace {

using Kind = ValueCompletion::Kind;

OptionText option(std::vector<std::string> names, std::string value, std::string help = "Says so") {
    OptionText text;
    text.names = std::move(names);
    text.placeholder = std::move(value);
    text.help = std::move(help);
    text.group = "Options";
    return text;
}

CommandText small_program() {
    CommandText draw;
    draw.name = "draw";
    draw.summary = "Draw what it's told";
    draw.options = {option({"-o", "--output"}, "FILE.json", ".png of \"a\\b\" `c` ~d^ it's [x]: see $HOME; more"),
                    option({"--way"}, "left|right")};
    draw.footer =
        "Exit codes: 0 done, 2 not.\n\nExamples:\n  raya draw -o a.json\n  raya draw --way left\n\nEnvironment:\n"
        "  RAYA_X   what it is\n";
    CommandText program;
    program.name = "raya";
    program.summary = "raya draws";
    program.commands = {draw};
    return program;
}

TEST_CASE("value_completion: the kind of a value follows from its placeholder in help", "[manual]") {
    const auto value = [](const std::string& placeholder) { return value_completion(option({"--x"}, placeholder)); };
    CHECK(value("ring|bus-broadcast").choices == std::vector<std::string>{"ring", "bus-broadcast"});
    CHECK(value("none|bvh|grid[:AxBxC]").choices == std::vector<std::string>{"none", "bvh", "grid"});
    CHECK(value("none,grid").kind == Kind::kList);
    CHECK(value("none,grid").choices == std::vector<std::string>{"none", "grid"});
    CHECK(value("FILE.json[.gz]").extensions == std::vector<std::string>{".json"});
    CHECK(value("FILE.csv.gz").extensions == std::vector<std::string>{".csv.gz"});
    for (const char* file : {"SCENE.nff", "IMAGE", "FILE.html", "FILE"}) CHECK(value(file).kind == Kind::kFile);
    CHECK(value("IMAGE").extensions.empty());
    CHECK(value("SCENE").extensions.size() == 6);
    CHECK(value("DIR").kind == Kind::kFolder);
    for (const char* text : {"N|WxH", "p", "ALPHA,BETA", "1,2,...", "NAME,...", "BYTES", ""})
        CHECK(value(text).kind == Kind::kOther);
    OptionText named = option({"--x"}, "NAME");
    named.choices = {"a", "b"};
    CHECK(value_completion(named).kind == Kind::kChoice);
    named.repeated = true;
    CHECK(value_completion(named).kind == Kind::kList);
}

TEST_CASE("brief: cuts a help text after its first part, between words", "[manual]") {
    CHECK(brief("Size in pixels; default: 5") == "Size in pixels");
    CHECK(brief("One. Two") == "One");
    CHECK(brief("as they are 1.5") == "as they are 1.5");
    const std::string cut = brief("word word word word", 12);
    CHECK(cut == "word ...");
    CHECK(brief(std::string(100, 'x'), 20) == "xxxxxxxxxxxxxxxx ...");
}

TEST_CASE("man_pages: contain the texts of help, with roff syntax escaped", "[manual]") {
    const std::vector<ManPage> pages = man_pages(small_program(), "raya 1.2");
    REQUIRE(pages.size() == 2);
    CHECK(pages[0].name == "raya");
    CHECK_THAT(pages[0].text, Catch::Contains(".SH NAME\nraya \\- draws\n") && Catch::Contains("\"raya 1.2\"") &&
                                  Catch::Contains(".BR raya\\-draw (1)\nDraw what it\\(aqs told\n"));
    CHECK(pages[1].name == "raya-draw");
    for (const char* text :
         {"\\fB\\-o\\fR, \\fB\\-\\-output\\fR \\fIFILE.json\\fR\n\\&.png of \\(dqa\\eb\\(dq \\(gac\\(ga \\(tid\\(ha "
          "it\\(aqs [x]",
          ".SH EXIT CODES\n0 done, 2 not.\n", ".SH EXAMPLES\n.PP\n.EX\n    raya draw \\-o a.json\n.EE\n",
          ".SH ENVIRONMENT\n.TP\n\\fBRAYA_X\\fR\nwhat it is\n", ".SH SEE ALSO\n.BR raya (1)\n"})
        CHECK_THAT(pages[1].text, Catch::Contains(text));
}

TEST_CASE("completion_script: quotes shell syntax", "[manual]") {
    const CommandText program = small_program();
    CHECK_THAT(completion_script(program, "bash"), Catch::Contains("'raya draw')") &&
                                                       Catch::Contains("-o|--output) value='files .json' ;;") &&
                                                       Catch::Contains("--way) value='words left right' ;;"));
    CHECK_THAT(
        completion_script(program, "zsh"),
        Catch::Contains(
            R"-('(-o --output)--output=[.png of "a\\b" `c` ~d^ it'\''s \[x\]\: see $HOME]:FILE.json:_files -g "*.json(-.)"')-"));
    CHECK_THAT(
        completion_script(program, "fish"),
        Catch::Contains(
            R"-(-s o -l output -x -a '(__fish_complete_suffix ".json")' -d '.png of "a\\b" `c` ~d^ it\'s [x]: see $HOME')-"));
    for (const std::string& shell : completed_shells()) CHECK_FALSE(completion_script(program, shell).empty());
    CHECK_THROWS(completion_script(program, "tcsh"));
}

TEST_CASE("shell_cases: commands with the same body share one case", "[manual]") {
    CHECK(shell_cases({{"a b", "x\n"}, {"c", "y\n"}, {"it's", "x\n"}}) ==
          "    'a b'|'it'\\''s')\nx\n        ;;\n    'c')\ny\n        ;;\n");
}

}  // namespace
}  // namespace raya
