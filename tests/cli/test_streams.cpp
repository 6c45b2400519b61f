// The file name "-": stdin for a scene, stdout for one output file. The summary then goes to stderr.
#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <filesystem>

#include "tests/base/gunzip.hpp"
#include "tests/cli/refusals.hpp"
#include "tests/cli/render_files.hpp"

namespace raya {
namespace {

/// Runs command lines in `folder` with a shell and returns their exit codes.
struct Shell {
    const ScratchFolder& folder;

    int operator()(const std::string& line) const {
        const std::string command = "cd '" + folder.path().string() + "' && " + line;
        const int status = std::system(command.c_str());
        return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    }
};

const std::string kRaya = std::string("'") + RAYA_PROGRAM + "' ";
const std::string kRender = kRaya + "render ";
// Quoted for a shell: folders may have blanks in their names.
const std::string kScene = "'" + scene_file("planes") + "'";
const std::string kSmallOptions = " --size 12 --pes 12 --lanes 4 ";

TEST_CASE("render - -o -: reads stdin and writes stdout with the same bytes as files", "[cli]") {
    const ScratchFolder folder;
    const Shell shell{folder};
    REQUIRE(shell(kRender + kScene + " -o a.ppm --report a.json --quiet" + kSmallOptions) == 0);
    REQUIRE(shell("cat " + kScene + " | " + kRender + "- -o - --report b.json" + kSmallOptions + "> b.ppm 2> log") ==
            0);
    CHECK(file_contents(folder / "b.ppm") == file_contents(folder / "a.ppm"));
    const std::string log = file_contents(folder / "log");
    CHECK(contains(log, "stdin: 12 x 12 pixels"));
    CHECK(contains(log, "image   stdout ("));
    const Document report = json_of(folder / "b.json");
    CHECK(report["scene"] == "stdin");
    CHECK(report["image"]["file"] == "stdout");
    CHECK(report["image"]["hash"] == json_of(folder / "a.json")["image"]["hash"]);
    REQUIRE(shell(kRender + "- -o - --quiet" + kSmallOptions + "< " + kScene + " > c.ppm 2> log") == 0);
    CHECK(file_contents(folder / "c.ppm") == file_contents(folder / "a.ppm"));
    CHECK(file_contents(folder / "log").empty());
}

TEST_CASE("render: every output file can go to stdout", "[cli]") {
    const ScratchFolder folder;
    const Shell shell{folder};
    const auto stdout_of = [&](const std::string& option, const std::string& file,
                               const std::string& extra_options = "") {
        CAPTURE(option);
        REQUIRE(shell(kRender + kScene + " -o x.ppm " + option + " " + file + kSmallOptions + extra_options +
                      "> log") == 0);
        REQUIRE(shell(kRender + kScene + " -o x.ppm " + option + " -" + kSmallOptions + extra_options +
                      "> out 2> log") == 0);
        CHECK(contains(file_contents(folder / "log"), "rays    "));
        return file_contents(folder / "out");
    };
    const std::string cost = stdout_of("--cost", "cost.pfm");
    CHECK(cost == file_contents(folder / "cost.pfm"));
    const Document report = Document::parse(stdout_of("--report", "r.json"));
    CHECK(report["image"]["hash"] == json_of(folder / "r.json")["image"]["hash"]);
    const std::string mask = stdout_of("--mask", "m.ppm", "--antialias supersample ");
    CHECK(mask == file_contents(folder / "m.ppm"));
    CHECK(Document::parse(stdout_of("--trace", "t.json")).is_object());
}

TEST_CASE("render --packets -: writes the same bytes to stdout as to a file", "[cli]") {
    const ScratchFolder folder;
    const Shell shell{folder};
    const std::string line = kRender + kScene + " -o x.ppm --machine torus --nodes 2x1x1 --size 8 --lanes 4 ";
    REQUIRE(shell(line + "--packets p.csv.gz > log") == 0);
    REQUIRE(shell(line + "--packets - > out 2> log") == 0);
    CHECK(file_contents(folder / "out") == file_contents(folder / "p.csv.gz"));
    CHECK_FALSE(gunzip(file_contents(folder / "out")).empty());
}

TEST_CASE("explore -o -: writes the same page to stdout as to a file", "[cli]") {
    const ScratchFolder folder;
    const Shell shell{folder};
    const std::string line = kRaya + "explore " + kScene + kSmallOptions;
    REQUIRE(shell(line + "-o a.html --quiet") == 0);
    REQUIRE(shell(line + "-o - > b.html 2> log") == 0);
    CHECK((file_contents(folder / "b.html") == file_contents(folder / "a.html")));
    CHECK(contains(file_contents(folder / "log"), "page    stdout"));
    REQUIRE(shell(line + "-o c.html --quiet --from 3,-6,4") == 0);
    CHECK((file_contents(folder / "c.html") != file_contents(folder / "a.html")));
    CHECK(contains(file_contents(folder / "c.html"), "--from 3,-6,4"));
}

TEST_CASE("generate, info, verify, bench: read stdin and write stdout", "[cli]") {
    const ScratchFolder folder;
    const Shell shell{folder};
    REQUIRE(shell(kRaya + "generate random 5 -o s.nff") == 0);
    REQUIRE(shell(kRaya + "generate random 5 -o - > out.nff") == 0);
    CHECK(file_contents(folder / "out.nff") == file_contents(folder / "s.nff"));
    REQUIRE(shell(kRaya + "generate random 5 -o - | " + kRaya + "info - --json > info.json") == 0);
    CHECK(json_of(folder / "info.json")["objects"]["spheres"] == 5);
    REQUIRE(shell(kRaya + "verify --only 'machine bus' --lanes 4 --report - > v.json 2> log") == 0);
    CHECK(json_of(folder / "v.json")["devices"][0]["right"] == true);
    CHECK(contains(file_contents(folder / "log"), "PASS"));
    const auto bench = [&](const std::string& scene) {
        return kRaya + "bench " + scene + " --format fp32 --samples 1" + kSmallOptions;
    };
    REQUIRE(shell(bench("-") + "--report - < s.nff > piped.json 2> log") == 0);
    CHECK(contains(file_contents(folder / "log"), "Mrays/s"));
    REQUIRE(shell(bench("s.nff") + "--report - > named.json 2> log") == 0);
    CHECK(json_of(folder / "piped.json")["rows"][0]["hash"] == json_of(folder / "named.json")["rows"][0]["hash"]);
    CHECK(shell(bench("s.nff") + "--compare - --tolerance 100 < named.json > log") == 0);
    CHECK(shell(bench("-") + "--compare - < named.json 2> log") == 2);
    CHECK(contains(file_contents(folder / "log"), "stdin can be read only once"));
    if (!RAYA_STUDIES) return;
    CHECK(shell(kRaya + "study formats - - -o d < s.nff 2> log") == 2);
    CHECK(contains(file_contents(folder / "log"), "stdin can be read only once"));
}

TEST_CASE("./-: names a file in the current folder", "[cli]") {
    const ScratchFolder folder;
    const Shell shell{folder};
    std::filesystem::copy(scene_file("planes"), folder / "-");
    REQUIRE(shell(kRender + "./- -o a.ppm --report ./-.json" + kSmallOptions + "> log") == 0);
    CHECK(json_of(folder / "-.json")["scene"] == "./-");
    REQUIRE(shell(kRaya + "generate random 5 -o ./- > log") == 0);
    CHECK(file_contents(folder / "log").empty());
    CHECK(contains(file_contents(folder / "-"), "s "));
}

TEST_CASE("-: refused for two outputs, two inputs, and files that cannot be streams", "[cli]") {
    const ScratchFolder outputs;
    const std::string scene = scene_file("planes");
    for (const Arguments& options : {Arguments{"-o", "-", "--report", "-"}, Arguments{"-o", "-", "--cost", "-"},
                                     Arguments{"-o", "x.pfm", "--cost", "-", "--trace", "-"}}) {
        Arguments arguments = {"render", scene};
        arguments.insert(arguments.end(), options.begin(), options.end());
        check_refused(outputs, arguments, 2, {"only one file can go to stdout"});
    }
    check_refused(outputs, {"bench", "--compare", "-"}, 2, {"stdin: not valid JSON"});
    check_refused(outputs, {"tune", "-"}, 2, {"tune -: ", "name a file"});
}

TEST_CASE("-: no output overwrites the file behind redirected stdin or stdout", "[cli][file_options]") {
    const ScratchFolder folder;
    const Shell shell{folder};
    std::filesystem::copy(scene_file("planes"), folder / "s.nff");
    const auto refused = [&](const std::string& line, const std::string& message) {
        CAPTURE(line);
        CHECK(shell(kRaya + line + " 2> log") == 2);
        CHECK_THAT(file_contents(folder / "log"), Catch::Contains(message));
        CHECK(file_contents(folder / "s.nff") == file_contents(scene_file("planes")));
    };
    refused("bench - --report s.nff < s.nff", "--report s.nff: would overwrite the input SCENE -");
    refused("render s.nff -o - >> s.nff", "--output -: would overwrite the input SCENE s.nff");
    refused("render s.nff -o - --report x >> x", "--report x: the same file as --output -");
    refused("render s.nff -o - --report - >> x", "only one file can go to stdout");
}

TEST_CASE("-: messages name stdin and the line", "[cli]") {
    const ScratchFolder folder;
    const Shell shell{folder};
    CHECK(shell("printf 'v\\nfrom 0 0 x\\n' | " + kRender + "- -o x.ppm 2> log") == 2);
    CHECK(contains(file_contents(folder / "log"), "raya: stdin:2: "));
    CHECK(shell(kRender + "- -o x.ppm < /dev/null 2> log") == 2);
    CHECK(contains(file_contents(folder / "log"), "raya: stdin:1: no 'v'"));
    CHECK(shell(kRender + "- -o x.ppm <&- 2> log") == 2);
    CHECK(shell(kRender + "- -o x.ppm < . 2> log") == 2);
    CHECK(contains(file_contents(folder / "log"), "stdin: cannot read the scene"));
    CHECK(shell("(echo 'la 1 1 1'; cat " + kScene + ") | " + kRaya + "info - > out 2> log") == 0);
    CHECK(contains(file_contents(folder / "log"), "warning: stdin:1: entity 'la'"));
    CHECK(contains(file_contents(folder / "out"), "skipped stdin:1: entity 'la'"));
}

TEST_CASE("-o -: a failed write to stdout causes exit code 2", "[cli]") {
    const ScratchFolder folder;
    const Shell shell{folder};
    for (const std::string redirection : {"> /dev/full", ">&-"}) {
        CAPTURE(redirection);
        CHECK(shell(kRender + kScene + " -o - --quiet" + kSmallOptions + redirection + " 2> log") == 2);
        CHECK(contains(file_contents(folder / "log"), "cannot write 'stdout'"));
        CHECK(shell(kRaya + "generate random 5 -o - " + redirection + " 2> log") == 2);
    }
    CHECK(shell(kRaya + "generate random 5 -o - 2>&- > out.nff") == 0);
    CHECK(contains(file_contents(folder / "out.nff"), "s "));
}

/// A pseudoterminal, with its master end in this process.
struct Terminal {
    Terminal() {
        REQUIRE(master >= 0);
        REQUIRE(::grantpt(master) == 0);
        REQUIRE(::unlockpt(master) == 0);
        slave = ::open(::ptsname(master), O_RDWR | O_NOCTTY);
        REQUIRE(slave >= 0);
    }
    Terminal(const Terminal&) = delete;
    Terminal& operator=(const Terminal&) = delete;
    ~Terminal() {
        ::close(slave);
        ::close(master);
    }
    std::string name() const { return ::ptsname(master); }
    void type(const std::string& text) const {
        REQUIRE(::write(master, text.data(), text.size()) == static_cast<ssize_t>(text.size()));
    }

    int master = ::posix_openpt(O_RDWR | O_NOCTTY), slave = -1;
};

TEST_CASE("-: a message says that raya reads a terminal; binary output to a terminal is refused", "[cli]") {
    const ScratchFolder folder;
    const Shell shell{folder};
    const Terminal terminal;
    terminal.type("v\nfrom 0 -5 1\nat 0 0 1\nup 0 0 1\nangle 40\nhither 1\nresolution 8 8\ns 0 0 0 1\n\x04");
    CHECK(shell(kRaya + "info - < " + terminal.name() + " > out 2> log") == 0);
    CHECK(contains(file_contents(folder / "log"), "raya: reading stdin from the terminal; end with Ctrl-D"));
    CHECK(contains(file_contents(folder / "out"), "stdin: 1 object: 1 sphere"));
    CHECK(shell(kRender + kScene + " -o -" + kSmallOptions + "> " + terminal.name() + " 2> log") == 2);
    CHECK(contains(file_contents(folder / "log"), "stdout is a terminal"));
}

}  // namespace
}  // namespace raya
