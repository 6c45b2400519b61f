// Runs the tests of one folder.
#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>
#include <cstdlib>

#include "host/base/module.hpp"
#include "tests/kernel_cache.hpp"
#include "tests/paths.h"

// What a developer's devices were tuned to is no part of a test, nor are kernels that were compiled before it.
int main(int argc, char** argv) {
    setenv("RAYA_TUNED", "off", 0);
    setenv("RAYA_BINARIES", "off", 0);
    raya::set_own_file(RAYA_PROGRAM);
    const raya::KernelCache cache;
    return Catch::Session().run(argc, argv);
}
