// Files that are read whole, and output files that appear whole or not at all.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>

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

/// Refuses a target that write_whole_file() could not write: a folder, a missing or unwritable folder around it, an
/// existing file that is not writable. Writes nothing. Throws UserError with file, reason and remedy. For commands
/// that would rather fail before an hour's work than after it. Where the name is "-" stdout is kept for the file from
/// now on (standard_streams.hpp).
void check_writable(const std::filesystem::path& path);

/// The same text for all names of a file, whether it exists or not: device and inode, or those of the folder that it
/// would be made in. Empty for what is not a regular file: a device, a pipe, a folder. UserError for a loop of links.
std::string file_identity(const std::filesystem::path& path);

/// Writes `bytes` to `path`: to a temporary name in the same folder, then renamed, so that nobody ever sees half a file
/// and an old file stays as it was until the new one is complete. A symbolic link is followed, to a file that
/// is not there too; a device, a pipe (`/dev/stdout`) or stdout ("-") is written directly, as there is nothing to
/// rename. Throws UserError with file, reason and remedy, and then leaves nothing behind; nor does an interruption
/// (interruption.hpp).
void write_whole_file(const std::filesystem::path& path, std::string_view bytes);

/// The same for a file whose bytes come in pieces, so that it need not lie in memory as a whole: `next` gives one after
/// another, each good until the next is asked for, and an empty one at the end.
void write_whole_file(const std::filesystem::path& path, const std::function<std::string_view()>& next);

}  // namespace raya
