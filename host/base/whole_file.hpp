// Reading of whole files, and atomic writing: an output file appears complete or not at all.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace raya {

/// A file cannot be read. The message is the reason only; the caller adds the file's name.
struct UnreadableFile : std::runtime_error {
    using std::runtime_error::runtime_error;
};

enum class Pipes { kRefused, kRead };

/// Returns all bytes of a file, of a pipe (`<(command)` of a shell) with Pipes::kRead, or of stdin if the name is "-"
/// (standard_streams.hpp). Throws UnreadableFile: no such file, a folder, a device, no permission, a read error, more
/// than `max_bytes` bytes.
std::string read_file(const std::filesystem::path& path, Pipes pipes = Pipes::kRefused,
                      std::uint64_t max_bytes = std::uint64_t{1} << 36);

/// Throws UserError with file, reason and remedy if write_whole_file() could not write `path`: it is a folder, its
/// folder is missing or not writable, or the existing file is not writable. Writes nothing. Lets a command fail before
/// an hour of work instead of after it. "-" reserves stdout for the file (standard_streams.hpp).
void check_writable(const std::filesystem::path& path);

/// Returns the same text for all names of a file, whether it exists or not: device and inode, or those of the folder in
/// which it would be created. Empty for a device, a pipe or a folder. UserError for a loop of links.
std::string file_identity(const std::filesystem::path& path);

/// Writes `bytes` to a temporary file in the folder of `path` and renames it, so that no reader sees a partial file and
/// an old file stays unchanged until the new one is complete. Follows a symbolic link, also to a file that does not
/// exist yet. Writes a device, a pipe (`/dev/stdout`) or stdout ("-") directly. Throws UserError with file, reason and
/// remedy. Neither a failure nor an interruption (interruption.hpp) leaves a temporary file.
void write_whole_file(const std::filesystem::path& path, std::string_view bytes);

/// Writes a file in pieces, so that it need not be in memory as a whole. `next` returns one piece per call, valid until
/// the next call, and an empty one at the end.
void write_whole_file(const std::filesystem::path& path, const std::function<std::string_view()>& next);

}  // namespace raya
