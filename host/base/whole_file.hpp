// Reading of whole files, and atomic writing: an output file appears complete or not at all.
#pragma once
#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

namespace raya {

/// Thrown if a file cannot be read. The message contains only the reason; the caller adds the file's name.
struct UnreadableFile : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Returns all bytes of a regular file or a pipe (`<(command)` in a shell), or of stdin if the name is "-". Throws
/// UnreadableFile if the file does not exist, is a folder or a device, may not be read, has more than `max_bytes`
/// bytes, or if reading fails.
std::string read_file(const std::filesystem::path& path, std::uint64_t max_bytes = std::uint64_t{1} << 36);

/// Remembers that this process reads the file at `path` for its user, so that it does not overwrite the file.
/// `name`: the file in messages; default: the path. Does nothing if there is no such regular file. Throws UserError if
/// the file is a promised output.
void register_input(const std::filesystem::path& path, const std::string& name = "");

/// Forgets an input, because its user asks to replace it.
void forget_input(const std::filesystem::path& path);

/// Calls register_input() and read_file(). For files that the user names, or that such a file names; raya's own files,
/// such as checkpoints, are read and replaced without it.
std::string read_input(const std::filesystem::path& path);

/// Remembers that the process will write `path`; for "-", the file to which stdout is redirected. `name`: the output in
/// messages. Throws UserError if the file is an input or a promised output with another name, also through links.
void promise_output(const std::filesystem::path& path, const std::string& name);

/// Forgets the promised outputs: the call of the Python module that named them ends.
void forget_promised_outputs();

/// Throws UserError with file, reason and remedy if write_whole_file() could not create its temporary file or replace
/// `path`. Commands call it before long work, so that they fail early. For "-", reserves stdout for the file.
void check_writable(const std::filesystem::path& path);

/// Writes `bytes` to a temporary file in the folder of `path` and renames it, so that no reader sees a partial file and
/// an old file stays unchanged until the new one is complete. Follows a symbolic link to a file; a link to nothing is
/// replaced. Writes directly to a device, a pipe (`/dev/stdout`) or stdout ("-"). Throws UserError with file, reason
/// and remedy, also if the file is an input. Failures and interruptions (interruption.hpp) leave no temporary file.
void write_whole_file(const std::filesystem::path& path, std::string_view bytes);

// "-" as a file name: stdin or stdout.

/// Returns true for "-", which means stdin for an input file and stdout for an output file. The path of a file that is
/// itself named - is "./-".
bool is_standard_stream(const std::filesystem::path& path);

/// Return the name of a file in messages and reports: "stdin" or "stdout" for "-", else the path.
std::string input_name(const std::filesystem::path& path);
std::string output_name(const std::filesystem::path& path);

/// Returns true if check_writable() has reserved stdout for a file: everything that this process and its children print
/// to stdout goes to stderr.
bool stdout_is_reserved();

/// Throws UserError if `path` is "-" and stdout is a terminal, which binary output would garble.
void refuse_bytes_on_terminal(const std::filesystem::path& path);

}  // namespace raya
