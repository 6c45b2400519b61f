// The main program of the tests of one folder.
#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>
#include <cstdlib>

#include "host/base/module.hpp"
#include "tests/kernel_cache.hpp"
#include "tests/paths.h"

// Tests ignore the values that raya tune has stored for a developer's devices, and kernel binaries next to the program.
int main(int argc, char** argv) {
    setenv("RAYA_TUNED", "off", 0);
    setenv("RAYA_BINARIES", "off", 0);
    raya::set_own_file(RAYA_PROGRAM);
    const raya::KernelCache cache;
    return Catch::Session().run(argc, argv);
}
