// Checks of runs that end with an error: exit code, message, empty stdout, no files.
#pragma once
#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "tests/base/scratch_folder.hpp"
#include "tests/cli/run_program.hpp"

namespace raya {

/// Runs raya and checks that it ends with `code`, prints every part of `message` on stderr and nothing on stdout, and
/// leaves `outputs` empty.
inline void check_refused(const ScratchFolder& outputs, const Arguments& arguments, int code, const Arguments& message,
                          const RunOptions& run_options = {}) {
    const RunOutcome run = run_raya(arguments, run_options);
    INFO(run.describe());
    CHECK(run.code == code);
    CHECK(run.out.empty());
    for (const std::string& part : message) CHECK_THAT(run.err, Catch::Contains(part));
    CHECK(outputs.entries() == 0);
}

/// Returns the arguments of a render of `scene` that writes one file of each kind into `outputs`.
inline Arguments render_into(const ScratchFolder& outputs, const std::string& scene, const Arguments& options = {}) {
    Arguments arguments = {
        "render", scene, "-o", outputs / "x.pfm", "--cost", outputs / "x-cost.pfm", "--report", outputs / "x.json"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return arguments;
}

}  // namespace raya
