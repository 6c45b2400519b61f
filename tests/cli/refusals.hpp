// What every refused run must show: its exit code, a message that says enough, nothing on stdout and no file.
#pragma once
#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "tests/base/scratch_folder.hpp"
#include "tests/cli/run_program.hpp"

namespace raya {

/// Runs raya, which must leave `outputs` as empty as it is.
inline void check_refused(const ScratchFolder& outputs, const Words& arguments, int code, const Words& message,
                          const Surroundings& around = {}) {
    const RunOutcome run = run_raya(arguments, around);
    INFO(run.told());
    CHECK(run.code == code);
    CHECK(run.out.empty());
    for (const std::string& part : message) CHECK_THAT(run.err, Catch::Contains(part));
    CHECK(outputs.entries() == 0);
}

/// A render of `scene` into `outputs` that asks for every kind of file.
inline Words render_into(const ScratchFolder& outputs, const std::string& scene, const Words& options = {}) {
    Words arguments = {"render",          scene, "-o", outputs / "x.pfm", "--cost", outputs / "x-cost.pfm", "--report",
                       outputs / "x.json"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return arguments;
}

}  // namespace raya
