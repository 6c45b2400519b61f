// Kernel sources: each file is included once, and #line directives keep the file and number of every line.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "host/cl/commands.hpp"
#include "host/cl/kernel_source.hpp"
#include "host/error.hpp"
#include "tests/base/scratch_folder.hpp"
#include "tests/paths.h"

using namespace raya;
using Catch::Contains;

namespace {

const std::filesystem::path kKernels = RAYA_SOURCE_DIR "/kernels";

std::vector<std::string> lines_of(std::istream& in) {
    std::vector<std::string> lines;
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
}

void write(const std::filesystem::path& path, const std::string& text) { std::ofstream(path) << text; }

std::size_t count(const std::string& text, const std::string& part) {
    std::size_t found = 0;
    for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; at += part.size()) ++found;
    return found;
}

bool is_include(const std::string& line) { return line.starts_with("#include \""); }

// Returns true if tools/mutants runs this test with mutants instead of the embedded kernels.
bool uses_other_kernels() { return std::getenv("RAYA_KERNEL_DIR") != nullptr; }

}  // namespace

TEST_CASE("includes are expanded in place, each once, and line numbers are kept", "[kernels]") {
    const ScratchFolder folder;
    write(folder / "inner.clh", "inner 1\ninner 2\n");
    write(folder / "outer.clh", "#include \"inner.clh\"\nouter 2\n");
    const std::string text = "one\n#include \"outer.clh\"\nthree\n#include \"inner.clh\"\n#include <system.h>\n";
    CHECK(expand_kernel_source(text, "some.cl", {folder.path()}) ==
          "#line 1 \"some.cl\"\none\n"
          "#line 1 \"outer.clh\"\n#line 1 \"inner.clh\"\ninner 1\ninner 2\n#line 2 \"outer.clh\"\nouter 2\n"
          "#line 3 \"some.cl\"\nthree\n#line 5 \"some.cl\"\n#include <system.h>\n");
    write(folder / "some.cl", text);
    CHECK(kernel_source("some.cl", {folder.path()}) == expand_kernel_source(text, "some.cl", {folder.path()}));
}

TEST_CASE("files may include each other", "[kernels]") {
    const ScratchFolder folder;
    write(folder / "a.clh", "#include \"b.clh\"\na 2\n");
    write(folder / "b.clh", "#include \"a.clh\"\nb 2\n");
    const std::string source = kernel_source("a.clh", {folder.path()});
    CHECK(count(source, "a 2\n") == 1);
    CHECK(count(source, "b 2\n") == 1);
}

TEST_CASE("the trace kernel's source contains every line of its files, with file and line number", "[kernels]") {
    if (uses_other_kernels()) return;
    std::istringstream source(kernel_source("ring/trace.cl"));
    std::map<std::string, std::vector<std::string>> files;
    std::map<std::string, std::size_t> line_counts;  // number of each file's lines in the source
    std::string file;
    std::size_t number = 0;
    for (const std::string& line : lines_of(source)) {
        if (line.starts_with("#line ")) {
            const std::size_t quote = line.find('"');
            file = line.substr(quote + 1, line.size() - quote - 2);
            number = std::stoul(line.substr(6));
            std::ifstream in(kKernels / file);
            if (!files.contains(file)) files[file] = lines_of(in);
            continue;
        }
        CAPTURE(file, number);
        REQUIRE(number <= files[file].size());
        REQUIRE(files[file][number - 1] == line);
        ++number;
        ++line_counts[file];
    }
    CHECK(files.size() > 10);
    for (const auto& [name, lines] : files) {
        CAPTURE(name);
        const auto includes = std::count_if(lines.begin(), lines.end(), is_include);
        CHECK(line_counts[name] + static_cast<std::size_t>(includes) == lines.size());
    }
}

TEST_CASE("the program embeds the kernels of the project's folder", "[kernels]") {
    if (uses_other_kernels()) return;
    int kernels = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(kKernels)) {
        if (entry.path().extension() != ".cl") continue;
        ++kernels;
        const std::string file = std::filesystem::relative(entry.path(), kKernels).string();
        CAPTURE(file);
        CHECK(kernel_source(file) == kernel_source(file, {kKernels}));
    }
    CHECK(kernels > 0);
}

