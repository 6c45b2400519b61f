// Runs the tests of one folder.
#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>
#include <cstdlib>

#include "tests/kernel_cache.hpp"

// What a developer's devices were tuned to is no part of a test.
int main(int argc, char** argv) {
    setenv("RAYA_TUNED", "off", 0);
    const raya::KernelCache cache;
    return Catch::Session().run(argc, argv);
}
