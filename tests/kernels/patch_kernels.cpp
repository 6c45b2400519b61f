// patch_kernels TO [FILE FIND REPLACE]...: writes the kernels to the folder TO. In each FILE it replaces FIND, which
// must occur exactly once, by REPLACE. Tests that are scripts run this program.
#include <cstdio>
#include <exception>

#include "tests/kernels/write_kernels.hpp"

int main(int argc, char** argv) {
    if (argc < 2 || (argc - 2) % 3 != 0) {
        std::fputs("usage: patch_kernels TO [FILE FIND REPLACE]...\n", stderr);
        return 2;
    }
    std::vector<raya::SourcePatch> patches;
    for (int i = 2; i < argc; i += 3) patches.push_back({argv[i], argv[i + 1], argv[i + 2]});
    try {
        raya::write_kernels(argv[1], patches);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "patch_kernels: %s\n", error.what());
        return 1;
    }
}
