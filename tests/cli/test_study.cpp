// raya study: files, faults and folders. tests/lab tests the studies themselves, and a transcript the refused options.
#include <sys/stat.h>

#include <filesystem>
#include <set>

#include "host/version.hpp"
#include "tests/cli/device_with_fault.hpp"
#include "tests/cli/refusals.hpp"
#include "tests/document.hpp"
#include "tests/paths.h"
#include "tests/thorough.hpp"

#if RAYA_STUDIES
namespace raya {
namespace {
namespace fs = std::filesystem;

Arguments study_arguments(const std::string& name, const ScratchFolder& outputs, const Arguments& options = {}) {
    Arguments arguments = {"study", name, "-o", outputs / "made/x"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return arguments;
}

TEST_CASE("study: a study of raya or of the user writes figures, tables, JSON and a document", "[cli]") {
    for (const std::string& name : quick<std::string>(1, {RAYA_SOURCE_DIR "/docs/my_study.py", "fig8"})) {
        const ScratchFolder outputs;
        const RunOutcome run = run_raya(study_arguments(name, outputs, {"--size", "32"}));
        INFO(run.describe());
        REQUIRE(run.code == 0);
        CHECK(run.err.empty());
        const fs::path folder = outputs / "made/x";
        const std::string stem = name == "fig8" ? name : "my-study";
        for (const char* extension : {".csv", ".json", ".md", ".png", ".svg"})
            CHECK(fs::exists(folder / (stem + extension)));
        CHECK(fs::exists(folder / "manifest.json"));
        CHECK_THAT(file_contents(folder / "index.html"), Catch::Contains("<svg ") && Catch::Contains("</html>"));
        const Document json = json_of(folder / (stem + ".json"));
        CHECK(json["settings"]["size"] == 32);
        CHECK(json["run"]["version"] == std::string("raya ") + raya_version());
    }
}

TEST_CASE("study: reports a failure of the device, and refuses a folder that it cannot write", "[cli]") {
    const ScratchFolder outputs, read_only;
    check_refused(outputs, study_arguments("fig8", outputs, {"--size", "17"}), 3, {"CL_OUT_OF_RESOURCES"},
                  device_with_fault("clEnqueueNDRangeKernel 1 -5"));
    ::chmod(read_only.path().c_str(), 0555);
    check_refused(read_only, {"study", "fig8", "-o", read_only.path(), "--size", "32"}, 2, {"not writable"},
                  {.variables = {}, .as_nobody = true});
}

}  // namespace
}  // namespace raya
#endif