TEST_CASE("the error for a missing file or include names the file", "[kernels]") {
    if (uses_other_kernels()) return;
    CHECK_THROWS_AS(kernel_source("ring/tarce.cl"), UserError);
    CHECK_THROWS_WITH(kernel_source("ring/tarce.cl"), Contains("'ring/tarce.cl'"));
    CHECK_THROWS_AS(expand_kernel_source("#include \"none.clh\"\n", "t.cl"), UserError);
    CHECK_THROWS_WITH(expand_kernel_source("#include \"none.clh\"\n", "t.cl"), Contains("'none.clh'"));
    const ScratchFolder folder;
    CHECK_THROWS_AS(kernel_source("ring/trace.cl", {folder.path()}), UserError);
    CHECK_THROWS_WITH(kernel_source("ring/trace.cl", {folder.path()}),
                      Contains((folder / "ring/trace.cl").string()) && Contains("--kernel-dir"));
}

TEST_CASE("a patch changes its file wherever that file is included, and nothing else", "[kernels]") {
    const ScratchFolder folder;
    write(folder / "inner.clh", "inner 1\ninner 2\n");
    write(folder / "outer.cl", "#include \"inner.clh\"\nouter 2\n");
    const SourcePatch two_lines{"inner.clh", "1\ninner 2", "one\ninner"};
    const KernelSources sources{folder.path(), {two_lines, {"inner.clh", "inner\n", "two\n"}}};
    CHECK(kernel_file("inner.clh", sources) == "inner one\ntwo\n");
    CHECK(kernel_file("outer.cl", sources) == kernel_file("outer.cl", {folder.path()}));
    CHECK(kernel_source("outer.cl", sources) ==
          "#line 1 \"outer.cl\"\n#line 1 \"inner.clh\"\ninner one\ntwo\n#line 2 \"outer.cl\"\nouter 2\n");
    // Includes are expanded after patches, so a patch may add one.
    const SourcePatch include{"outer.cl", "outer 2", "#include \"more.clh\""};
    write(folder / "more.clh", "more 1\n");
    CHECK_THAT(kernel_source("outer.cl", {folder.path(), {include}}), Contains("\"more.clh\"\nmore 1\n"));
    // Patches apply to embedded kernels too.
    const SourcePatch renaming{"ring/trace.cl", "void trace(", "void retrace("};
    CHECK_THAT(kernel_source("ring/trace.cl", {.patches = {renaming}}), Contains("void retrace("));
}

TEST_CASE("a patch is refused unless its text occurs exactly once", "[kernels]") {
    const auto check_patch_error = [](const SourcePatch& patch, const std::string& why) {
        const KernelSources sources{.patches = {patch}};
        CHECK_THROWS_AS(kernel_file(patch.file, sources), std::logic_error);
        CHECK_THROWS_WITH(check_patches(sources), why);
    };
    check_patch_error({"ring/trace.cl", "no such text", ""}, "patch of ring/trace.cl: no text 'no such text'");
    check_patch_error({"ring/trace.cl", "", "more"}, "patch of ring/trace.cl: no text ''");
    check_patch_error({"ring/trace.cl", "uint", "int"}, "patch of ring/trace.cl: more than one text 'uint'");
    CHECK_THROWS_AS(check_patches({.patches = {{"ring/tarce.cl", "uint", "int"}}}), UserError);
    CHECK_NOTHROW(check_patches({.patches = {{"ring/trace.cl", "void trace(", "void retrace("}}}));
}

TEST_CASE("a build log names the file and line of an error", "[kernels]") {
    const ScratchFolder folder;
    write(folder / "broken.clh", "// a comment\nint two(void) { return first_mistake; }\n");
    const std::string text = "#include \"broken.clh\"\n\nkernel void f(global int* a) { a[0] = second_mistake; }\n";
    const Session session(choose_device(""));
    const std::string source = expand_kernel_source(text, "mine.cl", {folder.path()});
    CHECK_THROWS_AS(session.build("mine.cl", source, {}), DeviceError);
    CHECK_THROWS_WITH(session.build("mine.cl", source, {}), Contains("broken.clh:2") && Contains("first_mistake") &&
                                                                Contains("mine.cl:3") && Contains("second_mistake"));
}

TEST_CASE("a build log names the line of an error after an include that the preprocessor skips", "[kernels]") {
    const ScratchFolder folder;
    write(folder / "skipped.clh", "// a comment\n// another\n");
    const std::string text =
        "#if 0\n#include \"skipped.clh\"\n#elif 1\nint two(void) { return first_mistake; }\n#endif\n"
        "kernel void f(global int* a) { a[0] = second_mistake; }\n";
    const Session session(choose_device(""));
    CHECK_THROWS_WITH(
        session.build("mine.cl", expand_kernel_source(text, "mine.cl", {folder.path()}), {}),
        Contains("mine.cl:4") && Contains("first_mistake") && Contains("mine.cl:6") && Contains("second_mistake"));
}
