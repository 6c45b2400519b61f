// Runs the tests of one folder. Each test program has a kernel cache of its own, fresh for every run: a kernel that no
// longer builds must not pass because an older one does, and two programs must not write one cache (pocl issue 586).
#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>
#include <cstdlib>

#include "tests/report/scratch_folder.hpp"

int main(int argc, char** argv) {
    const raya::ScratchFolder cache;
    setenv("POCL_CACHE_DIR", cache.path().c_str(), 1);
    return Catch::Session().run(argc, argv);
}
