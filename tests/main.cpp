// The main program of the tests of one folder.
#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>
#include <cstdlib>

#include "host/base/module.hpp"
#include "tests/kernel_cache.hpp"
#include "tests/paths.h"

// Unless RAYA_TUNED or RAYA_BINARIES is set, tests ignore tuning results (raya tune) and the kernel binaries in the
// program's folder.
int main(int argc, char** argv) {
    setenv("RAYA_TUNED", "off", 0);
    setenv("RAYA_BINARIES", "off", 0);
    raya::set_program_file(RAYA_PROGRAM);
    const raya::KernelCache cache;
    return Catch::Session().run(argc, argv);
}
