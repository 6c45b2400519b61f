// stdin and stdout wherever a file is asked for.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>

namespace raya {

/// Whether a name stands for stdin, where a file is read, or for stdout, where one is written: "-". A file of that name
/// is "./-".
bool is_standard_stream(const std::filesystem::path& path);

/// How messages and reports name what is read or written: "stdin", "stdout", else the path.
std::string input_name(const std::filesystem::path& path);
std::string output_name(const std::filesystem::path& path);

/// The descriptor to read stdin from, once. A terminal's user is told that it is waited for. UnreadableFile
/// (whole_file.hpp) at the second call: what was read is gone.
int take_stdin();

/// Keeps stdout for a file: what this process prints, and those that it starts, goes to stderr from now on. Again: does
/// nothing. Throws std::runtime_error where the system has no descriptor left.
void keep_stdout_for_file();
bool stdout_is_for_file();

/// The descriptor of stdout, to be closed by who writes the file. UserError at the second call: two files would run
/// into one another there.
int take_stdout();

/// UserError where "-" stands for a terminal, which binary bytes would garble.
void refuse_bytes_on_terminal(const std::filesystem::path& path);

}  // namespace raya
