// Files that are read whole.
#pragma once
#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>

namespace raya {

/// A file cannot be read: why, as the end of a sentence that names the file.
struct UnreadableFile : std::runtime_error {
    using std::runtime_error::runtime_error;
};

enum class Pipes { kRefused, kRead };

/// All bytes of a file; of a pipe (`<(command)` of a shell) where those are read too; of stdin where the name is "-"
/// (standard_streams.hpp). Throws UnreadableFile: no such file, a folder, a device, no permission, an error while
/// reading, more than `most` bytes.
std::string read_file(const std::filesystem::path& path, Pipes pipes = Pipes::kRefused,
                      std::uint64_t most = std::uint64_t{1} << 36);

}  // namespace raya
