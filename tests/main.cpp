// Runs the tests of one folder.
#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>

#include "tests/kernel_cache.hpp"

int main(int argc, char** argv) {
    const raya::KernelCache cache;
    return Catch::Session().run(argc, argv);
}
