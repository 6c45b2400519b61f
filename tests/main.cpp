// The main program of the tests of one folder.
#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>
#include <cstdlib>
#include <utility>

#include "host/base/child_process.hpp"
#include "host/base/module.hpp"
#include "tests/paths.h"

// Open MPI starts as root, and more ranks than there are cores: version 4, 5 and 6. As in tests/tools/own_cache.sh.
constexpr std::pair<const char*, const char*> kMpiSettings[] = {
    {"OMPI_ALLOW_RUN_AS_ROOT", "1"},
    {"OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1"},
    {"OMPI_MCA_rmaps_base_oversubscribe", "1"},
    {"PRTE_MCA_rmaps_default_mapping_policy", ":oversubscribe"},
    {"PRTE_MCA_mapby", ":oversubscribe"}};

// Unless RAYA_TUNED is set, tests ignore tuning results (raya tune). ctest gives each program a kernel cache
// (tests/tools/own_cache.sh); a program started by hand has an empty one.
int main(int argc, char** argv) {
    setenv("RAYA_TUNED", "off", 0);
    for (const auto& [name, value] : kMpiSettings) setenv(name, value, 1);
    const raya::TemporaryFolder cache("raya-test-kernels");
    setenv("POCL_CACHE_DIR", cache.path().c_str(), 0);
    raya::set_program_file(RAYA_PROGRAM);
    return Catch::Session().run(argc, argv);
}
