// Runs a fuzz target on files, as libFuzzer does, but without clang:
//   fuzz_READER FILE|FOLDER...     FOLDER: runs the target on each file of the folder
// Prints the number of files. Exit codes: 0: no finding; 2: a file cannot be read, or there are no files. A finding
// aborts the program.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace fs = std::filesystem;

int main(int count, char** arguments) {
    std::vector<fs::path> files;
    for (int i = 1; i < count; ++i) {
        if (!fs::is_directory(arguments[i])) {
            files.emplace_back(arguments[i]);
            continue;
        }
        for (const auto& entry : fs::directory_iterator(arguments[i])) files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    for (const fs::path& path : files) {
        std::ifstream file(path, std::ios::binary);
        const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
        if (!file) return std::fprintf(stderr, "%s cannot be read\n", path.c_str()), 2;
        std::fprintf(stderr, "%s\n", path.c_str());  // after a crash, the last line names the file
        LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
    }
    std::printf("%zu files\n", files.size());
    return files.empty() ? 2 : 0;
}
