// Kernel sources: each file is included once, and #line directives keep the file and number of every line.
#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include "host/cl/commands.hpp"
#include "host/cl/kernel_source.hpp"
#include "host/error.hpp"
#include "tests/base/scratch_folder.hpp"
#include "tests/paths.h"

using namespace raya;
using Catch::Contains;

namespace {

const std::filesystem::path kKernels = RAYA_SOURCE_DIR "/kernels";

void write(const std::filesystem::path& path, const std::string& text) { std::ofstream(path) << text; }

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
